# SPDX-License-Identifier: MIT
"""Reads the output directory of a run: what pictures and tables need of a finished optimization or
simulation."""

import itertools
import json
import math
import os
import re

import h5py
import numpy as np

from command_line import RunError


NOT_COMPARED = ("name", "run", "output")  # keys of a config that do not change the result


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
        """The config's layer_thickness constraint, or None."""
        found = [c for c in self.config.get("constraints", []) if c["type"] == "layer_thickness"]
        return {"tolerance": 0.1, **found[0]} if found else None

    def layers(self, block):
        """Number (from 1), thickness, cv and volume of the layers that hold an element at least: what is less
        is the faint tail of smooth layers after the last one."""
        table = self.summary[block]["layers"]
        domain = self.config["domain"]
        least = 0.99 * math.prod(domain["size"]) / math.prod(domain["elements"]) * domain.get("thickness", 1.0)
        return [dict(layer, number=j) for j, layer in enumerate(table, start=1) if layer["volume"] > least]

    def measured_nodes(self):
        """Numbers of the nodes whose distortion is the first term; empty if the config does not tell them."""
        shape = self.config.get("node_sets", {}).get(self.distortion_config.get("nodes"))
        if shape is None or shape.get("all") or shape.get("surface"):
            return np.array([], dtype=int)  # or so many that marks would hide the part
        try:
            return self.nodes_of_set(shape)
        except NotImplementedError:
            return np.array([], dtype=int)

    def nodes_of_set(self, node_set):
        """Numbers of the part's nodes in a node set of the config. Samples, what is near the shape and a
        substrate are not looked at. Raises NotImplementedError for polygons."""
        shape = {key: value for key, value in node_set.items() if key not in ("all", "surface", "samples", "within")}
        built = self.fields["density"] > 0
        chosen = surface_nodes_of(built) if node_set.get("surface") else nodes_of(built)
        if shape:
            size = self.config["domain"]["size"]
            slack = 1e-6 * min(length / n for length, n in zip(size, built.shape[::-1]))
            chosen &= contains(shape, node_positions(size, built.shape[::-1]) + origin_of(self.config), slack)
        return np.flatnonzero(chosen)


def open_text(directory, name):
    path = os.path.join(directory, name)
    try:
        return open(path, encoding="utf-8")
    except FileNotFoundError as error:
        raise RunError(f"{path} is missing: not the output directory of a finished run") from error


def read_json(directory, name):
    with open_text(directory, name) as file:
        try:
            return json.load(file)
        except ValueError as error:
            raise RunError(f"{file.name} is no JSON: {error}") from error


def read_config(path):
    """A config as it was written, which may have comments."""
    with open(path, encoding="utf-8") as file:
        text = re.sub(r'("(?:\\.|[^"\\])*")|//[^\n]*|/\*.*?\*/', lambda found: found[1] or " ", file.read(), flags=re.DOTALL)
    try:
        config = json.loads(text)
    except ValueError as error:
        raise RunError(f"{path} is no JSON: {error}") from error
    if not isinstance(config, dict):
        raise RunError(f"{path}: holds no object")
    return config


def read_history(directory):
    """A dictionary per iteration; a last line that is still being written is left out."""
    with open_text(directory, "history.jsonl") as file:
        return [json.loads(line) for line in file if line.endswith("\n")]


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


def duration(seconds):
    if seconds < 120:
        return f"{seconds:.0f} s" if seconds >= 1 else f"{seconds:.1g} s"
    return f"{seconds / 60:.0f} min" if seconds < 7200 else f"{seconds / 3600:.1f} h"


def factor(value):
    """As many digits as mean something: 1.3, 41, 1,060."""
    return f"{value:.1f}" if value < 9.95 else f"{value:,.0f}"


def number(value):
    """Three digits, with a power of ten where needed: 0.127, 3.07·10⁻³."""
    if value == 0 or 1e-2 <= abs(value) < 1e4:
        return f"{value:.3g}"
    mantissa, exponent = f"{value:.2e}".split("e")
    return f"{mantissa}·10" + str(int(exponent)).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))


