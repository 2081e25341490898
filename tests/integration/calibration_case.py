# SPDX-License-Identifier: MIT
"""What the tests of fabseq-tools calibrate share: synthetic measurements, and the command."""

import json
import os
import subprocess
import sys

import numpy as np

from read_outputs import read_result
from run_fabseq import ENVIRONMENT, FabseqTest, PROGRAM, ROOT

TOOL = os.path.join(ROOT, "scripts", "fabseq-tools"), "calibrate"


def node_positions(config):
    """[z][y][x][axis], of an effective config."""
    domain = config["domain"]
    axes = [low + np.linspace(0, edge, n + 1)
            for low, edge, n in zip(domain.get("origin", [0, 0, 0]), domain["size"], domain["elements"])]
    return np.stack(np.meshgrid(*axes[::-1], indexing="ij")[::-1], axis=-1)


class CalibrationCase(FabseqTest):
    def measure(self, config, scale, released=False):
        """Nodes of part and substrate and their displacements for these factors."""
        config.setdefault("material", {})["strain_scale"] = scale
        run = self.run_config(1, config, "-task", "simulate", "-tolerance", "1e-10")
        self.assert_done(run)
        config["material"]["strain_scale"] = [1.0] * len(scale)
        return self.moved_nodes(run, "released_displacement" if released else "displacement")

    def moved_nodes(self, run, dataset):
        """Nodes of a run that a dataset moves, and how far."""
        field = read_result(run)[dataset]
        there = np.abs(field).max(-1) > 0
        return node_positions(run.json("config.json"))[there], field[there]

    def write_points(self, positions, displacements, gaps=0, name="measured.csv"):
        """Every seventh of them; the first `gaps` without displacement along x."""
        names = "xyz"[:positions.shape[1]]
        path = os.path.join(self.directory, name)
        with open(path, "w", encoding="utf-8") as file:
            file.write("# made up\n" + ", ".join([*names, *("u" + name for name in names)]) + "\n")
            for number, (x, u) in enumerate(zip(positions[::7], displacements[::7], strict=True)):
                values = ["" if number < gaps and i == 0 else repr(float(value)) for i, value in enumerate(u)]
                file.write(",".join([*(repr(float(value)) for value in x), *values]) + "\n")
        return path

    def write_table(self, rows, header, name="measured.csv"):
        path = os.path.join(self.directory, name)
        np.savetxt(path, rows, delimiter=",", header=header, comments="", encoding="utf-8")
        return path

    def calibrate(self, config, measured, *options):
        return self.calibrate_parts([self.write_config(config), measured], *options)

    def calibrate_parts(self, words, *options):
        """`words`: pairs of what was built and what was measured."""
        command = [sys.executable, *TOOL, *words, "--program", PROGRAM, "--output",
                   os.path.join(self.directory, "calibrated"), *options, "--", "-tolerance", "1e-10"]
        return subprocess.run(command, capture_output=True, text=True, cwd=self.directory, check=False,
                              env={**ENVIRONMENT, **os.environ})

    def read(self, name):
        with open(os.path.join(self.directory, "calibrated", name), encoding="utf-8") as file:
            return json.load(file)
