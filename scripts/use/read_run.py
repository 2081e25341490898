# SPDX-License-Identifier: MIT
"""What the pictures and tables need of a finished optimization: reads the output directory of a run."""

import json
import math
import os

import h5py
import numpy as np


class Run:
    """An output directory with the result of `-task optimize`. Raises RunError if there is none.

    `config`, `summary`: as in the files. `history`: one dictionary per iteration. `fields`: datasets of
    result.h5 by name, unless told to leave them.
    """

    def __init__(self, directory, with_fields=True):
        self.config = read_json(directory, "config.json")
        self.summary = read_json(directory, "summary.json")
        if "optimized" not in self.summary:
            raise RunError(f"{directory}: holds no finished optimization (status: {self.summary.get('status', 'none')})")
        with open_text(directory, "history.jsonl") as file:
            self.history = [json.loads(line) for line in file if line.strip()]
        self.fields = {}
        if not with_fields:
            return
        with open_result(directory) as file:
            file.visititems(lambda name, item: self.fields.update({name: item[()]} if isinstance(item, h5py.Dataset) else {}))

    @property
    def name(self):
        return self.config.get("name", "part")

    def distortion(self, block):
        """The first distortion term (the first objective, if there is none) of `optimized`, `binary` or
        `baseline`."""
        return next(r["value"] for r in self.summary[block]["responses"] if r["name"] == f"objective_{self.distortion_term}")

    @property
    def distortion_term(self):
        types = [term["type"] for term in self.config.get("objective", [])]
        return types.index("distortion") if "distortion" in types else 0

    def distortion_history(self):
        return np.array([line["objective"][self.distortion_term] for line in self.history], dtype=float)

    def measure(self):
        """What the distortion is, in words."""
        terms = self.config.get("objective", [])
        term = terms[self.distortion_term] if terms else {}
        place = f" of {term['nodes'].replace('_', ' ')}" if term.get("nodes") else ""
        return {"displacement": ("mean" if term.get("mean") else "sum") + f" of squared displacements{place}",
                "flatness": f"unevenness{place} along {term.get('axis')}",
                "layerwise": "sum of squared displacements of all layers"}.get(term.get("measure"), "first objective")

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
        """Numbers of the nodes whose distortion is the first term; empty if they cannot be told from the
        config."""
        terms = self.config.get("objective", [])
        node_set = terms[self.distortion_term].get("nodes") if terms else None
        if node_set not in self.config.get("node_sets", {}):
            return np.array([], dtype=int)
        built = self.fields["density"] > 0
        size = self.config["domain"]["size"]
        axes = [np.linspace(0.0, length, n + 1) for length, n in zip(size, built.shape[::-1])]
        points = np.stack([g.ravel() for g in np.meshgrid(*axes[::-1], indexing="ij")[::-1]], axis=1)
        slack = 1e-6 * min(length / n for length, n in zip(size, built.shape[::-1]))
        try:
            inside = contains(self.config["node_sets"][node_set], points, slack)
        except NotImplementedError:
            return np.array([], dtype=int)
        return np.nonzero(inside & nodes_of(built))[0]


class RunError(Exception):
    """An output directory that cannot be shown, with the reason."""


def open_text(directory, name):
    path = os.path.join(directory, name)
    try:
        return open(path, encoding="utf-8")
    except FileNotFoundError as error:
        raise RunError(f"{path} is missing: not the output directory of a finished run") from error
    except OSError as error:
        raise RunError(f"{path}: {error.strerror}") from error


def read_json(directory, name):
    with open_text(directory, name) as file:
        try:
            return json.load(file)
        except ValueError as error:
            raise RunError(f"{file.name} is no JSON: {error}") from error


def open_result(directory):
    path = os.path.join(directory, "result.h5")
    try:
        return h5py.File(path, "r")
    except OSError as error:
        raise RunError(f"{path} cannot be read: {error}") from error


def duration(seconds):
    return f"{seconds:.0f} s" if seconds < 120 else f"{seconds / 60:.0f} min" if seconds < 7200 else f"{seconds / 3600:.1f} h"


def nodes_of(built):
    """Which nodes belong to an element of the part, flat, x fastest."""
    touched = np.zeros([n + 1 for n in built.shape], dtype=bool)
    for corner in np.ndindex(*(2,) * built.ndim):
        touched[tuple(slice(c, c + n) for c, n in zip(corner, built.shape))] |= built
    return touched.ravel()


def contains(shape, points, slack):
    """Which of `points` (n, dimension) a shape of a config holds. Polygons are not needed and raise
    NotImplementedError."""
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