def quantity(value, unit):
    """A number with its unit, where it has one."""
    return f"{number(value)} {unit}".rstrip()


def flat(value, path=""):
    """(path as of -set, value) of a config's entries. Entries of lists go by their type if it is unique."""
    if isinstance(value, (dict, list)):
        for key, entry in value.items() if isinstance(value, dict) else zip(entry_names(value), value):
            yield from flat(entry, f"{path}.{key}" if path else str(key))
    else:
        yield path, value


def differing_keys(runs):
    """In the order of their `settings`; a key that only some of them have counts, too."""
    keys = dict.fromkeys(key for run in runs for key in run.settings)
    return [key for key in keys if len({repr(run.settings.get(key)) for run in runs}) > 1]


def entry_names(entries):
    types = [entry.get("type") if isinstance(entry, dict) else None for entry in entries]
    return [kind if kind and types.count(kind) == 1 else number for number, kind in enumerate(types)]


def node_positions(size, elements):
    """Coordinates of all nodes of a box, (n, dimension), x fastest."""
    axes = [np.linspace(0.0, length, n + 1) for length, n in zip(size, elements)]
    return np.stack([grid.ravel() for grid in np.meshgrid(*axes[::-1], indexing="ij")[::-1]], axis=1)


def origin_of(config):
    """Lower corner of the box of a config."""
    return np.array(config["domain"].get("origin", [0.0] * len(config["domain"]["size"])))


def nodes_of(built):
    """Which nodes belong to an element of the part, flat, x fastest."""
    touched = np.zeros([n + 1 for n in built.shape], dtype=bool)
    for corner in np.ndindex(*(2,) * built.ndim):
        touched[tuple(slice(c, c + n) for c, n in zip(corner, built.shape))] |= built
    return touched.ravel()


def surface_nodes_of(built):
    """Which nodes of the part have fewer elements around them than an inner node has, flat, x fastest."""
    empty = nodes_of(~np.pad(built, 1)).reshape([n + 3 for n in built.shape])
    return nodes_of(built) & empty[(slice(1, -1),) * built.ndim].ravel()


def rigid_motions(points):
    """Displacements of the points in every rigid motion, linearized, [motion][point][axis]."""
    dimension = points.shape[1]
    motions = [np.tile(row, (len(points), 1)) for row in np.eye(dimension)]
    for a, b in itertools.combinations(range(dimension), 2):
        turn = np.zeros_like(points)
        turn[:, a], turn[:, b] = -points[:, b], points[:, a]
        motions.append(turn)
    return np.array(motions)


def without_rigid_motion(displacements, points):
    """What is left of displacements of points, (n, axis) both, after the best rigid fit."""
    motions = rigid_motions(points - points.mean(axis=0)).reshape(-1, points.size).T
    fit = motions @ np.linalg.lstsq(motions, displacements.ravel(), rcond=1e-9)[0]
    return displacements - fit.reshape(points.shape)


def contains(shape, points, slack):
    """Which of `points` (n, dimension) a shape of a config holds. Raises NotImplementedError for polygons."""
    kind, value = next((k, v) for k, v in shape.items() if k != "samples")
    if kind in ("union", "intersection", "difference"):
        first, *others = [contains(child, points, slack) for child in value]
        for other in others:
            first = first | other if kind == "union" else first & other if kind == "intersection" else first & ~other
        return first
    if kind == "box":
        return np.all((points >= np.array(value["min"]) - slack) & (points <= np.array(value["max"]) + slack), axis=1)
    if kind == "half_space":
        normal = np.array(value["normal"], dtype=float)
        return (points - value["point"]) @ normal <= slack * np.linalg.norm(normal)
    if kind == "sphere":
        return np.linalg.norm(points - value["center"], axis=1) <= value["radius"] + slack
    if kind == "cylinder":
        axis = np.subtract(value["to"], value["from"]).astype(float)
        length = np.linalg.norm(axis)
        along = (points - value["from"]) @ (axis / length)
        radius = np.linalg.norm(points - value["from"] - np.outer(along, axis / length), axis=1)
        return (along >= -slack) & (along <= length + slack) & (radius <= value["radius"] + slack)
    raise NotImplementedError(kind)
