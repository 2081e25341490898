# SPDX-License-Identifier: MIT
"""The grid of a config's box: its nodes and elements, and which of them belong to a part."""

import numpy as np


def origin_of(config):
    """Lower corner of the box of a config."""
    return np.array(config["domain"].get("origin", [0.0] * len(config["domain"]["size"])))


def element_edges(config):
    return [length / n for length, n in zip(config["domain"]["size"], config["domain"]["elements"])]


def node_positions(size, elements):
    """Coordinates of all nodes of a box, (n, dimension), x fastest."""
    axes = [np.linspace(0.0, length, n + 1) for length, n in zip(size, elements)]
    return np.stack([grid.ravel() for grid in np.meshgrid(*axes[::-1], indexing="ij")[::-1]], axis=1)


def nodes_of(built):
    """Which nodes belong to an element of the part, flat, x fastest."""
    touched = np.zeros([n + 1 for n in built.shape], dtype=bool)
    for corner in np.ndindex(*(2,) * built.ndim):
        touched[tuple(slice(c, c + n) for c, n in zip(corner, built.shape))] |= built
    return touched.ravel()
