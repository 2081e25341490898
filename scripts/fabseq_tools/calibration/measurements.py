# SPDX-License-Identifier: MIT
"""What was measured of a part, displacements of points or a scan, as equations for the factors of its
strain."""

import copy

import numpy as np

from fabseq_tools.calibration.measured_points import refuse_far_points
from fabseq_tools.calibration.points_frame import PointsFrame
from fabseq_tools.calibration.strain_factors import Equations
from fabseq_tools.geometry.nearest_surface import mesh_surface

FAR_OFF = 100.0  # extents of the part: points farther off are not looked for


def box_of(surface):
    """Its lower and its upper corner."""
    corners = surface.corners.reshape(-1, surface.dimension)
    return np.stack([corners.min(0), corners.max(0)])


def distances_of(points, box, find):
    """How far points are from a part. `find`: for those that are not far off, of which the distance from its
    box (lower and upper corner) is enough."""
    beyond = np.maximum(np.maximum(box[0] - points, points - box[1]), 0.0)
    with np.errstate(over="ignore"):
        distances = np.linalg.norm(beyond, axis=1)
    near = distances < FAR_OFF * np.linalg.norm(box[1] - box[0])
    distances[near] = find(points[near])
    return distances


class Displacements:
    """Points whose displacements were measured."""

    name, moves = "displacements", False

    def __init__(self, model, measurement, config, tolerance):
        """`measurement`: as it was read. `config`: the effective one."""
        tolerance, box = tolerance or model.longest_edge, box_of(model.surface)

        def distances(points):
            return distances_of(points, box, lambda near: model.moved_in(near)[1])

        PointsFrame(measurement.points, box, distances, tolerance,
                    config["domain"].get("unit")).refuse_others(measurement.path, measurement.has_units)
        off = distances(measurement.points)
        refuse_far_points(measurement, off, tolerance, "the elements of part and substrate")
        self.model, self.measured, self.box, self.tolerance = model, measurement.displacements, box, tolerance
        self.points = model.moved_in(measurement.points)[0]
        if off.any():
            print(f"{np.count_nonzero(off)} points outside of the elements moved by up to {off.max():.4g}")

    def equations(self, fields, rigid, displacement=None):
        """One for each component that was measured."""
        point, axis = np.nonzero(np.isfinite(self.measured))
        return Equations(self.model, fields, self.points[point], np.eye(self.points.shape[1])[axis],
                         self.measured[point, axis], rigid)

    def picked(self, chosen):
        """The same of some of the points."""
        result = copy.copy(self)
        result.points, result.measured = self.points[chosen], self.measured[chosen]
        return result

    def turned(self, matrix):
        """Measurements that this one may be, if its axes were others: of the displacements, and also of the
        points where they still lie in the part."""
        result = [copy.copy(self)]
        known = np.where(np.isfinite(self.measured), self.measured, 0.0) @ matrix
        result[0].measured = np.where(np.isfinite(self.measured) @ np.abs(matrix) > 0.5, known, np.nan)
        points, distances = self.model.moved_in((self.points - self.box.mean(0)) @ matrix + self.box.mean(0))
        if distances.max() <= self.tolerance:
            result.append(copy.copy(result[0]))
            result[1].points = points
        return result


class Scan:
    """Points of the surface of the finished part. Where on the drawing each of them comes from depends on the
    displacement."""

    name, moves = "scan", True

    def __init__(self, model, measurement, config, tolerance):
        """As of Displacements."""
        mesh = config["part"].get("mesh")
        drawn = mesh_surface(mesh["file"], config["run"]["mesh_placement"]) if mesh else None
        self.model, self.points, self.surface = model, measurement.points, drawn or model.surface
        self.tolerance = tolerance or 3.0 * model.longest_edge
        self.box = box_of(self.surface)

        def distances(points):
            return distances_of(points, self.box, lambda near: self.surface.nearest(near)[2])

        PointsFrame(self.points, self.box, distances, self.tolerance,
                    config["domain"].get("unit")).refuse_others(measurement.path, measurement.has_units)
        refuse_far_points(measurement, distances(self.points), self.tolerance,
                          "the surface as drawn" if drawn else "the surface of part and substrate")

    def equations(self, fields, rigid, displacement=None):
        """One for each point, at its place for this displacement (n, axis), or for none."""
        places, normals, _ = self.surface.nearest(self.points - (0.0 if displacement is None else displacement))
        return Equations(self.model, fields, places, normals, np.sum(normals * (self.points - places), axis=1), rigid)

    def picked(self, chosen):
        """The same of some of the points."""
        result = copy.copy(self)
        result.points = self.points[chosen]
        return result

    def turned(self, matrix):
        """Scans that this one may be, if its axes were others: none where it would be off the part."""
        result = copy.copy(self)
        result.points = (self.points - self.box.mean(0)) @ matrix + self.box.mean(0)
        return [result] if self.surface.nearest(result.points)[2].max() <= self.tolerance else []
