# SPDX-License-Identifier: MIT
"""The grid of a config's box: its nodes and elements, and which of them belong to a part."""

import numpy as np


def origin_of(config):
    """Lower corner of the box of a config."""
    return np.array(config["domain"].get("origin", [0.0] * len(config["domain"]["size"])))


def origin_of_slabs(config):
    """The point from which the heights of a config's multi-planar layers are measured."""
    given = config["layers"].get("origin", "auto")
    return origin_of(config) if given == "auto" else np.array(given)


def refined(domain, finer):
    """A section `domain` with so many times as many elements along each axis."""
    return domain | {"elements": [finer * count for count in domain["elements"]]}


def element_edges(config):
    return [length / n for length, n in zip(config["domain"]["size"], config["domain"]["elements"])]


def element_centres(config, cells):
    """Of elements by their indices (n, dimension), slowest axis first, as fields have them."""
    return origin_of(config) + np.array(element_edges(config)) * (np.asarray(cells)[:, ::-1] + 0.5)


def up_of(config):
    """Unit normal of the build plate, away from it."""
    plate = config.get("build_plate", "z-")
    return np.eye(len(config["domain"]["size"]))["xyz".index(plate[0])] * (1.0 if plate[1] == "-" else -1.0)


def plate_height(config):
    """Of the build plate, along its normal."""
    up = up_of(config)
    return (origin_of(config) + np.where(up < 0, config["domain"]["size"], 0.0)) @ up


def node_positions(size, elements):
    """Coordinates of all nodes of a box, (n, dimension), x fastest."""
    axes = [np.linspace(0.0, length, n + 1) for length, n in zip(size, elements)]
    return np.stack([grid.ravel() for grid in np.meshgrid(*axes[::-1], indexing="ij")[::-1]], axis=1)


def in_space(vectors):
    """Vectors with a third component, 0 in 2D."""
    return np.pad(vectors, ((0, 0), (0, 3 - vectors.shape[1])))


def nodes_of(built):
    """Which nodes belong to an element of the part, flat, x fastest."""
    touched = np.zeros([n + 1 for n in built.shape], dtype=bool)
    for corner in np.ndindex(*(2,) * built.ndim):
        touched[tuple(slice(c, c + n) for c, n in zip(corner, built.shape))] |= built
    return touched.ravel()
