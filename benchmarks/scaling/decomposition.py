# SPDX-License-Identifier: MIT
"""How the program deals a box out to the ranks of a group (grid/decomposition), as far as the counts need it."""

import math
from dataclasses import dataclass

import numpy as np

# Weight of an element outside of the part, which only the heat problem sees.
VOID_WEIGHT = 0.1
TIE = 1.01


def split_evenly(weights, parts):
    """Range starts, and the end, with the smallest largest sum."""
    sums = np.concatenate([[0.0], np.cumsum(weights)])
    count = len(weights)

    def longest_end(start, bound):
        return int(np.searchsorted(sums[start:], sums[start] + bound, side="right")) + start - 1

    def can_be_split(bound):
        start = 0
        for part in range(parts):
            end = min(longest_end(start, bound), count - (parts - 1 - part))
            if end <= start:
                return False
            start = end
        return start == count

    low, high = 0.0, float(sums[-1])
    for _ in range(64):
        if high - low <= 1e-12 * sums[-1]:
            break
        middle = 0.5 * (low + high)
        low, high = (low, middle) if can_be_split(middle) else (middle, high)
    bound = high * (1.0 + 1e-12)
    smallest = [0] * parts + [count]
    for part in range(parts - 1, -1, -1):
        fits = int(np.searchsorted(sums, sums[smallest[part + 1]] - bound, side="left"))
        smallest[part] = min(max(fits, part), smallest[part + 1] - 1)
    starts = [0]
    for part in range(1, parts):
        least = max(smallest[part], starts[-1] + 1)
        most = max(least, min(longest_end(starts[-1], bound), count - (parts - part)))
        ideal = sums[-1] * part / parts
        starts.append(min(range(least, most + 1), key=lambda end: abs(sums[end] - ideal)))
    return [*starts, count]


def split_on_coarse_grids(weights, parts):
    count = len(weights)
    block = 4 if count >= 16 * parts else 2 if count >= 6 * parts else 1
    blocks = np.add.reduceat(weights, range(0, count, block))
    return [min(count, start * block) for start in split_evenly(blocks, parts)]


def fitting_grids(ranks, elements):
    return [(x, y, ranks // (x * y)) for z in range(1, elements[2] + 1) if ranks % z == 0
            for y in range(1, elements[1] + 1) if (ranks // z) % y == 0 for x in [ranks // (y * z)] if x <= elements[0]]


@dataclass
class Decomposition:
    """`grid`: ranks along each axis; `starts`: first elements along each axis, and the end."""
    grid: tuple
    starts: list

    def begins_on(self, factor):
        """Whether every rank's first element is on the grid that many times coarser."""
        return all(start % factor == 0 for axis in self.starts for start in axis[:-1])

    def rank_of(self, indices):
        """Ranks of the elements of a box [x][y][z] whose indices along each axis are given."""
        places = [np.searchsorted(s, i, side="right") - 1 for s, i in zip(self.starts, indices)]
        return places[0][:, None, None] + self.grid[0] * (places[1][None, :, None] + self.grid[1] * places[2][None, None, :])


def choose(ranks, elements, part=None):
    """Of all process grids, among those whose heaviest rank is lightest the one with the least surface; None without any.
    `part`: bool [x][y][z]; without it, all elements weigh the same."""
    weights = None if part is None else np.where(part, 1.0, VOID_WEIGHT)
    marginals = [np.ones(n) if weights is None else weights.sum(
        axis=tuple({0, 1, 2} - {axis})) for axis, n in enumerate(elements)]
    splits, candidates = {}, []
    for grid in fitting_grids(ranks, elements):
        for axis, parts in enumerate(grid):
            if (axis, parts) not in splits:
                splits[axis, parts] = split_on_coarse_grids(marginals[axis], parts)
        starts = [splits[axis, parts] for axis, parts in enumerate(grid)]
        if weights is None:
            heaviest = math.prod(max(b - a for a, b in zip(s, s[1:])) for s in starts)
        else:
            sums = weights
            for axis, s in enumerate(starts):
                sums = np.add.reduceat(sums, s[:-1], axis=axis)
            heaviest = sums.max()
        candidates.append((heaviest, grid, starts))
    if not candidates:
        return None
    limit = TIE * min(heaviest for heaviest, _, _ in candidates)

    def surface(grid):
        return sum((grid[axis] - 1) * math.prod(elements) / elements[axis] for axis in range(3))

    _, grid, starts = min((c for c in candidates if c[0] <= limit), key=lambda c: surface(c[1]))
    return Decomposition(grid, starts)
