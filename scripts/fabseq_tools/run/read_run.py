# SPDX-License-Identifier: MIT
"""Reads the output directory of a run: what pictures and tables need of a finished optimization or
simulation."""

import json
import math
import os
import re

import h5py
import numpy as np

from fabseq_tools.run.command_line import RunError
from fabseq_tools.run.tables import text_of

KINDS = {dict: "an object", list: "a list", str: "a text", int: "a number", float: "a number", bool: "true or false",
         type(None): "null"}
SECTIONS = {"domain": dict, "part": dict, "sequence": dict, "objective": list, "constraints": list}


class Run:
    """An output directory with the result of `-task optimize`, with `simulations` also of `-task simulate`.
    Raises RunError if there is none.

    `config`, `summary`: as in the files; `summary` has a block `simulated` after a simulation. `history`: one
    dictionary per iteration. `fields`: datasets of result.h5 by name, unless told to leave them. `unit`: that
    of lengths, "" where the config names none.
    """

    def __init__(self, directory, with_fields=True, simulations=False):
        config, summary = read_json(directory, "config.json"), read_json(directory, "summary.json")
        simulated = simulations and "responses" in summary
        if "optimized" not in summary and not simulated:
            status = summary.get("status", "none")
            raise RunError(f"{directory}: holds no finished optimization{' or simulation' if simulations else ''} "
                           f"(status: {status})")
        self.take(config, summary, [] if simulated else read_history(directory),
                  read_fields(os.path.join(directory, "result.h5")) if with_fields else {})

    def take(self, config, summary, history, fields):
        self.config, self.summary, self.history, self.fields = config, summary, history, fields
        if "responses" in summary:
            summary["simulated"] = summary
        self.iterations = np.array([line["iteration"] for line in self.history])
        self.name = self.config.get("name", "part")
        self.unit = self.config.get("domain", {}).get("unit") or ""
        terms = self.config.get("objective", [])
        self.distortion_term = next((i for i, term in enumerate(terms) if term["type"] == "distortion"), 0)
        self.distortion_config = terms[self.distortion_term] if terms else {}

    def layer_count(self):
        """How many layers the run has made: of a config whose `layers.count` is "auto", too."""
        return len(self.summary.get("optimized", self.summary.get("simulated"))["layers"])

    def distortion(self, block):
        """The first distortion term, or else the first objective, of `optimized`, `binary` or `baseline`."""
        name = f"objective_{self.distortion_term}"
        return next(r["value"] for r in self.summary[block]["responses"] if r["name"] == name)

    def length(self, block):
        """The same as a length: the root of a distortion, which is a square. Of angle it is degrees."""
        value = self.distortion(block)
        return math.sqrt(value) if self.distortion_config.get("type") == "distortion" else value

    def length_unit(self):
        """The unit of length(); "" where measure() says it or there is none."""
        term = self.distortion_config
        return self.unit if term.get("type") == "distortion" and term.get("measure") != "angle" else ""

    def measure(self, term=None):
        """What the length of a distortion term, by default the first, is, in words."""
        term = term or self.distortion_config
        place = f" of {term['nodes'].replace('_', ' ')}" if term.get("nodes") else ""
        displacement = f"root of the {'mean' if term.get('mean') else 'sum'} of squared displacements{place}"
        if "norm" in term:
            displacement = f"displacement{place}, mean of power {term['norm']:g}"
        return {"displacement": displacement, "flatness": f"unevenness{place} along {term.get('axis')}",
                "shape": f"deviation of the shape{place}", "angle": f"change of the angle{place}, degrees",
                "layerwise": "root of the sum of all layers' squared displacements"}.get(term.get("measure"), "first objective")

    def thickness_constraint(self):
        """The config's layer_thickness constraint with the target of simulated layers, or None."""
        found = [c for c in self.config.get("constraints", []) if c["type"] == "layer_thickness"]
        return {"tolerance": 0.1, **found[0], "target": passes_of(self.config) * found[0]["target"]} if found else None

    def layers(self, block):
        """Number (from 1), thickness, cv and volume of the layers that hold an element at least: what is less
        is the faint tail of smooth layers after the last one."""
        table = self.summary[block]["layers"]
        domain = self.config["domain"]
        least = 0.99 * math.prod(domain["size"]) / math.prod(domain["elements"]) * domain.get("thickness", 1.0)
        return [dict(layer, number=j) for j, layer in enumerate(table, start=1) if layer["volume"] > least]


