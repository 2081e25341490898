# SPDX-License-Identifier: MIT
"""Fits material.strain_scale of a config to a measured part, by least squares.

    fabseq-tools calibrate CONFIG.json MEASURED --output DIR [--released] [--rigid] [--isotropic]
                       [--tolerance LENGTH] [--program build/release/fabseq] [--ranks N]
                       [-- OPTIONS OF THE PROGRAM]

MEASURED is in the config's coordinates and its unit of length, and one of two:

- Displacements: a table (CSV) whose first line names its columns: x, y, z, the points in the part as drawn or
  in the substrate, and ux, uy, uz, their displacements (2D without z and uz). A displacement that was not
  measured is left empty, lines that begin with # do not count. Points outside of the elements are moved to
  the nearest place on their surface.
- A scan: such a table with x, y, z only, or a cloud of points (PLY). Each is a point of the surface of the
  finished part. What counts is how far it is from the surface as drawn, along its normal: from the mesh of
  part.mesh, in its place, or else, and with 3MF files, from the boundary of the elements. Slanted and round
  surfaces of these are stairs, so that a scan wants a mesh.

A point farther from that surface than --tolerance (default: the longest edge of an element for displacements,
three of them for a scan) is a mistake: all such points are named before the process is simulated. --rigid is
for points in a frame of their own: a scan has to be aligned to the drawing to within the tolerance first, and
the rest of the motion is found together with the factors.

The model is made with a single layer first, to see where its elements are. Then the process is simulated
(-task simulate) with a few scales; displacements are linear in the strain, so any other scale follows from
these. Into DIR go the simulations, calibration.json (factors, what is left of the differences) and
config.json, the effective config with the factors found.

Factors that the points say nothing about stay 1, with a warning. The method: docs/formulation.md 4.5.
"""

import itertools
import os
import re

import numpy as np

from fabseq_tools.calibration.measured_points import AXES, read_measurement, refuse_far_points
from fabseq_tools.calibration.voxel_model import VoxelModel
from fabseq_tools.geometry.nearest_surface import mesh_surface
from fabseq_tools.geometry.rigid_motions import rigid_motions
from fabseq_tools.run.command_line import RunError, parse, parser_of, run_program, warn, write_json
from fabseq_tools.run.places import PROGRAM
from fabseq_tools.run.read_run import read_config, read_fields, read_json

COMMAND = "calibrate"

UNDETERMINED = 1e-6  # of the largest singular value
SETTLED = 1e-6       # change of the factors with which the search for the places of a scan's points ends
MOST_SEARCHES = 12   # for these; with noise, points at edges go to and fro for ever


def simulate(arguments, name, *options):
    """The effective config and the fields of a simulation."""
    output = os.path.join(arguments.output, name)
    run_program(arguments, arguments.config, "simulate", "-output", output, "-overwrite", *options)
    return read_json(output, "config.json"), read_fields(os.path.join(output, "result.h5"))


def single_layer(arguments):
    """The effective config and the model of the part, from a simulation of one layer."""
    print("making the model, with a single layer", flush=True)
    settings = {"sequence": '{"type": "planar"}', "layers": '{"count": 1}', "projection": "{}", "baseline": "{}",
                "objective": "[]", "constraints": "[]", "output": "{}"}
    config, fields = simulate(arguments, "model", *itertools.chain(*(("-set", f"{k}={v}") for k, v in settings.items())))
    return config, VoxelModel(config, fields)


def displacement_for(arguments, scale):
    """The effective config, and the displacements of the nodes for the factors `scale`."""
    print(f"simulating with strain_scale {scale.tolist()}", flush=True)
    config, result = simulate(arguments, "simulation_" + "_".join(f"{factor:g}" for factor in scale), "-set",
                              f"material.strain_scale={scale.tolist()}")
    if not arguments.released:
        return config, result["displacement"]
    if "release_displacement" not in result:
        raise RunError("the simulation knows no release of this part")
    return config, result["displacement"] + result["release_displacement"]


