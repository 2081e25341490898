# SPDX-License-Identifier: MIT
"""Tetrahedra with fields at their points, and how to cut them where a field changes its sign. Both sides of a
cut, and neighbouring tetrahedra, share points and triangles, so that what bounds a set of them is closed."""

import itertools

import numpy as np

# An even permutation of a tetrahedron's corners that puts the negative ones first, by their signs (bits).
ORDERS = {bits: next(order for order in itertools.permutations(range(4))
                     if sum(a > b for a, b in itertools.combinations(order, 2)) % 2 == 0
                     and sorted(order[:bin(bits).count("1")]) == [k for k in range(4) if bits >> k & 1])
          for bits in range(1, 15)}
# Corners of a prism, bottom and top, such that any one of them comes first; triangles keep their orientation.
TURNS = np.array([(0, 1, 2, 3, 4, 5), (1, 2, 0, 4, 5, 3), (2, 0, 1, 5, 3, 4),
                  (3, 5, 4, 0, 2, 1), (4, 3, 5, 1, 0, 2), (5, 4, 3, 2, 1, 0)])
FACES = np.array([(1, 2, 3), (0, 3, 2), (0, 1, 3), (0, 2, 1)])  # of a tetrahedron, anticlockwise from outside


class Tetrahedra:
    """`points` (n, 3); `fields`: arrays whose first axis is the points, by name; `corners` (m, 4): numbers of
    points, of positive volume; `label` (m): a whole number per tetrahedron."""

    def __init__(self, points, fields, corners, label=None):
        self.points, self.fields, self.corners = points, fields, corners
        self.label = np.zeros(len(corners), int) if label is None else label

    def volumes(self, chosen=slice(None)):
        a, b, c, d = np.moveaxis(self.points[self.corners[chosen]], 1, 0)
        return np.einsum("ni,ni->n", np.cross(b - a, c - a), d - a) / 6.0

    def part(self, chosen):
        """The chosen tetrahedra, with no points but their own."""
        used, corners = np.unique(self.corners[chosen], return_inverse=True)
        return Tetrahedra(self.points[used], {name: field[used] for name, field in self.fields.items()},
                          corners.reshape(-1, 4), self.label[chosen])

    def cut(self, values, chosen=True):
        """Splits the chosen tetrahedra in which `values`, one per point, have both signs. Returns `values`
        with those of the new points, which are 0, and the two points between which each new point lies."""
        negative = values < 0
        signs = negative[self.corners]
        crossed = chosen & signs.any(axis=1) & (values > 0)[self.corners].any(axis=1)
        corners, signs, label = self.corners[crossed], signs[crossed], self.label[crossed]
        edges = EdgePoints(len(self.points), values)
        cases = {bits: (corners[rows][:, ORDERS[bits]], label[rows])
                 for bits in ORDERS if (rows := np.flatnonzero(signs @ (1, 2, 4, 8) == bits)).size}
        for bits, (four, _) in cases.items():
            edges.add(four, bin(bits).count("1"))
        ends = edges.number()
        pieces = [(piece, of) for bits, (four, of) in cases.items() for piece in split(four, bin(bits).count("1"), edges)]
        self.add_points(ends, values)
        kept = [(self.corners[~crossed], self.label[~crossed])]
        for piece, of in pieces:
            whole = np.all(np.diff(np.sort(piece, axis=1), axis=1) > 0, axis=1)  # none that ends at a point of value 0
            kept.append((piece[whole], of[whole]))
        self.corners, self.label = (np.concatenate(arrays) for arrays in zip(*kept))
        return np.concatenate([values, np.zeros(len(ends))]), ends

    def add_points(self, ends, values):
        share = values[ends[:, 0]] / (values[ends[:, 0]] - values[ends[:, 1]])
        self.points = np.concatenate([self.points, between(self.points, ends, share)])
        self.fields = {name: np.concatenate([field, between(field, ends, share)]) for name, field in self.fields.items()}

    def side(self, values):
        """Which tetrahedra lie where `values` are positive; none has both signs after a cut."""
        there = values[self.corners]
        return there.max(axis=1) > -there.min(axis=1)

    def triangles(self):
        """All triangles of tetrahedra that lie between two labels or at the end: corners (k, 3) anticlockwise
        from outside the first, the label, and that on the other side, or -1. Each stands there for either
        side."""
        faces = self.corners[:, FACES].reshape(-1, 3)
        label = np.repeat(self.label, 4)
        other = np.full(len(faces), -1)
        first, second = shared(faces)
        other[first], other[second] = label[second], label[first]
        shown = label != other
        return faces[shown], label[shown], other[shown]


