# SPDX-License-Identifier: MIT
"""The configs of configs/ and configs/published/ with few elements, few layers and two iterations: each runs
in about a second."""

import glob
import json
import math
import os
import re

import h5py
import numpy as np

MOST_ELEMENTS = {2: 1600, 3: 1100}
LAYERS = 3


def without_comments(text):
    """JSON without what follows // outside of strings."""
    return re.sub(r'("(?:[^"\\]|\\.)*")|//[^\n]*', lambda match: match.group(1) or "", text)


def coarser_voxels(source, target, factor):
    """Writes means over blocks of so many voxels along each axis; returns the elements along x, y and z."""
    with h5py.File(source, "r") as file:
        density = np.asarray(file["density"], dtype=float)
    density = np.pad(density, [(0, -count % factor) for count in density.shape])
    shape = [size for count in density.shape for size in (count // factor, factor)]
    density = density.reshape(shape).mean(axis=tuple(range(1, len(shape), 2)))
    with h5py.File(target, "w") as file:
        file["density"] = density
    return list(density.shape[::-1])


def shrink_grid(config, folder, target_folder):
    domain, part = config["domain"], config["part"]
    elements, most = domain["elements"], MOST_ELEMENTS[len(domain["elements"])]
    factor = next(factor for factor in range(1, max(elements)) if math.prod(-(-n // factor) for n in elements) <= most)
    if "voxels" not in part:
        domain["elements"] = [max(1, round(count / factor)) for count in elements]
        return
    name = os.path.basename(part["voxels"]["file"])
    target = os.path.join(target_folder, name)
    domain["elements"] = coarser_voxels(os.path.join(folder, part["voxels"]["file"]), target, factor)
    part["voxels"].update(file=name, threshold=0.3)
    if "start" in config["sequence"]:
        config["sequence"]["start"] = "plate"  # a place of the fine part, where the coarse one may have no element


def shrink_layers(config):
    layers, edge = config["layers"], max(config["domain"]["size"])
    if layers.get("type") == "multi_planar":
        layers["thickness"] = edge / 5
        return
    layers["count"] = LAYERS
    for constraint in config.get("constraints", []):
        if constraint["type"] == "layer_thickness":
            constraint["target"] = edge / (LAYERS + 1)


def widened_node_sets(config):
    """Nodes on a line or a ring are hit on the config's own grid only: sets reach an element further."""
    edge = max(size / count for size, count in zip(config["domain"]["size"], config["domain"]["elements"]))
    for node_set in config.get("node_sets", {}).values():
        node_set.pop("samples", None)
        node_set["within"] = edge


def shrunken(path, target_folder):
    """A dict; voxels go to `target_folder`, where the config is to be written."""
    with open(path, encoding="utf-8") as file:
        config = json.loads(without_comments(file.read()))
    shrink_grid(config, os.path.dirname(path), target_folder)
    shrink_layers(config)
    widened_node_sets(config)
    config["part"]["keep"] = "connected"
    optimizer = config.setdefault("optimizer", {})
    optimizer["max_iterations"] = 2
    if "binary_iterations" in optimizer:
        optimizer["binary_iterations"] = 1
    config["output"] = {"every": 1, "checkpoint_every": 1}
    return config


def shrunken_configs(folder, target_folder):
    """All of the folder and of its folder `published`, by name."""
    paths = sorted([*glob.glob(os.path.join(folder, "*.json")), *glob.glob(os.path.join(folder, "published", "*.json"))],
                   key=os.path.basename)
    return {os.path.basename(path)[:-5]: shrunken(path, target_folder) for path in paths if not path.endswith("cases.json")}
