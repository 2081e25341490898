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

    --released    what was measured is the part after its release from plate or clamps
    --rigid       the points were measured in a frame of their own: rigid motions do not count
    --isotropic   one factor for all axes

Factors that the points say nothing about stay 1, with a warning.
"""

import argparse
import csv
import itertools
import json
import os
import subprocess
import sys

import h5py
import numpy as np

AXES = "xyz"
UNDETERMINED = 1e-6  # of the largest singular value


class CalibrationError(Exception):
    """Something that cannot be fitted, with the reason."""


def read_points(path, dimension):
    """Positions (n, dimension) and displacements (n, dimension), NaN where nothing was measured."""
    try:
        with open(path, encoding="utf-8-sig", newline="") as file:
            rows = list(csv.DictReader(line for line in file if line.strip() and not line.startswith("#")))
    except OSError as error:
        raise CalibrationError(f"{path}: {error.strerror}") from error
    columns = [*AXES[:dimension], *("u" + axis for axis in AXES[:dimension])]
    if not rows:
        raise CalibrationError(f"{path}: holds no points")
    missing = [name for name in columns if name not in {(key or "").strip() for key in rows[0]}]
    if missing:
        raise CalibrationError(f"{path}: the first line names no column {', '.join(missing)}; needed: {', '.join(columns)}")
    values = np.full((len(rows), len(columns)), np.nan)
    for number, row in enumerate(rows):
        cells = {(key or "").strip(): (value or "").strip() for key, value in row.items() if not isinstance(value, list)}
        for place, name in enumerate(columns):
            try:
                if cells[name] or place < dimension:
                    values[number, place] = float(cells[name])
            except ValueError as error:
                raise CalibrationError(f"{path}, point {number + 1}, column {name}: '{cells[name]}' is no number") from error
    return values[:, :dimension], values[:, dimension:]


class Interpolation:
    """Displacements at points within the model's elements, from those of the nodes."""

    def __init__(self, result, size, points):
        solid = result["density"][()] > 0
        if "substrate" in result:
            solid |= result["substrate"][()] > 0
        elements = np.array(solid.shape[::-1])
        spacing = np.array(size) / elements
        self.nodes, self.weights = [], []
        for number, point in enumerate(points):
            first = self.element(solid, elements, point / spacing)
            if first is None:
                raise CalibrationError(f"point {number + 1} at {point.tolist()} lies neither in the part nor in the substrate")
            local = np.clip(point / spacing - first, 0.0, 1.0)
            corners = list(itertools.product((0, 1), repeat=len(elements)))
            self.nodes.append([tuple((first + corner)[::-1]) for corner in corners])
            self.weights.append([np.prod(np.where(corner, local, 1.0 - local)) for corner in corners])

    @staticmethod
    def element(solid, elements, position):
        """Lowest index of an element that contains the position; points on a face belong to both sides."""
        tolerance = 1e-6
        choices = [sorted({int(np.clip(np.floor(x + shift), 0, n - 1)) for shift in (0.0, -tolerance, tolerance)})
                   for x, n in zip(position, elements)]
        for index in itertools.product(*choices):
            inside = all(i - tolerance <= x <= i + 1 + tolerance for i, x in zip(index, position))
            if inside and solid[index[::-1]]:
                return np.array(index)
        return None

    def __call__(self, field):
        return np.array([sum(w * field[node] for w, node in zip(weights, nodes))
                         for weights, nodes in zip(self.weights, self.nodes)])


