# SPDX-License-Identifier: MIT
"""A measured part with the simulations from which its displacement follows for any strain."""

import itertools
import os
import re

import numpy as np

from fabseq_tools.calibration.measured_points import read_measurement
from fabseq_tools.calibration.measurements import Displacements, Scan
from fabseq_tools.calibration.voxel_model import VoxelModel
from fabseq_tools.run.command_line import RunError, run_program
from fabseq_tools.run.read_run import read_config, read_fields, read_json

SINGLE_LAYER = {"sequence": '{"type": "planar"}', "layers": '{"count": 1}', "projection": "{}", "baseline": "{}",
                "objective": "[]", "constraints": "[]", "output": "{}"}


class MeasuredPart:
    """Reads the measurement, of a config that the program accepts. `arguments`: the command's;
    `output`: the directory of this part. `dimension`: 2 or 3. `is_heated`: whether its temperature is
    computed."""

    def __init__(self, arguments, path, measured, output):
        self.arguments, self.path, self.measured, self.output = arguments, path, measured, output
        config = read_config(path)
        printed = run_program(arguments, path, "check")
        self.dimension = re.search(r"^bounding box.*?\[(.*?)\]", printed, re.MULTILINE)[1].count(",") + 1
        self.is_heated = re.search(r"^temperature:", printed, re.MULTILINE) is not None
        self.points, self.displacements = read_measurement(measured, self.dimension, config.get("domain", {}).get("unit"))

    def make_model(self, warn):
        """`config`, the effective one, and `measurement`, from a simulation of one layer."""
        print(f"{self.path}: making the model, with a single layer", flush=True)
        settings = itertools.chain(*(("-set", f"{key}={value}") for key, value in SINGLE_LAYER.items()))
        self.config, _, fields = self.simulate("model", *settings)
        model = VoxelModel(self.config, fields)
        tolerance = self.arguments.tolerance
        self.measurement = (Scan(model, self.points, self.config, tolerance, warn) if self.displacements is None else
                            Displacements(model, self.points, self.displacements, tolerance))

    def simulate(self, name, *options):
        """The effective config, the summary and the fields of a simulation."""
        output = os.path.join(self.output, name)
        run_program(self.arguments, self.path, "simulate", "-output", output, "-overwrite", *options)
        return (read_json(output, "config.json"), read_json(output, "summary.json"),
                read_fields(os.path.join(output, "result.h5")))

    def simulate_all(self, factors, vanishing=None):
        """Fields U_ab [a][b][z][y][x][axis] of u(s) = sum_ab sqrt(s_a s_b) U_ab. U_ab of two factors is not 0
        where there is shear. A column of `factors` is the axes that a factor is of. `vanishing`: of the
        strain, by default the config's."""
        count = factors.shape[1]
        forms = [[None] * count for _ in range(count)]
        for a in range(count):
            forms[a][a] = self.displacement_for(factors[:, a], vanishing)
        for a, b in itertools.combinations(range(count), 2):
            both = self.displacement_for(factors[:, a] + factors[:, b], vanishing)
            forms[a][b] = forms[b][a] = 0.5 * (both - forms[a][a] - forms[b][b])
        return np.array(forms)

    def displacement_for(self, scale, vanishing):
        """Of the nodes, for the factors `scale`. Sets `config`, and `interpass`, the temperatures at which
        layers begin, if they are computed."""
        name, options, words = "simulation_" + "_".join(f"{factor:g}" for factor in scale), [], ""
        if vanishing is not None:
            name, words = f"{name}_vanishing_{vanishing:g}", f", vanishing {vanishing:g}"
            options = ["-set", f"thermal.vanishing={vanishing!r}"]
        print(f"{self.path}: simulating with strain_scale {scale.tolist()}{words}", flush=True)
        self.config, summary, result = self.simulate(name, "-set", f"material.strain_scale={scale.tolist()}", *options)
        self.interpass = [layer["interpass_temperature"] for layer in summary["layers"] if "interpass_temperature" in layer]
        if not self.arguments.released:
            return result["displacement"]
        if "release_displacement" not in result:
            raise RunError("the simulation knows no release of this part")
        return result["displacement"] + result["release_displacement"]
