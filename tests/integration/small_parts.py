# SPDX-License-Identifier: MIT
"""Configs of small parts for the tests of this folder, as dicts; every call makes a new one."""

import h5py
import numpy as np


def plate_2d():
    """A wall of 2 x 1.2 on the plate y-, 20 x 12 elements: runs in a second."""
    return {
        "name": "plate",
        "domain": {"size": [2.0, 1.2], "elements": [20, 12], "thickness": 0.5},
        "part": {"difference": [{"box": {"min": [0, 0], "max": [2, 1.2]}},
                                {"sphere": {"center": [2.0, 0.6], "radius": 0.31}}]},
        "node_sets": {"top": {"box": {"min": [0, 1.2], "max": [2, 1.2]}}},
        "sequence": {"type": "heat", "characteristic_length": 2.0},
        "layers": {"count": 4},
        "objective": [{"type": "distortion", "nodes": "top", "least_squares": False}, {"type": "layer_uniformity", "weight": 1}],
        "constraints": [{"type": "layer_thickness", "target": 0.3}],
    }


def direct_2d(location="nodes"):
    """The wall of plate_2d with the pseudo-time itself as design, from the lower left corner on, and variable
    time points."""
    config = plate_2d()
    config["name"] = "direct_" + location
    config["sequence"] = {"type": "direct", "location": location, "start": {"box": {"min": [0, 0], "max": [0, 0]}}}
    config["layers"]["time_points"] = "variable"
    config["constraints"] = [{"type": "deposition_speed", "slack": 0.02}, {"type": "continuity"},
                             {"type": "minimum_layer_volume", "fraction": 0.05}]
    if location == "nodes":
        config["constraints"].insert(0, {"type": "layer_thickness", "target": 0.4, "tolerance": 0.3})
    else:
        del config["objective"][1]
    return config


def hook_3d():
    """A post with an overhanging arm, 8 x 4 x 8 elements of which a third are empty."""
    return {
        "name": "hook",
        "domain": {"size": [1.6, 0.8, 1.6], "elements": [8, 4, 8]},
        "part": {"union": [{"box": {"min": [0, 0, 0], "max": [0.8, 0.8, 1.6]}},
                           {"box": {"min": [0, 0, 1.0], "max": [1.6, 0.8, 1.6]}}]},
        "node_sets": {"edge": {"box": {"min": [1.6, 0, 1.6], "max": [1.6, 0.8, 1.6]}},
                      "top": {"box": {"min": [0, 0, 1.6], "max": [1.6, 0.8, 1.6]}}},
        "sequence": {"type": "heat", "characteristic_length": 1.6},
        "layers": {"count": 3},
        "objective": [{"type": "distortion", "nodes": "edge", "least_squares": False},
                      {"type": "distortion", "measure": "flatness", "axis": "z", "nodes": "top", "least_squares": False},
                      {"type": "layer_uniformity", "weight": 1}],
        "constraints": [{"type": "layer_thickness", "target": 0.55}, {"type": "deposition_speed"}],
    }


def v_2d():
    """A wall that leans out over its foot, 24 x 24 elements: built in planar layers its top moves far, in
    curved ones little."""
    return {
        "name": "v",
        "domain": {"size": [2.0, 2.0], "elements": [24, 24]},
        "part": {"difference": [{"union": [{"box": {"min": [0, 0], "max": [2, 0.6]}},
                                           {"box": {"min": [1.2, 0], "max": [2, 2]}}]},
                                {"half_space": {"point": [1, 0], "normal": [-1, 1]}}]},
        "node_sets": {"tip": {"box": {"min": [1.7, 2], "max": [2, 2]}}},
        "sequence": {"type": "heat", "characteristic_length": 2.5},
        "layers": {"count": 8},
        "objective": [{"type": "distortion", "nodes": "tip", "least_squares": False}, {"type": "layer_uniformity", "weight": 1}],
        "constraints": [{"type": "layer_thickness", "target": 0.3125, "tolerance": 0.15}],
    }


def post_on_substrate(dimension=3):
    """An overhang on a clamped base plate, of strain that turns with the layers, measured before and after
    the release."""
    flat = dimension == 2

    def box(low, high):
        return {"box": {"min": low[::2] if flat else low, "max": high[::2] if flat else high}}

    return {
        "name": "post",
        "domain": {"size": [1.6, 1.2], "elements": [12, 10]} if flat else
                  {"size": [1.6, 0.8, 1.2], "elements": [8, 4, 7]},
        "part": {"union": [box([0.4, 0.2, 0.2], [1.0, 0.6, 1.2]), box([0.4, 0.2, 0.8], [1.6, 0.6, 1.2])]},
        "substrate": box([0, 0, 0], [1.6, 0.8, 0.3]),
        "clamps": box([0, 0, 0], [0, 0.8, 0.4]),
        "node_sets": {"arm": box([1.6, 0, 0.8], [1.6, 0.8, 1.2]), "underside": box([0, 0, 0], [1.6, 0.8, 0])},
        "material": {"inherent_strain": {"tangential": -0.01, "normal": 0.002}},
        "sequence": {"type": "heat", "characteristic_length": 1.2},
        "layers": {"count": 4},
        "objective": [{"type": "distortion", "nodes": "arm", "mean": True, "after_release": True, "least_squares": False},
                      {"type": "distortion", "measure": "flatness", "axis": "y" if flat else "z", "nodes": "underside",
                       "after_release": True, "least_squares": False},
                      {"type": "distortion", "nodes": "arm", "least_squares": False},
                      {"type": "layer_uniformity", "weight": 1}],
        "constraints": [{"type": "layer_thickness", "target": 0.3}],
    }


def write_voxels(path, density, dataset="density"):
    with h5py.File(path, "w") as file:
        file[dataset] = np.asarray(density, dtype=float)


def part_density(config):
    """Density of plate_2d and of hook_3d at element centres, [z][y][x]."""
    size, elements = config["domain"]["size"], config["domain"]["elements"]
    axes = [(np.arange(n) + 0.5) * edge / n for n, edge in zip(elements, size)]
    center = np.meshgrid(*axes[::-1], indexing="ij")[::-1]
    if len(size) == 2:
        return 1.0 * ((center[0] - 2.0)**2 + (center[1] - 0.6)**2 > 0.31**2)
    return 1.0 * ((center[0] < 0.8) | (center[2] > 1.0))


def touched_nodes(density):
    """Nodes of elements with density above 0."""
    touched = np.zeros([n + 1 for n in density.shape], bool)
    for corner in np.ndindex(*[2] * density.ndim):
        touched[tuple(slice(c, c + n) for c, n in zip(corner, density.shape))] |= density > 0
    return touched
