# SPDX-License-Identifier: MIT
"""Which sequence was built: that of a run's result, or what a config itself says."""

import os

import h5py
import numpy as np

from fabseq_tools.run.command_line import RunError
from fabseq_tools.run.read_run import read_config, read_json, repair_option

GIVEN = "-design", "-sequence"  # options of the program that name a sequence
MOST_OTHERS = 0.01              # share of elements that may be in another layer than the run's
DESIGN = "design", "time_points", "angles"
ALLOWED = "the folder of a run that has ended, of -task optimize, simulate or evaluate, or a config"
OF_ITS_RUN = "the folder of the run that it is from"


class BuiltSequence:
    """`place`: as the user named it. `path`: of the config; `config`: as it was written. `options`: of the
    program, with which it simulates what was built. `folder`: the run's, None of a config."""

    def __init__(self, place, rest):
        """`place`: the folder of a run, or a config; that of a run stands for its folder. `rest`: the user's
        own options of the program."""
        given = [word for word in rest if word in GIVEN]
        self.place, self.has_given, self.layers, self.options = place, bool(given), None, []
        self.folder = place if os.path.isdir(place) else folder_of(place)
        if self.folder is None or (given and not os.path.isdir(place)):
            self.folder, self.path, self.config = None, place, read_config(place)
            return
        if given:
            raise RunError(f"{place}: found a run's folder, which has its sequence, beside {given[0]}; allowed: one of the two")
        self.path, self.config = os.path.join(self.folder, "config.json"), read_json(self.folder, "config.json")
        self.take(self.folder)

    def take(self, folder):
        """The design, and the layers that it has to give."""
        self.options = ["-binary"]
        file = os.path.join(folder, "result.h5")
        if not os.path.isfile(file):
            self.options += design_of_evaluation(folder, self.config.get("run", {}))
            return
        has_summary = os.path.isfile(os.path.join(folder, "summary.json"))
        repair = repair_option(read_json(folder, "summary.json")) if has_summary else []
        try:
            with h5py.File(file, "r") as content:
                if any(name in content for name in DESIGN):
                    self.options += ["-design", file, *repair]
                elif repair:
                    self.options += ["-sequence", file]
                self.layers = content["layer"][()] if "layer" in content else None
        except OSError as error:
            raise RunError(f"{file} cannot be read: {error}") from error

    def refuse_other_layers(self, layer):
        """Raises a RunError if the layers of a simulation are not the run's. Other solver tolerances may move
        single elements."""
        if self.layers is None:
            return
        share = 1.0
        if layer.shape == self.layers.shape:  # smooth layers of sub-parts may count empty ones, too
            share = np.mean(np.unique(layer, return_inverse=True)[1] != np.unique(self.layers, return_inverse=True)[1])
        if share > MOST_OTHERS:
            raise RunError(f"{self.folder}: found {100 * share:.3g} % of the elements in other layers than result.h5 has; "
                           "allowed: a run of this version of the program, with its own config.json")


def design_of_evaluation(folder, run):
    """The options that name the design that -task evaluate took, which writes none. `run`: the block in
    config.json."""
    if not os.path.isfile(os.path.join(folder, "evaluation.json")):
        raise RunError(f"{folder}: holds no result.h5; allowed: {ALLOWED}")
    design = run.get("design")
    if design is None and "-design" not in run.get("command_line", "").split():
        return []
    if not (design and os.path.isfile(design)):
        raise RunError(f"{folder}: the design that was evaluated is not there: {design}; allowed: {OF_ITS_RUN}")
    if os.path.getmtime(design) > os.path.getmtime(os.path.join(folder, "evaluation.json")):
        raise RunError(f"{folder}: {design} has changed since it was evaluated; allowed: {OF_ITS_RUN}")
    return ["-design", design]


def folder_of(path):
    """The folder of a run whose config.json this is, None of any other config."""
    folder = os.path.dirname(path) or "."
    is_run = os.path.basename(path) == "config.json" and os.path.isfile(os.path.join(folder, "result.h5"))
    return folder if is_run and "run" in read_config(path) else None


def without_sequence(rest):
    """The user's options of the program without those that name a sequence, which -task check does not
    take."""
    result, words = [], iter(rest)
    for word in words:
        if word in GIVEN:
            next(words, None)
        else:
            result.append(word)
    return result
