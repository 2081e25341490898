# SPDX-License-Identifier: MIT
"""A measured part with the simulations from which its displacement follows for any strain."""

import itertools
import json
import os
import re

import numpy as np

from fabseq_tools.calibration.built_sequence import BuiltSequence, without_sequence
from fabseq_tools.calibration.measured_points import read_measurement
from fabseq_tools.calibration.measurements import Displacements, Scan
from fabseq_tools.calibration.voxel_model import VoxelModel
from fabseq_tools.run.command_line import RunError, run_program
from fabseq_tools.run.read_run import read_fields, read_json

SINGLE_LAYER = {"sequence": '{"type": "planar"}', "layers": '{"count": 1}', "projection": "{}", "baseline": "{}",
                "process.model": "linear", "objective": "[]", "constraints": "[]", "output": "{}"}
PHYSICS = "/material", "/thermal", "/process", "/domain", "/part", "/substrate"  # sections of a config
NO_RELEASE = "the simulation knows no release of this part"
RELEASED = {False: "displacement", True: "released_displacement"}  # datasets of result.h5


class MeasuredPart:
    """Reads the measurement, of a config that the program accepts. `arguments`: the command's; `place`: the
    folder of a run, or a config; `output`: the directory of this part; `warn`: is called with what the user
    should know. `dimension`: 2 or 3. `is_heated`: whether its temperature is computed; `flows`: whether its
    material flows. `fields`: [a][b], of simulate_all() or with one factor, by whether they are after the
    release; none for a given `vanishing`."""

    def __init__(self, arguments, place, measured, output, warn):
        self.arguments, self.measured, self.output, self.warn, self.fields = arguments, measured, output, warn, {}
        self.built = BuiltSequence(place, arguments.rest)
        self.path = self.built.path
        self.simulations = []
        self.rest = without_sequence(arguments.rest)
        printed = run_program(arguments, self.path, "check", rest=self.rest, warn_of=self.warn_of_physics)
        self.dimension = re.search(r"^bounding box.*?\[(.*?)\]", printed, re.MULTILINE)[1].count(",") + 1
        self.is_heated = re.search(r"^temperature:", printed, re.MULTILINE) is not None
        self.flows = re.search(r"^plastic flow:", printed, re.MULTILINE) is not None
        self.has_design = re.search(r"^design variables: (?!0 )", printed, re.MULTILINE) is not None
        self.read = read_measurement(measured, self.dimension, self.built.config.get("domain", {}).get("unit"), arguments.unit)
        for remark in self.read.remarks:
            warn(remark)

    def warn_of_physics(self, text):
        """Passes on what the program warns of, but for what optimizations are warned of."""
        if text.startswith(PHYSICS):
            self.warn(f"{self.path}: {text}")

    def make_model(self):
        """`config`, the effective one, its section `material`, and `measurement`, from a simulation of one
        layer."""
        print(f"{self.path}: making the model, with a single layer", flush=True)
        settings = itertools.chain(*(("-set", f"{key}={value}") for key, value in SINGLE_LAYER.items()))
        self.config, _, fields = self.simulate("model", self.rest, settings)
        self.material = self.config["material"]
        model, kind = VoxelModel(self.config, fields), Scan if self.read.displacements is None else Displacements
        self.measurement = kind(model, self.read, self.config, self.arguments.tolerance)
        print(f"{self.built.place}: simulating {self.words_of_sequence()}", flush=True)

    def words_of_sequence(self):
        """What is simulated."""
        if self.built.folder is not None:
            return "the binary layers of this run"
        return "the start design of this config" if self.is_start_design() else "the sequence of this config"

    def is_start_design(self):
        return self.built.folder is None and self.has_design and not self.built.has_given

    def warning(self):
        """What the user should know of the sequence, or None."""
        if not self.is_start_design():
            return None
        return (f"{self.path}: {self.words_of_sequence()} was simulated, no optimized one; allowed for what a run has found: the "
                "folder of the run")

    def simulate(self, name, rest, options):
        """The effective config, the summary and the fields of a simulation."""
        output = os.path.join(self.output, name)
        self.simulations.append(output)
        run_program(self.arguments, self.path, "simulate", *options, "-output", output, "-overwrite", rest=rest)
        return (read_json(output, "config.json"), read_json(output, "summary.json"),
                read_fields(os.path.join(output, "result.h5")))

    def simulate_all(self, factors, vanishing=None):
        """Fields U_ab [a][b][z][y][x][axis] of u(s) = sum_ab sqrt(s_a s_b) U_ab. U_ab of two factors is not 0
        where there is shear. A column of `factors` is the axes that a factor is of. `vanishing`: of the
        strain, by default the config's."""
        count, sums = factors.shape[1], {}
        for a, b in itertools.combinations_with_replacement(range(count), 2):
            sums[a, b] = self.displacements_for(factors[:, a] + (a != b) * factors[:, b], vanishing)
        fields = {}
        for released in set.intersection(*map(set, sums.values())):
            forms = [[None] * count for _ in range(count)]
            for a, b in sums:
                own = sums[a, b][released]
                forms[a][b] = forms[b][a] = own if a == b else 0.5 * (own - sums[a, a][released] - sums[b, b][released])
            fields[released] = np.array(forms)
        if self.arguments.released not in fields:
            raise RunError(NO_RELEASE)
        if vanishing is None:
            self.fields = fields
        return fields[self.arguments.released]

    def displacements_for(self, scale, vanishing):
        """Of the nodes, for the factors `scale`, by whether they are after the release."""
        name, words = "simulation_" + "_".join(f"{factor:g}" for factor in scale), f"strain_scale {scale.tolist()}"
        settings = {"material.strain_scale": scale.tolist()}
        if vanishing is not None:
            name, words = f"{name}_vanishing_{vanishing:g}", f"{words}, vanishing {vanishing:g}"
            settings["thermal.vanishing"] = vanishing
        return self.displacements_with(name, words, settings)

    def simulate_material(self, name, words, material):
        """Fields u [z][y][x][axis], by whether they are after the release, with other values of keys of the
        section material."""
        fields = self.displacements_with(name, words, {f"material.{key}": value for key, value in material.items()})
        if self.arguments.released not in fields:
            raise RunError(NO_RELEASE)
        return fields

    def displacements_with(self, name, words, settings):
        """Of the nodes, by whether they are after the release. Sets `config`, and `interpass`, the
        temperatures at which layers begin, if they are computed."""
        print(f"{self.path}: simulating with {words}", flush=True)
        options = [word for key, value in settings.items() for word in ("-set", f"{key}={json.dumps(value)}")]
        config, summary, result = self.simulate(name, self.arguments.rest, [*options, *self.built.options])
        self.built.refuse_other_layers(result["layer"])
        self.config = config if self.built.folder is None else self.built.config
        self.interpass = [layer["interpass_temperature"] for layer in summary["layers"] if "interpass_temperature" in layer]
        return {released: result[name] for released, name in RELEASED.items() if name in result}
