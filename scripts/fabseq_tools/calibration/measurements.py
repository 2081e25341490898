# SPDX-License-Identifier: MIT
"""What was measured of a part, displacements of points or a scan, as equations for the factors of its
strain."""

import numpy as np

from fabseq_tools.calibration.measured_points import refuse_far_points
from fabseq_tools.calibration.strain_factors import Equations
from fabseq_tools.geometry.nearest_surface import mesh_surface


class Displacements:
    """Points whose displacements were measured."""

    name, moves = "displacements", False

    def __init__(self, model, points, measured, tolerance):
        self.model, self.measured = model, measured
        self.points, distances = model.moved_in(points)
        refuse_far_points(points, distances, tolerance or model.longest_edge, "the elements of part and substrate")
        if distances.any():
            print(f"{np.count_nonzero(distances)} points outside of the elements moved by up to {distances.max():.4g}")

    def equations(self, fields, rigid, displacement=None):
        """One for each component that was measured."""
        point, axis = np.nonzero(np.isfinite(self.measured))
        return Equations(self.model, fields, self.points[point], np.eye(self.points.shape[1])[axis],
                         self.measured[point, axis], rigid)


class Scan:
    """Points of the surface of the finished part. Where on the drawing each of them comes from depends on the
    displacement."""

    name, moves = "scan", True

    def __init__(self, model, points, config, tolerance, warn):
        """`config`: the effective one. `warn`: is called with what the user should know."""
        self.model, self.points = model, points
        mesh = config["part"].get("mesh")
        drawn = mesh_surface(mesh["file"], config["run"]["mesh_placement"]) if mesh else None
        if mesh and drawn is None:
            warn(f"{mesh['file']} cannot be read here: distances are those from the elements")
        self.surface = drawn or model.surface
        refuse_far_points(points, self.surface.nearest(points)[2], tolerance or 3.0 * model.longest_edge,
                          "the surface as drawn" if drawn else "the surface of part and substrate")

    def equations(self, fields, rigid, displacement=None):
        """One for each point, at its place for this displacement (n, axis), or for none."""
        places, normals, _ = self.surface.nearest(self.points - (0.0 if displacement is None else displacement))
        return Equations(self.model, fields, places, normals, np.sum(normals * (self.points - places), axis=1), rigid)
