# SPDX-License-Identifier: MIT
"""The layers of a run on a grid of half its elements' size: what the size of the elements changes."""

import os

import h5py
import numpy as np


def finer_settings(bricks, path):
    """Settings of a simulation of the same layers, each element as 2x2x2; writes their times to `path`."""
    layer = np.maximum(bricks.grid, 1)  # void and substrate have no time
    for axis in range(3):
        layer = np.repeat(layer, 2, axis=axis)
    with h5py.File(path, "w") as file:
        file["time"] = (layer - 0.5) / bricks.layers
    return {"domain.elements": [2 * count for count in bricks.grid.shape[::-1]],
            "layers": {"type": "curved", "count": bricks.layers},
            "sequence": {"type": "file", "file": os.path.abspath(path), "dataset": "time"}}


def at_coarse_nodes(values, shape):
    """Every second node along each axis of a finer run. `shape`: of the coarse elements, [z][y][x]."""
    nodes = [2 * count + 1 for count in shape]
    return values.reshape(*nodes, 3)[::2, ::2, ::2].reshape(-1, 3)