class Simulations:
    """The displacements that scales of the strain lead to."""

    def __init__(self, arguments, points):
        self.arguments, self.points = arguments, points
        self.interpolation = None

    def displacement(self, scale):
        """At the points, for the factors `scale`; (points, dimension)."""
        name = "simulation_" + "_".join(f"{factor:g}" for factor in scale)
        output = os.path.join(self.arguments.output, name)
        command = ["mpirun", "-np", str(self.arguments.ranks)] if self.arguments.ranks > 1 else []
        command += [self.arguments.program, "-config", self.arguments.config, "-task", "simulate", "-output", output,
                    "-overwrite", "-set", f"material.strain_scale={json.dumps([float(s) for s in scale])}",
                    *self.arguments.options]
        print(f"simulating with strain_scale {[float(s) for s in scale]}", flush=True)
        try:
            run = subprocess.run(command, capture_output=True, text=True, check=False)
        except OSError as error:
            raise CalibrationError(f"cannot run {command[0]}: {error.strerror}") from error
        if run.returncode != 0:
            raise CalibrationError(f"the simulation failed (status {run.returncode}): {(run.stderr or run.stdout).strip()}")
        with open(os.path.join(output, "config.json"), encoding="utf-8") as file:
            self.effective = json.load(file)
        with h5py.File(os.path.join(output, "result.h5"), "r") as result:
            if self.interpolation is None:
                self.interpolation = Interpolation(result, self.effective["domain"]["size"], self.points)
            field = result["displacement"][()]
            if self.arguments.released:
                if "release_displacement" not in result:
                    raise CalibrationError("the simulation knows no release of this part")
                field = field + result["release_displacement"][()]
        return self.interpolation(field)


class Model:
    """u(s) = sum_a s_a U_a + sum_(a<b) sqrt(s_a s_b) U_ab, the second where there is shear."""

    def __init__(self, simulations, dimension, isotropic):
        self.groups = [tuple(range(dimension))] if isotropic else [(axis,) for axis in range(dimension)]
        self.dimension = dimension
        self.alone = [simulations.displacement(self.factors([1.0 if g == i else 0.0 for g in range(len(self.groups))]))
                      for i in range(len(self.groups))]
        self.together = {}
        for a, b in itertools.combinations(range(len(self.groups)), 2):
            both = simulations.displacement(self.factors([1.0 if g in (a, b) else 0.0 for g in range(len(self.groups))]))
            self.together[a, b] = both - self.alone[a] - self.alone[b]

    def factors(self, of_groups):
        """A factor per axis."""
        result = np.zeros(self.dimension)
        for group, value in zip(self.groups, of_groups):
            result[list(group)] = value
        return result

    def displacement(self, roots):
        """For the roots of the factors, in which it is a polynomial."""
        total = sum(r * r * u for r, u in zip(roots, self.alone))
        return total + sum(roots[a] * roots[b] * u for (a, b), u in self.together.items())

    def derivative(self, roots):
        columns = [2.0 * r * u for r, u in zip(roots, self.alone)]
        for (a, b), u in self.together.items():
            columns[a] = columns[a] + roots[b] * u
            columns[b] = columns[b] + roots[a] * u
        return columns


def rigid_motions(points):
    """Displacements of the points in every rigid motion."""
    dimension = points.shape[1]
    motions = [np.tile(row, (len(points), 1)) for row in np.eye(dimension)]
    for a, b in itertools.combinations(range(dimension), 2):
        turn = np.zeros_like(points)
        turn[:, a], turn[:, b] = -points[:, b], points[:, a]
        motions.append(turn)
    return motions