def simulate_all(arguments, factors):
    """The effective config, and fields U_ab [a][b][z][y][x][axis] of u(s) = sum_ab sqrt(s_a s_b) U_ab. U_ab
    of two factors is not 0 where there is shear. A column of `factors` is the axes that a factor is of."""
    count = factors.shape[1]
    forms = [[None] * count for _ in range(count)]
    for a in range(count):
        config, forms[a][a] = displacement_for(arguments, factors[:, a])
    for a, b in itertools.combinations(range(count), 2):
        _, both = displacement_for(arguments, factors[:, a] + factors[:, b])
        forms[a][b] = forms[b][a] = 0.5 * (both - forms[a][a] - forms[b][b])
    return config, np.array(forms)


def solve_factors(forms, measured):
    """Factors that come closest to the measured values, and whether these determine each of them. `forms`:
    [a][b][value]."""
    roots = np.ones(len(forms))
    for _ in range(200):
        rest = measured - roots @ (roots @ forms)
        step = np.linalg.lstsq(2.0 * (roots @ forms).T, rest, rcond=UNDETERMINED)[0]
        while np.linalg.norm(measured - (roots + step) @ ((roots + step) @ forms)) > np.linalg.norm(rest):
            step *= 0.5
        roots = roots + step
        if np.abs(step).max() < 1e-13:
            break
    sizes = np.linalg.norm(np.einsum("aav->av", forms), axis=1)
    determined = sizes > UNDETERMINED * max(sizes.max(), np.linalg.norm(measured))
    if determined.any() and np.linalg.cond(forms.sum(0)[determined]) > 1.0 / UNDETERMINED:
        raise RunError("the points cannot tell the factors of the axes apart: measure more of them, or --isotropic")
    return np.where(determined, np.abs(roots), 1.0)**2, determined


class Fit:
    """Factors, and with `rigid` a motion, for which `values`, displacements of points along directions (n,
    axis), are met best."""

    def __init__(self, model, fields, points, directions, values, rigid):
        self.displacements = model.interpolate(fields, model.moved_in(points)[0])
        forms, self.values = np.einsum("abnx,nx->abn", self.displacements, directions), values
        motions = rigid_motions(points - points.mean(0)) if rigid else np.zeros((0, *points.shape))
        along = np.einsum("mnx,nx->nm", motions, directions)
        left, sizes, _ = np.linalg.svd(along, full_matrices=False)
        basis = left[:, sizes > 1e-9 * sizes[0]] if rigid else left
        if len(values) <= basis.shape[1]:
            raise RunError(f"{len(values)} measured values determine nothing beside a rigid motion")
        # What no rigid motion explains.
        self.factors, self.determined = solve_factors(forms - forms @ basis @ basis.T, values - basis @ (basis.T @ values))
        rest = values - np.sqrt(self.factors) @ (np.sqrt(self.factors) @ forms)
        motion = np.linalg.lstsq(along, rest, rcond=1e-9)[0]
        self.rest = rest - along @ motion
        self.motion = np.einsum("m,mnx->nx", motion, motions)

    def displacement(self):
        """Of the points, with the rigid motion."""
        roots = np.sqrt(self.factors)
        return np.einsum("a,b,abnx->nx", roots, roots, self.displacements) + self.motion


class Displacements:
    """Points whose displacements were measured."""

    def __init__(self, model, points, measured, tolerance):
        self.model, self.measured = model, measured
        self.points, distances = model.moved_in(points)
        refuse_far_points(points, distances, tolerance or model.longest_edge, "the elements of part and substrate")
        if distances.any():
            print(f"{np.count_nonzero(distances)} points outside of the elements moved by up to {distances.max():.4g}")

    def fit(self, fields, rigid):
        point, axis = np.nonzero(np.isfinite(self.measured))
        return Fit(self.model, fields, self.points[point], np.eye(self.points.shape[1])[axis],
                   self.measured[point, axis], rigid)


