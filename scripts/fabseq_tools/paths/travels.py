# SPDX-License-Identifier: MIT
"""The ways of the torch with the arc off, over what stands by then.

From the end of a pass it retracts along its axis, to the clearance above the bead, rises along the plate's
normal, goes across, comes down and approaches the next start along its axis. It rises to the clearance above
all that stands no farther than the clearance from the straight way, seen along the plate's normal; between
layers, above all that stands. Where it is that high already, it goes straight."""

import dataclasses

import numpy as np

from fabseq_tools.geometry.grid import element_centres


@dataclasses.dataclass
class Travel:
    """After pass `number` (0: before the first). `leaving` and `coming` (n, 3): points from the end of that
    pass, and to the start of the next; empty after the last and before the first. `depth`: how deep the
    torch's tip runs into what stands; 0 where it does not."""

    number: int
    leaving: np.ndarray
    coming: np.ndarray
    depth: float


class Tops:
    """How high what stands reaches along the plate's normal; `standing`: of ways.py."""

    def __init__(self, standing):
        self.standing, self.up = standing, standing.up
        places = element_centres(standing.part.config, np.stack(standing.cells, axis=1))
        done = standing.done[standing.cells]
        substrate = standing.part.judged.substrate
        if substrate is not None:
            base = element_centres(standing.part.config, np.argwhere(substrate))
            places, done = np.concatenate([base, places]), np.concatenate([np.zeros(len(base), int), done])
        self.places, self.done = places, done
        self.half_edges = 0.5 * np.abs(standing.edges)

    def between(self, number, start, end, reach):
        """Of what stands after a pass near the straight way, within `reach` of it across the normal."""
        along = end - start
        along = along - (along @ self.up) * self.up
        away = self.places[self.done <= number] - start
        heights = away @ self.up
        away = away - heights[:, None] * self.up
        length = along @ along
        share = np.clip(away @ along / length, 0.0, 1.0) if length > 0 else np.zeros(len(away))
        near = np.linalg.norm(away - share[:, None] * along, axis=1) <= reach + self.half_edges.max()
        if not near.any():
            return self.standing.plate
        return float(heights[near].max() + start @ self.up + self.half_edges @ np.abs(self.up))

    def highest(self, number):
        return float(self.standing.top(number))


def travels(standing, passes, clearance, progress):
    """One before the first pass, between any two and after the last."""
    tops, up = Tops(standing), standing.up
    result = []
    for number in progress.steps(range(len(passes) + 1), "way after pass"):
        before, after = passes[number - 1] if number else None, passes[number] if number < len(passes) else None
        leaving = None if before is None else retracted(before, -1, clearance)
        coming = None if after is None else retracted(after, 0, clearance)
        if before is None or after is None or before.layer != after.layer:
            level = tops.highest(number) + clearance
        else:
            level = tops.between(number, leaving, coming, clearance) + clearance
        ways = [np.empty((0, 3)) if end is None else risen(end, level, up) for end in (leaving, coming)]
        whole = np.concatenate([ways[0], ways[1][::-1]])
        depth = standing.depth(number, whole)[0] if len(whole) > 1 else 0.0
        result.append(Travel(number, ways[0], ways[1][::-1], depth))
    return result


def retracted(one, end, clearance):
    """From an end of a pass along the axis, to the clearance above the bead."""
    above = clearance + max(1.0 - one.levels[end], 0.0) * one.heights[end]
    return one.points[end] + above * one.axes[end]


def risen(point, level, up):
    """The point, and the one above it at a level, where that is higher."""
    rise = level - point @ up
    return np.array([point, point + rise * up] if rise > 1e-9 else [point])
