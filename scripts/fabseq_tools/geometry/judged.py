# SPDX-License-Identifier: MIT
"""What the checks of a run have judged of a sequence: the layer and the local thickness of each element, and
the verdict on all of it."""

import numpy as np
from scipy.spatial import KDTree

from fabseq_tools.geometry.grid import element_centres, element_edges, origin_of
from fabseq_tools.run.verdict_words import verdict_lines, verdict_of

BLOCKS = {"optimized": ("binary", "simulated"), "planar": ("baseline",), "start": ("start",)}  # of summary.json


class Judged:
    """`layer` [z][y][x]: that of each element, 0 outside the part; None in results that do not tell.
    `thickness` [z][y][x]: local thickness as the check has it, NaN where it is not defined or not finite, and
    `slope` [z][y][x][axis]: the build direction over it; None without any. `substrate`: where there is one,
    or None. `block`: of summary.json; `verdict`: its object in there, empty without one."""

    def __init__(self, run, file, group, of):
        self.block = next((run.summary[name] for name in BLOCKS[of] if name in run.summary), {})
        self.verdict = verdict_of(self.block)
        self.layer = file[group + "layer"][()].astype(int) if group + "layer" in file else None
        self.substrate = file["substrate"][()] > 0 if "substrate" in file else None
        self.config, self.edges, self.origin = run.config, np.array(element_edges(run.config)), origin_of(run.config)
        self.trees, self.ranges, self.thickness, self.slope = {}, {}, None, None
        if self.layer is not None and {group + "local_thickness", group + "build_direction"} <= set(names(file)):
            thickness = file[group + "local_thickness"][()].astype(float)
            self.thickness = np.where((self.layer > 0) & np.isfinite(thickness) & (thickness > 0), thickness, np.nan)
            self.slope = np.nan_to_num(file[group + "build_direction"][()] / self.thickness[..., None])

    def words(self):
        """The verdict, and a line for each of the largest places that cannot be built."""
        return "\n".join(verdict_lines(self.block))

    def holds(self, number):
        """Whether any element belongs to the layer; yes where nobody knows."""
        return self.layer is None or bool((self.layer == number).any())

    def tree(self, number):
        """Of the centres of a layer's elements, with their cells."""
        if number not in self.trees:
            cells = np.argwhere(self.layer == number)
            self.trees[number] = KDTree(element_centres(self.config, cells)), tuple(cells.T)
        return self.trees[number]

    def distance(self, number, points):
        """From points to the nearest centre of a layer's elements."""
        return self.tree(number)[0].query(points)[0]

    def range(self, number=None):
        """Of the thickness of a layer, or of all; None where the check has none."""
        if self.thickness is None:
            return None
        if number not in self.ranges:
            own = self.thickness[self.layer > 0 if number is None else self.layer == number]
            self.ranges[number] = (float(np.nanmin(own)), float(np.nanmax(own))) if np.isfinite(own).any() else None
        return self.ranges[number]

    def slopes(self, points, times):
        """Gradient of the pseudo-time at points: linear between the elements' centres, as far as these belong
        to the part. `times`: of all layers, from 1."""
        place = (points - self.origin) / self.edges - 0.5
        low = np.floor(place).astype(int)
        total, weights = np.zeros((len(points), 3)), np.zeros(len(points))
        for corner in np.ndindex(2, 2, 2):
            cells = low + corner
            weight = np.prod(np.where(corner, place - low, 1.0 - (place - low)), axis=1)
            weight[((cells < 0) | (cells >= self.layer.shape[::-1])).any(axis=1)] = 0.0
            cells = tuple(np.clip(cells, 0, np.array(self.layer.shape[::-1]) - 1).T[::-1])
            layer = self.layer[cells]
            weight[layer == 0] = 0.0
            total += (weight * times[layer])[:, None] * self.slope[cells]
            weights += weight
        return total / np.maximum(weights, 1e-300)[:, None]


def names(file):
    """Of all datasets."""
    found = []
    file.visit(found.append)
    return found