class Scan:
    """Points of the surface of the finished part. Where on the drawing each of them comes from depends on the
    displacement, so that search and fit take turns."""

    def __init__(self, model, points, config, tolerance):
        self.model, self.points = model, points
        mesh = config["part"].get("mesh")
        drawn = mesh_surface(mesh["file"], config["run"]["mesh_placement"]) if mesh else None
        if mesh and drawn is None:
            warn(COMMAND, f"{mesh['file']} cannot be read here: distances are those from the elements")
        self.surface = drawn or model.surface
        refuse_far_points(points, self.surface.nearest(points)[2], tolerance or 3.0 * model.longest_edge,
                          "the surface as drawn" if drawn else "the surface of part and substrate")

    def fit(self, fields, rigid):
        displacement, factors = 0.0, np.inf
        for _ in range(MOST_SEARCHES):
            places, normals, _ = self.surface.nearest(self.points - displacement)
            fit = Fit(self.model, fields, places, normals, np.sum(normals * (self.points - places), axis=1), rigid)
            if np.abs(fit.factors - factors).max() < SETTLED:
                break
            displacement, factors = fit.displacement(), fit.factors
        return fit


def calibrate(arguments):
    config = read_config(arguments.config)
    printed = run_program(arguments, arguments.config, "check")
    dimension = re.search(r"^bounding box.*?\[(.*?)\]", printed, re.MULTILINE)[1].count(",") + 1
    unit = config.get("domain", {}).get("unit")
    points, displacements = read_measurement(arguments.measured, dimension, unit)
    os.makedirs(arguments.output, exist_ok=True)
    config, model = single_layer(arguments)
    measurement = (Scan(model, points, config, arguments.tolerance) if displacements is None else
                   Displacements(model, points, displacements, arguments.tolerance))
    factors = np.ones((dimension, 1)) if arguments.isotropic else np.eye(dimension)
    config, fields = simulate_all(arguments, factors)
    fit = measurement.fit(fields, arguments.rigid)
    scale, determined = factors @ fit.factors, (factors @ fit.determined).astype(bool)
    write_result(arguments.output, config, scale, determined, fit,
                 {"measured": "scan" if displacements is None else "displacements", "points": len(points)})


def write_result(output, config, scale, determined, fit, record):
    config.pop("run", None)
    config["material"]["strain_scale"] = scale.tolist()
    record |= {"strain_scale": scale.tolist(), "determined": determined.tolist(), "measured_values": len(fit.values),
               "rms_measured": float(np.sqrt(np.mean(fit.values**2))),
               "rms_difference": float(np.sqrt(np.mean(fit.rest**2))), "largest_difference": float(np.abs(fit.rest).max())}
    write_json(os.path.join(output, "config.json"), config)
    write_json(os.path.join(output, "calibration.json"), record)
    for axis in np.flatnonzero(~determined):
        warn(COMMAND, f"the points say nothing about the factor along {AXES[axis]}, which stays 1")
    print(f"strain_scale {[round(float(s), 6) for s in scale]}")
    print(f"rms of {len(fit.rest)} measured values {record['rms_measured']:.4g}, of the differences "
          f"{record['rms_difference']:.4g}, largest {record['largest_difference']:.4g}")
    print(f"config with these factors: {os.path.join(output, 'config.json')}")


def main(words):
    parser = parser_of(__doc__, COMMAND)
    parser.add_argument("config")
    parser.add_argument("measured", help="displacements of points (CSV), or points of a scan (CSV, PLY)")
    parser.add_argument("--output", required=True)
    parser.add_argument("--released", action="store_true",
                        help="what was measured is the part after its release from plate or clamps")
    parser.add_argument("--rigid", action="store_true",
                        help="the points were measured in a frame of their own: rigid motions do not count")
    parser.add_argument("--isotropic", action="store_true", help="one factor for all axes")
    parser.add_argument("--tolerance", type=float, metavar="LENGTH",
                        help="how far from part or drawing a point may lie (default: one element, of a scan three)")
    parser.add_argument("--program", default=PROGRAM)
    parser.add_argument("--ranks", type=int, default=1)
    calibrate(parse(parser, words))
