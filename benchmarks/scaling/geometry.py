# SPDX-License-Identifier: MIT
"""Multigrid levels as the program makes them (LaneHierarchy), and what is sent between ranks on them: from a part's voxels, exactly, or
from the box and the share of it that is filled."""

import math
from dataclasses import dataclass

import numpy as np

# LaneHierarchy.
COARSEST_ELEMENTS = 600
AGGLOMERATION_LIMIT = 400


@dataclass
class Level:
    """Elements and nodes are those in the model; `own` means those of one rank, the one that has most."""
    box: tuple
    elements: float
    nodes: float
    distributed: bool
    own_elements: float
    own_nodes: float
    halo_messages: int = 0      # of all ranks in a sum over shared nodes
    halo_nodes: float = 0.0     # that these messages carry
    own_neighbors: int = 0
    own_halo_nodes: float = 0.0


def sides(grid):
    """Sides of a rank in the middle, along each axis, that it shares."""
    return [min(p - 1, 2) for p in grid]


def holders(part, ranks):
    """For every node of a box the ranks that have an element at it, sorted, -1 for none: [node][8]."""
    padded = np.pad(np.where(part, ranks, -1), 1, constant_values=-1)
    x, y, z = (n + 1 for n in part.shape)
    around = np.stack([padded[i:i + x, j:j + y, k:k + z].ravel() for i in (0, 1) for j in (0, 1) for k in (0, 1)], axis=1)
    around.sort(axis=1)
    around[:, 1:][around[:, 1:] == around[:, :-1]] = -1
    return around


def level_of_voxels(part, ranks, distributed):
    """`part`: bool [x][y][z]; `ranks`: the rank of each element."""
    elements, around = int(part.sum()), holders(part, ranks if distributed else np.zeros_like(ranks))
    count = (around >= 0).sum(axis=1)
    nodes = int((count > 0).sum())
    level = Level(part.shape, elements, nodes, distributed, elements, nodes)
    if not distributed:
        return level
    level.halo_nodes = int((count * (count - 1)).sum())
    level.own_elements = int(np.bincount(ranks[part]).max())
    level.own_nodes = int(np.bincount(around[around >= 0]).max())
    shared = around[count > 1]
    pairs = np.concatenate([shared[:, [i, j]] for i in range(8) for j in range(8) if i != j] or [np.empty((0, 2), int)])
    pairs = pairs[(pairs >= 0).all(axis=1)]
    if len(pairs) == 0:
        return level
    level.own_halo_nodes = int(np.bincount(pairs[:, 0]).max())
    distinct = np.unique(pairs, axis=0)
    level.halo_messages = len(distinct)
    level.own_neighbors = int(np.bincount(distinct[:, 0]).max())
    return level


def level_of_fill(box, elements, fill, grid, distributed):
    """A part that fills the box evenly, or in which each rank has a compact share."""
    full = fill == 1.0
    nodes = math.prod(n + 1 for n in box) if full else (elements**(1.0 / 3.0) + 1.0)**3
    ranks = math.prod(grid) if distributed else 1
    edge = [n / p for n, p in zip(box, grid)] if full else [(elements / ranks)**(1.0 / 3.0)] * 3
    own_nodes = math.prod(n + 1 for n in edge) if distributed else nodes
    level = Level(tuple(box), elements, nodes, distributed, elements / ranks, own_nodes)
    if not distributed:
        return level
    # A node with h holders is sent h (h - 1) times; h is a product over the axes.
    pairs = math.prod(n + 1 + 3 * (p - 1) for n, p in zip(box, grid)) - math.prod(n + 1 + (p - 1) for n, p in zip(box, grid))
    level.halo_nodes = pairs * (1.0 if full else fill)
    level.halo_messages = math.prod(3 * p - 2 for p in grid) - math.prod(grid)
    level.own_neighbors = math.prod(1 + s for s in sides(grid)) - 1
    level.own_halo_nodes = math.prod(n + 1 + s for n, s in zip(edge, sides(grid))) - own_nodes
    return level


