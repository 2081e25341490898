# SPDX-License-Identifier: MIT
"""Part and layers of a run on a grid of half its elements' size: what the size of the elements changes."""

import os

import h5py
import numpy as np

from fabseq_tools.geometry.grid import refined


def finer_settings(bricks, path):
    """Settings of a simulation of the same part and layers, each element as 2x2x2; writes both to `path`."""
    layer = bricks.grid
    for axis in range(3):
        layer = np.repeat(layer, 2, axis=axis)
    with h5py.File(path, "w") as file:
        file["density"] = (layer > 0).astype(float)
        file["time"] = (np.maximum(layer, 1) - 0.5) / bricks.layers  # void and substrate have no time
    path = os.path.abspath(path)
    return {"domain": refined(bricks.config["domain"], 2), "part": {"voxels": {"file": path}},
            "layers": {"type": "curved", "count": bricks.layers},
            "sequence": {"type": "file", "file": path, "dataset": "time"}}


def at_coarse_nodes(values, shape):
    """Every second node along each axis of a finer run. `shape`: of the coarse elements, [z][y][x]."""
    nodes = [2 * count + 1 for count in shape]
    return values.reshape(*nodes, 3)[::2, ::2, ::2].reshape(-1, 3)
