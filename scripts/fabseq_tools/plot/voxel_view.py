# SPDX-License-Identifier: MIT
"""A view of a box of cells, each with a colour: solids from the front, the right and above, flat parts from
the front. Cells lie in arrays with one axis per axis of the box, x first."""

import numpy as np
from matplotlib.colors import to_rgb

# Axonometric: x runs to the right and down a little, y to the right and up, z up.
AXES = np.array([[0.87, -0.32], [0.62, 0.42], [0.0, 0.92]])
# The sides that are seen: axis, whether it is its upper end, brightness.
SEEN = [(0, True, 0.72), (1, False, 0.88), (2, True, 1.0)]


class Box:
    """`cells` along each axis, and the edges of a cell."""

    def __init__(self, cells, edges):
        self.edges = np.asarray(edges, dtype=float)
        self.flat = len(cells) == 2
        self.axes = np.eye(2) if self.flat else AXES

    def project(self, points):
        """Places on the picture of points in cells, [...][axis]."""
        return (points * self.edges) @ self.axes


def rectangle(low, axis, upper, size=1.0):
    """Corners of the faces at an end of an axis of cuboids, [cuboid][corner][axis]; in two dimensions `axis`
    is None, and the cuboids are rectangles."""
    low = np.asarray(low, dtype=float)
    dimension = low.shape[-1]
    across = [other for other in range(dimension) if other != axis]
    corners = np.zeros((4, dimension))
    if axis is not None:
        corners[:, axis] = upper
    for corner, ends in zip(corners, ((0, 0), (1, 0), (1, 1), (0, 1))):
        corner[across] = ends[:len(across)]
    return low[..., None, :] + corners * size


def side(cells, axis, upper):
    """Corners of the box's side at an end of an axis; in two dimensions a line there and back."""
    return rectangle(np.zeros(len(cells)), axis, upper, np.asarray(cells, dtype=float))


def faces_of_cells(content, colours):
    """Corners and colours of all faces that are seen, from the back to the front. `content` of a place: 0 for
    no cell, or the number of its colour, from 1 on."""
    if content.ndim == 2:
        places = np.argwhere(content)
        return rectangle(places, None, False), [colours[content[tuple(place)] - 1] for place in places]
    corners, shades, order = [], [], []
    for number, (axis, upper, brightness) in enumerate(SEEN):
        places = np.argwhere((content > 0) & (beside(content, axis, upper) == 0))
        dimmed = np.array([to_rgb(colour) for colour in colours]) * brightness
        corners.append(rectangle(places, axis, upper))
        shades.append(dimmed[content[tuple(places.T)] - 1])
        order.append(np.column_stack([places, np.full(len(places), number)]))
    # Cells behind come first, then those below, then those on the left.
    x, y, z, number = np.concatenate(order).T
    sequence = np.lexsort((number, x, z, -y))
    return np.concatenate(corners)[sequence], np.concatenate(shades)[sequence]


def beside(content, axis, upper):
    """What lies beside each cell, 0 at the end of the box."""
    moved = np.zeros_like(content)
    into, out_of = [slice(None)] * 3, [slice(None)] * 3
    into[axis], out_of[axis] = (slice(None, -1), slice(1, None)) if upper else (slice(1, None), slice(None, -1))
    moved[tuple(into)] = content[tuple(out_of)]
    return moved
