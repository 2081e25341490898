# SPDX-License-Identifier: MIT
"""Which points of a grid lie inside a mesh whose bodies may overlap, and where edges of a grid leave it."""

import numpy as np
from vtkmodules.vtkCommonCore import mutable

ASIDE = (1.7e-4, 2.3e-4)  # of a cell: columns of the grid are moved so much, off the mesh's edges and corners


def inside(corners, axes):
    """Whether the points of a grid [z][y][x] with coordinates `axes` lie inside the triangles `corners` (n,
    3, 3): the signed number of triangles beyond a point, along each axis, is not 0 for two axes at least.
    Small holes spoil one axis only."""
    numbers = [crossings_beyond(corners, axes, axis) for axis in range(3)]
    return np.median(numbers, axis=0) != 0


def crossings_beyond(corners, axes, axis):
    """The signed number of triangles that a ray along the axis crosses, from each point [z][y][x] on."""
    others = [a for a in range(3) if a != axis]
    steps = [axes[a][1] - axes[a][0] for a in others]
    lines = [axes[a] + aside * step for a, aside, step in zip(others, ASIDE, steps)]
    flat = corners[:, :, others]
    first = [np.searchsorted(line, flat[:, :, k].min(axis=1)) for k, line in enumerate(lines)]
    count = [np.searchsorted(line, flat[:, :, k].max(axis=1)) - low for k, (line, low) in enumerate(zip(lines, first))]
    pairs = count[0] * count[1]
    triangle = np.repeat(np.arange(len(corners)), pairs)
    place = np.arange(pairs.sum()) - np.repeat(np.cumsum(pairs) - pairs, pairs)
    u, v = first[0][triangle] + place // count[1][triangle], first[1][triangle] + place % count[1][triangle]
    point = np.stack([lines[0][u], lines[1][v]], axis=1)
    a, b, c = np.moveaxis(flat[triangle], 1, 0)
    weights = np.stack([cross(b - point, c - point), cross(c - point, a - point), cross(a - point, b - point)], axis=1)
    hit = np.all(weights > 0, axis=1) | np.all(weights < 0, axis=1)
    weights, triangle, u, v = weights[hit], triangle[hit], u[hit], v[hit]
    height = np.einsum("nk,nk->n", weights, corners[triangle, :, axis]) / weights.sum(axis=1)
    below = np.searchsorted(axes[axis], height)  # points before the triangle
    result = np.zeros([len(lines[0]), len(lines[1]), len(axes[axis]) + 1], int)
    sense = -1 if axis == 1 else 1  # x and z, in this order, turn the other way
    np.add.at(result, (u, v, below), sense * np.sign(weights[:, 0]).astype(int))
    result = np.cumsum(result[:, :, ::-1], axis=2)[:, :, ::-1][:, :, 1:]
    return np.moveaxis(result, (0, 1, 2), [2 - a for a in (*others, axis)])


def cross(a, b):
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]


def share_inside(surface, inner, outer):
    """Share of each way from an inner to an outer point (n, 3) at which it leaves the surface for good; NaN
    where it does not meet it."""
    shares = np.full(len(inner), np.nan)
    share, cell, part, place, parameters = mutable(0.0), mutable(0), mutable(0), [0.0] * 3, [0.0] * 3
    for number, (start, end) in enumerate(zip(outer, inner)):
        if surface.locator.IntersectWithLine(start, end, 0.0, share, place, parameters, part, cell):
            shares[number] = 1.0 - share.get()
    return shares
