#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Fits material.strain_scale of a config to measured displacements, by least squares (docs/formulation.md
4.5).

    scripts/use/calibrate.py CONFIG.json MEASURED.csv --output DIR [--released] [--rigid] [--isotropic]
                         [--program build/release/fabseq] [--ranks N] [-- OPTIONS OF THE PROGRAM]

MEASURED.csv names its columns in the first line: x, y, z, the points in the part as drawn or in the
substrate, and ux, uy, uz, their displacements (2D without z and uz), in the config's unit of length. A
displacement that was not measured is left empty. Lines that begin with # do not count.

The process is simulated (-task simulate) with a few scales; displacements are linear in the strain, so any
other scale follows from these. Into DIR go the simulations, calibration.json (factors, what is left of the
differences) and config.json, the effective config with the factors found.

Factors that the points say nothing about stay 1, with a warning.
"""

import csv
import itertools
import os
import re
import sys

import numpy as np

from command_line import PROGRAM, RunError, parse, parser_of, run_command, run_script, write_json
from read_run import origin_of, read_fields, read_json

AXES = "xyz"
UNDETERMINED = 1e-6  # of the largest singular value
ON_FACE = 1e-6       # of an element's edge: how close to a face a point is on it


def read_points(path, dimension):
    """Positions (n, dimension) and displacements (n, dimension), NaN where nothing was measured."""
    with open(path, encoding="utf-8-sig", newline="") as file:
        lines = csv.reader(line for line in file if line.strip() and not line.startswith("#"))
        header, *rows = [[cell.strip() for cell in line] for line in lines] or [[]]
    if not rows:
        raise RunError(f"{path}: holds no points")
    columns = [*AXES[:dimension], *("u" + axis for axis in AXES[:dimension])]
    missing = [name for name in columns if name not in header]
    if missing:
        raise RunError(f"{path}: the first line names no column {', '.join(missing)}; needed: {', '.join(columns)}")

    def number(point, name, cell):
        try:
            return float(cell or (np.nan if name[0] == "u" else ""))
        except ValueError as error:
            raise RunError(f"{path}, point {point}, column {name}: '{cell}' is no number") from error

    values = np.array([[number(point, name, dict(zip(header, row)).get(name, "")) for name in columns]
                       for point, row in enumerate(rows, start=1)])
    return values[:, :dimension], values[:, dimension:]


def element_at(solid, position):
    """Index, x first, of an element of the model that holds the position; a face belongs to both sides."""
    for shift in itertools.product((0.0, -ON_FACE, ON_FACE), repeat=len(position)):
        index = np.clip(np.floor(position + shift), 0, np.array(solid.shape[::-1]) - 1).astype(int)
        if np.all(np.abs(position - index - 0.5) <= 0.5 + ON_FACE) and solid[tuple(index[::-1])]:
            return index
    return None


def interpolate(field, result, size, points):
    """Values at the points, from those of the nodes of the elements that hold them."""
    solid = (result["density"] > 0) | (result.get("substrate", 0) > 0)
    values = []
    for number, point in enumerate(points, start=1):
        position = point / size * solid.shape[::-1]
        first = element_at(solid, position)
        if first is None:
            raise RunError(f"point {number} at {point.tolist()} lies neither in the part nor in the substrate")
        local = np.clip(position - first, 0.0, 1.0)
        values.append(sum(np.prod(np.where(corner, local, 1.0 - local)) * field[tuple((first + corner)[::-1])]
                          for corner in itertools.product((0, 1), repeat=len(point))))
    return np.array(values)


def simulate(arguments, scale, points):
    """The effective config, and the displacements at the points for the factors `scale`."""
    output = os.path.join(arguments.output, "simulation_" + "_".join(f"{factor:g}" for factor in scale))
    print(f"simulating with strain_scale {scale.tolist()}", flush=True)
    run_command([*(["mpirun", "-np", arguments.ranks] if arguments.ranks > 1 else []), arguments.program, "-config",
                 arguments.config, "-task", "simulate", "-output", output, "-overwrite",
                 "-set", f"material.strain_scale={scale.tolist()}", *arguments.rest])
    config, result = read_json(output, "config.json"), read_fields(os.path.join(output, "result.h5"))
    field = result["displacement"]
    if arguments.released:
        if "release_displacement" not in result:
            raise RunError("the simulation knows no release of this part")
        field = field + result["release_displacement"]
    return config, interpolate(field, result, config["domain"]["size"], points - origin_of(config))


def simulate_all(arguments, points, factors):
    """The effective config, and U_ab [a][b][point][axis] of u(s) = sum_ab sqrt(s_a s_b) U_ab; U_ab of two
    factors is not 0 where there is shear. A column of `factors` is the axes that a factor is of."""
    count = factors.shape[1]
    forms = np.zeros((count, count, *points.shape))
    for a in range(count):
        config, forms[a, a] = simulate(arguments, factors[:, a], points)
    for a, b in itertools.combinations(range(count), 2):
        _, both = simulate(arguments, factors[:, a] + factors[:, b], points)
        forms[a, b] = forms[b, a] = 0.5 * (both - forms[a, a] - forms[b, b])
    return config, forms


def rigid_motions(points):
    """Displacements of the points in every rigid motion, [motion][point][axis]."""
    dimension = points.shape[1]
    motions = [np.tile(row, (len(points), 1)) for row in np.eye(dimension)]
    for a, b in itertools.combinations(range(dimension), 2):
        turn = np.zeros_like(points)
        turn[:, a], turn[:, b] = -points[:, b], points[:, a]
        motions.append(turn)
    return np.array(motions)


def fit(forms, measured):
    """Factors that come closest to the measured values, whether these determine each of them, and the
    differences that are left. `forms`: [a][b][value]."""
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
    roots = np.where(determined, np.abs(roots), 1.0)
    return roots**2, determined, measured - roots @ (roots @ forms)


def calibrate(arguments):
    printed = run_command([arguments.program, "-config", arguments.config, "-task", "check", *arguments.rest]).stdout
    dimension = re.search(r"^bounding box.*?\[(.*?)\]", printed, re.MULTILINE)[1].count(",") + 1
    points, measured = read_points(arguments.measured, dimension)
    os.makedirs(arguments.output, exist_ok=True)
    factors = np.ones((dimension, 1)) if arguments.isotropic else np.eye(dimension)
    config, forms = simulate_all(arguments, points, factors)

    known = np.isfinite(measured)
    values, forms, basis = measured[known], forms[..., known], np.zeros((known.sum(), 0))
    if arguments.rigid:
        left, sizes, _ = np.linalg.svd(rigid_motions(points - points.mean(0))[:, known].T, full_matrices=False)
        basis = left[:, sizes > 1e-9 * sizes[0]]
    if len(values) <= basis.shape[1]:
        raise RunError(f"{len(values)} measured values determine nothing beside a rigid motion")
    # What no rigid motion explains.
    scale, determined, rest = fit(forms - forms @ basis @ basis.T, values - basis @ (basis.T @ values))

    scale, determined = factors @ scale, (factors @ determined).astype(bool)
    config.pop("run", None)
    config["material"]["strain_scale"] = scale.tolist()
    record = {"strain_scale": scale.tolist(), "determined": determined.tolist(), "points": len(points),
              "measured_values": len(rest), "rms_measured": float(np.sqrt(np.mean(measured[known]**2))),
              "rms_difference": float(np.sqrt(np.mean(rest**2))), "largest_difference": float(np.abs(rest).max())}
    write_json(os.path.join(arguments.output, "config.json"), config)
    write_json(os.path.join(arguments.output, "calibration.json"), record)
    for axis in np.flatnonzero(~determined):
        print(f"warning: the points say nothing about the factor along {AXES[axis]}, which stays 1", file=sys.stderr)
    print(f"strain_scale {[round(float(s), 6) for s in scale]}")
    print(f"rms of {len(rest)} measured values {record['rms_measured']:.4g}, of the differences "
          f"{record['rms_difference']:.4g}, largest {record['largest_difference']:.4g}")
    print(f"config with these factors: {os.path.join(arguments.output, 'config.json')}")


def main():
    parser = parser_of(__doc__)
    parser.add_argument("config")
    parser.add_argument("measured")
    parser.add_argument("--output", required=True)
    parser.add_argument("--released", action="store_true",
                        help="what was measured is the part after its release from plate or clamps")
    parser.add_argument("--rigid", action="store_true",
                        help="the points were measured in a frame of their own: rigid motions do not count")
    parser.add_argument("--isotropic", action="store_true", help="one factor for all axes")
    parser.add_argument("--program", default=PROGRAM)
    parser.add_argument("--ranks", type=int, default=1)
    calibrate(parse(parser))


if __name__ == "__main__":
    run_script(main)