def passes_of(config):
    """Real layers, each a bead high, that a simulated layer stands for."""
    return config.get("layers", {}).get("passes", 1)


def pauses_in_layer(config):
    """Real layers with a pause each that a simulated layer stands for: thermal.passes, which may follow
    layers.passes."""
    given = config.get("thermal", {}).get("passes", "layers")
    return passes_of(config) if given == "layers" else given


def passes_entry(config):
    """The same as a part of a section `layers`, empty where each layer is real."""
    return {"passes": passes_of(config)} if passes_of(config) > 1 else {}


def target_thickness(config):
    """How thick simulated layers shall be, or None."""
    bead = bead_thickness(config)
    return None if bead is None else passes_of(config) * bead


def slab_thickness(config):
    """How thick simulated multi-planar layers are."""
    return passes_of(config) * config["layers"].get("thickness", 3.0)


def bead_thickness(config):
    """How thick real layers shall be, by layers.target or else a layer_thickness constraint, or None."""
    given = config.get("layers", {}).get("target")
    if isinstance(given, (int, float)):
        return given
    targets = [c.get("target") for c in config.get("constraints", []) if c.get("type") == "layer_thickness"]
    return next((target for target in targets if isinstance(target, (int, float))), None)


def lacking(dataset, path):
    """The error for a dataset that every result has."""
    return RunError(f"{path}: lacks the dataset {dataset}; repeat the run, or simulate its design again with -task simulate "
                    "-design FILE")


def text_of_run(directory, name):
    """The path of a file of a run, and its text."""
    path = os.path.join(directory, name)
    try:
        return path, text_of(path, "a text file of a run")
    except (FileNotFoundError, NotADirectoryError) as error:
        raise RunError(f"{path} is missing: not the output directory of a finished run") from error


def repair_option(summary):
    """[-repair] for a run whose layers were mended, which mends those of its design again; else []."""
    return ["-repair"] if "repair" in summary else []


def read_json(directory, name):
    path, text = text_of_run(directory, name)
    return object_of(text, path)


def object_of(text, place):
    """The object that a JSON text is. Sections of a config are checked, too: another file has others."""
    try:
        content = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise RunError(f"{place}: is no JSON ({error}); allowed: an object") from error
    if not isinstance(content, dict):
        raise RunError(f"{place}: found {KINDS[type(content)]}; allowed: an object")
    for key, kind in SECTIONS.items():
        if key in content and not isinstance(content[key], kind):
            raise RunError(f"{place}: /{key}: found {KINDS[type(content[key])]}; allowed: {KINDS[kind]}")
    return content


def read_config(path):
    """A config as it was written, which may have comments."""
    text = text_of(path, "a config (JSON)")
    text = re.sub(r'("(?:\\.|[^"\\])*")|//[^\n]*|/\*.*?\*/', lambda found: found[1] or " ", text, flags=re.DOTALL)
    return object_of(text, path)


def read_history(directory):
    """A dictionary per iteration; a last line that is still being written is left out."""
    path, text = text_of_run(directory, "history.jsonl")
    return [object_of(line, f"{path}, line {number}") for number, line in enumerate(text.split("\n")[:-1], start=1)]


def check_grid(path, file, config):
    """Refuses a result whose elements are not those of the config beside it."""
    found, allowed = file["density"].shape, tuple(config["domain"]["elements"][::-1])
    if found != allowed:
        raise RunError(f"{path}: density: found the shape {list(found)}; allowed: {list(allowed)}, as config.json has elements")


def read_fields(path):
    """The datasets of an HDF5 file, by name."""
    fields = {}
    try:
        with h5py.File(path, "r") as file:
            file.visititems(lambda name, item: fields.update(
                {name: item[()]} if isinstance(item, h5py.Dataset) else {}))
    except OSError as error:
        raise RunError(f"{path} cannot be read: {error}") from error
    return fields