def spread(level, ranks):
    """A level held by only so many ranks that each has enough to do; the others wait. Not what the program does."""
    share = max(1.0, min(ranks, level.elements / AGGLOMERATION_LIMIT))
    level.own_elements, level.own_nodes = level.elements / share, level.nodes / share
    if share > 1:
        edge = level.own_elements**(1.0 / 3.0)
        level.distributed, level.own_neighbors, level.own_halo_nodes = True, 26, (edge + 3)**3 - (edge + 1)**3
    return level


class Hierarchy:
    """Levels of a system, and what PETSc's grid exchanges (the whole box, void or not). `part`: voxels, or the share that is filled.
    `staged`: coarse levels on ever fewer ranks instead of whole on all of them, which the program does not do."""

    def __init__(self, elements, part, decomposition, components, staged=False):
        self.box, self.components, self.decomposition, self.grid = tuple(elements), components, decomposition, decomposition.grid
        self.ranks = math.prod(self.grid)
        self.voxels = None if np.isscalar(part) else part
        self.fill = part if self.voxels is None else part.mean()
        self.levels = [self.make_level(list(elements), self.fill * math.prod(elements), 1, self.ranks > 1)]
        factor = 1
        while True:
            fine = self.levels[-1]
            if fine.elements <= COARSEST_ELEMENTS or max(fine.box) == 1:
                if fine.distributed:
                    self.levels.append(self.make_level(fine.box, fine.elements, factor, False))
                return
            factor *= 2
            box = [-(-n // 2) for n in fine.box]
            coarse = self.make_level(box, math.prod(box) if self.fill == 1.0 else fine.elements / 8.0, factor, False)
            if fine.distributed and coarse.elements >= AGGLOMERATION_LIMIT * self.ranks and self.begins_on(factor):
                coarse = self.make_level(box, coarse.elements, factor, True)
            elif staged and self.ranks > 1:
                coarse = spread(coarse, self.ranks)
            self.levels.append(coarse)

    def begins_on(self, factor):
        """Ranges of a part that is only known by its fill start at multiples of 4, no better, as those of real parts do."""
        if self.voxels is None and self.fill < 1.0 and factor > 4:
            return False
        return self.decomposition.begins_on(factor)

    def make_level(self, box, elements, factor, distributed):
        if self.voxels is None:
            return level_of_fill(box, elements, self.fill, self.grid, distributed)
        pad = [(0, n * factor - size) for n, size in zip(box, self.box)]
        part = np.pad(self.voxels, pad).reshape(box[0], factor, box[1], factor, box[2], factor).any(axis=(1, 3, 5))
        return level_of_voxels(part, self.decomposition.rank_of([np.arange(n) * factor for n in box]), distributed)

    def exchange_messages(self):
        return math.prod(3 * p - 2 for p in self.grid) - self.ranks

    def exchange_nodes(self):
        """Of all ranks, to the ghosted boxes or back."""
        return math.prod(n + 1 + 2 * (p - 1) for n, p in zip(self.box, self.grid)) - math.prod(n + 1 for n in self.box)

    def own_exchange_nodes(self):
        own = [n / p for n, p in zip(self.box, self.grid)]
        return math.prod(n + s for n, s in zip(own, sides(self.grid))) - math.prod(own)

    def own_box_nodes(self):
        return math.prod(n + 1 for n in self.box) / self.ranks

    def rows(self):
        return self.levels[-1].nodes * self.components

    def bandwidth(self):
        """Of the last level's matrix, along its shortest axis first."""
        short = sorted(self.levels[-1].box)[:2]
        section = math.prod(n + 1 for n in short) * \
            min(1.0, self.levels[-1].elements / math.prod(self.levels[-1].box))**(2.0 / 3.0)
        return self.components * (section + math.sqrt(section) + 2)
