# SPDX-License-Identifier: MIT
"""Whether measured points are in the unit and the axes of the part."""

import itertools

import numpy as np

from fabseq_tools.geometry.placement import millimetres_of, name_of_unit
from fabseq_tools.run.command_line import RunError

RATIOS = (1e3, 1e-3, 25.4, 1 / 25.4, 10.0, 0.1, 1e2, 1e-2, 1e6, 1e-6, 1e3 / 25.4, 25.4e-3, 304.8, 1 / 304.8)  # of usual units
SMALL = 1 / 8          # of the part's extent: points that reach less far are looked at
ALIKE = 0.3, 1.5       # of the part's extent: how far points in the right unit reach
CLEAR = 20.0           # ratio of units from which on chance explains nothing
SAME_BOX = 0.1         # of the part's extent: how far the boxes of points and part may differ, for smaller ratios
MOST_MISSES = 0.05     # share of points beyond the tolerance, where they fit
MANY_MISSES = 0.1      # where they do not
LEAST_POINTS = 8       # that tell axes
MOST_LOOKED_AT = 300   # points


def turned_axes(dimension):
    """(name, matrix) of all other ways in which axes can be named, the right-handed ones first. For the
    points `points @ matrix`; the name says which axes of the file are x, y, z of the part."""
    ways = []
    for order in itertools.permutations(range(dimension)):
        for signs in itertools.product((1.0, -1.0), repeat=dimension):
            matrix = np.zeros((dimension, dimension))
            matrix[list(order), range(dimension)] = signs
            name = ", ".join("-" * (sign < 0) + "xyz"[axis] for axis, sign in zip(order, signs))
            ways.append((name, matrix))
    return sorted(ways[1:], key=lambda way: np.linalg.det(way[1]) < 0)


class PointsFrame:
    """Points (n, axis) against a part. `box`: its lower and upper corner; `distances`: a function of points
    that returns how far they are from it; `tolerance`: of these; `unit`: the config's, in which `box` is."""

    def __init__(self, points, box, distances, tolerance, unit):
        chosen = np.random.default_rng(1).permutation(len(points))[:MOST_LOOKED_AT]
        self.points, self.box, self.distances, self.tolerance, self.unit = points, box, distances, tolerance, unit
        self.sample, self.extent = points[chosen], np.linalg.norm(box[1] - box[0])
        self.span = np.linalg.norm(np.ptp(points, axis=0)) / self.extent

    def misses(self, points):
        """Share of some points beyond the tolerance."""
        return float(np.mean(self.distances(points) > self.tolerance))

    def refuse_others(self, path, has_units):
        """Raises a RunError where another unit or other axes than the part's explain the points; `has_units`:
        their unit is known."""
        if len(self.points) < 3 or (self.span >= SMALL and self.misses(self.sample) <= MANY_MISSES):
            return
        ratios = [] if has_units else [ratio for ratio in RATIOS if ALIKE[0] <= self.span * ratio <= ALIKE[1]]
        axes = turned_axes(self.points.shape[1]) if len(self.points) >= LEAST_POINTS else []
        for ratio in ratios:
            if self.fits(ratio, None):
                raise RunError(f"{path}: {self.words_of_unit(ratio)}")
        if self.span >= SMALL:
            for name, matrix in axes:
                if self.fits(1.0, matrix):
                    raise RunError(f"{path}: found points off the part that would lie on it with their axes {name} as its "
                                   f"{self.axes_of_part()}{self.words_of_up(matrix)}; allowed: the part's axes")
        for ratio, (name, matrix) in itertools.product(ratios, axes):
            if self.fits(ratio, matrix):
                raise RunError(f"{path}: {self.words_of_unit(ratio)}; besides, their axes {name} seem to be its "
                               f"{self.axes_of_part()}{self.words_of_up(matrix)}")

    def fits(self, ratio, matrix):
        points = ratio * (self.sample if matrix is None else self.sample @ matrix)
        if 1 / CLEAR < ratio < CLEAR or matrix is not None:
            whole = ratio * (self.points if matrix is None else self.points @ matrix)
            if np.abs(np.stack([whole.min(0), whole.max(0)]) - self.box).max() > max(self.tolerance, SAME_BOX * self.extent):
                return False
        return self.misses(points) <= MOST_MISSES

    def axes_of_part(self):
        return ", ".join("xyz"[:self.points.shape[1]])

    def words_of_unit(self, ratio):
        of_config = millimetres_of(self.unit)
        own = name_of_unit(ratio * of_config) if of_config else None
        unit = f", as if they were in {own}" * (own is not None)
        return (f"found points that reach over {self.span * self.extent:.4g}, the part over {self.extent:.4g}"
                f"{f' {self.unit}' if self.unit else ''}: lengths {ratio:.6g} times theirs would fit{unit}; allowed: the unit "
                f"of the config, or the name of theirs, with --unit{f' {own}' * (own is not None)} or in a table's first line")

    def words_of_up(self, matrix):
        up = np.flatnonzero(matrix[:, -1])[0]
        return f" ({'xyz'[up]} is up)" if up != len(matrix) - 1 else ""
