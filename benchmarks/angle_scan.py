#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Draws an objective over the print angle of one sub-part, with the number of layers and the adjoint's
derivative: that nothing jumps where slabs come and go.

    benchmarks/angle_scan.py [--config configs/multi_planar_2d.json] [--subpart 2] [--points 181] [--range 0
    90]
        [--picture docs/multi_planar_angle.svg] [--program build/release/fabseq] [-- OPTIONS OF THE PROGRAM]

Every point is a run of -task evaluate at the start of the config, whose first objective term is drawn. Where
the number of layers changes between two neighbours, the place is found by halving, and the step of the
objective across it is printed.
"""
import json
import math
import os
import tempfile

import numpy as np

import program_run
from program_run import ROOT

import matplotlib.pyplot as plt

HALVINGS = 26


class Scan:
    """Evaluations of one config at one angle each."""

    def __init__(self, arguments, folder):
        self.arguments = arguments
        self.output = os.path.join(folder, "evaluation")
        self.angles = self.run()["angles"]

    def run(self, *more):
        program_run.run_command([self.arguments.program, "-config", self.arguments.config, "-task", "evaluate",
                                 "-output", self.output, "-overwrite", *self.arguments.rest, *more])
        return program_run.read_json(self.output, "evaluation.json")

    def at(self, angle):
        """Objective, its derivative with respect to the angle, and the number of layers."""
        number = self.arguments.subpart - 1
        angles = [list(row) for row in self.angles]
        angles[number][0] = angle
        evaluation = self.run("-set", f"layers.angles={json.dumps(angles)}")
        gradients = program_run.read_fields(os.path.join(self.output, "gradients.h5"))
        return evaluation["responses"][0]["value"], gradients["objective_0/angles"][number, 0], len(evaluation["layers"])

    def step(self, low, high, layers):
        """The angle where the number of layers leaves `layers`, and the objective's relative step there."""
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if self.at(middle)[2] == layers else (low, middle)
        before, after = self.at(low)[0], self.at(high)[0]
        return 0.5 * (low + high), (after - before) / before


def draw(path, angles, values, slopes, layers, steps):
    degrees = np.degrees(angles)
    figure, (top, bottom) = plt.subplots(2, 1, figsize=(9, 6.2), sharex=True, height_ratios=[3, 1])
    unit = values[-1]
    top.plot(degrees, values / unit, "-", lw=1.2, color="#1b6ca8", label="objective")
    half = 0.35 * (angles[1] - angles[0])
    for angle, value, slope in zip(angles[::4], values[::4], slopes[::4]):
        ends = np.array([angle - half, angle + half])
        top.plot(np.degrees(ends), (value + slope * (ends - angle)) / unit, "-", lw=2.2, color="#d1495b")
    top.plot([], [], "-", lw=2.2, color="#d1495b", label="slope by the adjoint")
    for place, _ in steps:
        for axes in (top, bottom):
            axes.axvline(math.degrees(place), color="#bbb", lw=0.6, zorder=0)
    top.plot([], [], color="#bbb", lw=0.6, label="a slab comes or goes")
    top.set_ylabel("objective, over its last value")
    top.legend(loc="upper right", frameon=False)
    bottom.step(degrees, layers, where="mid", color="#444", lw=1.0)
    bottom.set_ylabel("layers")
    bottom.set_xlabel("print angle of the sub-part, degrees")
    figure.tight_layout()
    figure.savefig(path, metadata={"Date": None} if path.endswith(".svg") else None)


def main():
    parser = program_run.parser_of(__doc__)
    parser.add_argument("--config", default=os.path.join(ROOT, "configs", "multi_planar_2d.json"))
    parser.add_argument("--subpart", type=int, default=2, help="whose angle is turned, from 1")
    parser.add_argument("--points", type=int, default=181)
    parser.add_argument("--range", nargs=2, type=float, default=(0.0, 90.0), help="degrees")
    parser.add_argument("--picture", default=os.path.join(ROOT, "docs", "multi_planar_angle.svg"))
    program_run.add_program_option(parser)
    arguments = program_run.command_line.parse(parser)
    with tempfile.TemporaryDirectory() as folder:
        scan = Scan(arguments, folder)
        angles = np.radians(np.linspace(*arguments.range, arguments.points))
        values, slopes, layers = (np.array(column) for column in zip(*(scan.at(angle) for angle in angles)))
        steps = [scan.step(angles[i], angles[i + 1], layers[i]) for i in range(len(angles) - 1) if layers[i] != layers[i + 1]]
        for place, step in steps:
            print(f"{math.degrees(place):8.4f} degrees: relative step of the objective {step:9.1e}")
        differences = (values[2:] - values[:-2]) / (angles[2:] - angles[:-2])
        print(f"{len(steps)} changes of the number of layers, largest step {max((abs(s) for _, s in steps), default=0.0):.1e}; "
              f"slopes: rms {np.sqrt(np.mean(slopes**2)):.3e}, of differences {np.sqrt(np.mean(differences**2)):.3e}")
        draw(arguments.picture, angles, values, slopes, layers, steps)


if __name__ == "__main__":
    program_run.run_script(main)