def fit(model, points, measured, rigid):
    """Factors, whether the points determine each, and what is left at the measured values."""
    known = np.isfinite(measured)
    basis = np.zeros((known.sum(), 0))
    if rigid:
        columns = np.stack([motion[known] for motion in rigid_motions(points - points.mean(0))], 1)
        left, sizes, _ = np.linalg.svd(columns, full_matrices=False)
        basis = left[:, sizes > 1e-9 * sizes[0]]

    def free(values):
        """What no rigid motion explains."""
        return values - basis @ (basis.T @ values)

    roots = np.ones(len(model.groups))
    target = free(measured[known])
    if known.sum() <= basis.shape[1]:
        raise CalibrationError(f"{known.sum()} measured values determine nothing beside a rigid motion")
    best = np.linalg.norm(target - free(model.displacement(roots)[known]))
    damping = 1e-6
    for _ in range(200):
        rest = target - free(model.displacement(roots)[known])
        jacobian = np.stack([free(column[known]) for column in model.derivative(roots)], 1)
        normal = jacobian.T @ jacobian
        step = np.linalg.solve(normal + damping * max(normal.diagonal().max(), 1e-300) * np.eye(len(roots)), jacobian.T @ rest)
        size = np.linalg.norm(target - free(model.displacement(roots + step)[known]))
        if size <= best:
            roots, best, damping = roots + step, size, 0.1 * damping
            if np.abs(step).max() < 1e-13:
                break
        else:
            damping = max(10.0 * damping, 1e-12)
            if damping > 1e6:
                break
    sizes = np.linalg.norm(np.stack([free(u[known]) for u in model.alone], 1), axis=0)
    determined = sizes > UNDETERMINED * max(sizes.max(), np.linalg.norm(target))
    jacobian = np.stack([free(column[known]) for column in model.derivative(np.ones(len(roots)))], 1)[:, determined]
    singular = np.linalg.svd(jacobian, compute_uv=False)
    if determined.any() and singular[-1] < UNDETERMINED * singular[0]:
        raise CalibrationError("the points cannot tell the factors of the axes apart: measure more of them, or --isotropic")
    scale = np.where(determined, roots**2, 1.0)
    rest = np.full(measured.shape, np.nan)
    difference = measured - model.displacement(np.sqrt(scale))
    rest[known] = free(difference[known])
    return model.factors(scale), model.factors(determined).astype(bool), rest


def calibrate(arguments):
    try:
        result = subprocess.run([arguments.program, "-config", arguments.config, "-task", "check", *arguments.options],
                                capture_output=True, text=True, check=False)
    except OSError as error:
        raise CalibrationError(f"cannot run {arguments.program}: {error.strerror}") from error
    if result.returncode != 0:
        raise CalibrationError(result.stderr.strip())
    dimension = len(next(line for line in result.stdout.splitlines() if line.startswith("bounding box"))
                    .split("[")[1].split("]")[0].split(","))
    points, measured = read_points(arguments.measured, dimension)
    os.makedirs(arguments.output, exist_ok=True)
    simulations = Simulations(arguments, points)
    model = Model(simulations, dimension, arguments.isotropic)
    scale, determined, rest = fit(model, points, measured, arguments.rigid)

    known = np.isfinite(measured)
    config = simulations.effective
    config.pop("run", None)
    config["material"]["strain_scale"] = scale.tolist()
    record = {"strain_scale": scale.tolist(), "determined": determined.tolist(), "points": len(points),
              "measured_values": int(known.sum()), "rms_measured": float(np.sqrt(np.mean(measured[known]**2))),
              "rms_difference": float(np.sqrt(np.mean(rest[known]**2))),
              "largest_difference": float(np.abs(rest[known]).max())}
    for name, content in (("config.json", config), ("calibration.json", record)):
        with open(os.path.join(arguments.output, name), "w", encoding="utf-8") as file:
            json.dump(content, file, indent=2)
            file.write("\n")
    for axis in np.flatnonzero(~determined):
        print(f"warning: the points say nothing about the factor along {AXES[axis]}, which stays 1", file=sys.stderr)
    print(f"strain_scale {[round(float(s), 6) for s in scale]}")
    print(f"rms of {known.sum()} measured values {record['rms_measured']:.4g}, of the differences "
          f"{record['rms_difference']:.4g}, largest {record['largest_difference']:.4g}")
    print(f"config with these factors: {os.path.join(arguments.output, 'config.json')}")


def main():
    words = sys.argv[1:]
    options = words[words.index("--") + 1:] if "--" in words else []
    words = words[:words.index("--")] if "--" in words else words
    root = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("config")
    parser.add_argument("measured")
    parser.add_argument("--output", required=True)
    parser.add_argument("--released", action="store_true")
    parser.add_argument("--rigid", action="store_true")
    parser.add_argument("--isotropic", action="store_true")
    parser.add_argument("--program", default=os.path.join(root, "build", "release", "fabseq"))
    parser.add_argument("--ranks", type=int, default=1)
    arguments = parser.parse_args(words)
    arguments.options = options
    try:
        calibrate(arguments)
    except CalibrationError as error:
        sys.exit(f"calibrate.py: {error}")


if __name__ == "__main__":
    main()