def shared(faces):
    """Places in an array of triangles (n, 3) of the two that have the same corners, for each such pair."""
    ordered = np.sort(faces, axis=1).astype(np.int64)
    count = ordered.max(initial=0) + 1
    if count > 2_000_000:
        _, keys = np.unique(ordered, axis=0, return_inverse=True)
    else:
        keys = (ordered[:, 0] * count + ordered[:, 1]) * count + ordered[:, 2]
    order = np.argsort(keys, kind="stable")
    same = np.flatnonzero(keys[order][1:] == keys[order][:-1])
    return order[same], order[same + 1]


class EdgePoints:
    """Numbers of the new points on edges between two points of different sign."""

    def __init__(self, count, values):
        self.count, self.zero, self.pairs = count, values == 0, []

    def add(self, four, inside):
        for a, b in itertools.product(range(inside), range(inside, 4)):
            pair = np.sort(four[:, [a, b]], axis=1)
            self.pairs.append(pair[~self.zero[four[:, b]]])

    def number(self):
        """The ends of each new point's edge, once all edges are added."""
        pairs = np.concatenate(self.pairs) if self.pairs else np.empty((0, 2), int)
        self.keys, places = np.unique(pairs[:, 0].astype(np.int64) * self.count + pairs[:, 1], return_index=True)
        return pairs[places]

    def __call__(self, a, b):
        """The point between `a`, which is negative, and `b`; `b` itself where its value is 0."""
        found = np.searchsorted(self.keys, np.minimum(a, b).astype(np.int64) * self.count + np.maximum(a, b))
        return np.where(self.zero[b], b, self.count + found)


def split(four, inside, edges):
    """Tetrahedra of either side, from corners of which the first `inside` are negative."""
    a, b, c, d = four.T
    if inside == 1:
        p, q, r = edges(a, b), edges(a, c), edges(a, d)
        return [(np.stack([a, p, q, r], axis=1)), *prism(p, q, r, b, c, d)]
    if inside == 3:
        p, q, r = edges(a, d), edges(b, d), edges(c, d)
        return [(np.stack([p, q, r, d], axis=1)), *prism(a, b, c, p, q, r)]
    ac, ad, bc, bd = edges(a, c), edges(a, d), edges(b, c), edges(b, d)
    return [*prism(a, ac, ad, b, bc, bd), *prism(c, ac, bc, d, ad, bd)]


def prism(*six):
    """Three tetrahedra of a prism. Each of its quadrilaterals is divided from its smallest number on, as its
    neighbour does [Dompierre and others 1999]."""
    corners = np.stack(six, axis=1)
    a, b, c, d, e, f = np.take_along_axis(corners, TURNS[np.argmin(corners, axis=1)], axis=1).T
    first = (np.minimum(b, f) < np.minimum(c, e))[:, None]
    return [np.where(first, np.stack([a, b, c, f], axis=1), np.stack([a, b, c, e], axis=1)),
            np.where(first, np.stack([a, b, f, e], axis=1), np.stack([a, e, c, f], axis=1)),
            np.stack([a, e, f, d], axis=1)]


def between(field, ends, share):
    share = share.reshape(-1, *[1] * (field.ndim - 1))
    return (1.0 - share) * field[ends[:, 0]] + share * field[ends[:, 1]]


def of_grid(axes, filled):
    """Six tetrahedra for each of the filled cells [z][y][x] of a grid of coordinates `axes` (x, y, z).
    Numbers of points are those of the grid, x fastest."""
    x, y, z = axes
    points = np.stack([grid.ravel() for grid in np.meshgrid(z, y, x, indexing="ij")[::-1]], axis=1)
    step = np.array([1, len(x), len(x) * len(y)])
    cells = np.argwhere(filled)[:, ::-1] @ step
    tetrahedra = []
    for order in itertools.permutations(range(3)):
        path = np.concatenate([[0], np.cumsum(step[list(order)])])
        if sum(a > b for a, b in itertools.combinations(order, 2)) % 2:
            path[[1, 2]] = path[[2, 1]]
        tetrahedra.append(cells[:, None] + path)
    return Tetrahedra(points, {}, np.concatenate(tetrahedra))
