# SPDX-License-Identifier: MIT
"""The elements and layers of a run of fabseq, and which faces and nodes are there when."""

import numpy as np

from fabseq_tools.calculix.deck import BRICK
from fabseq_tools.calculix.layer_model import LayerModel

PER_LINE = 12
# Faces of a brick of ccx, F1 to F6: axis and side of the neighbour.
FACES = ((2, -1), (2, 1), (1, -1), (0, 1), (1, 1), (0, -1))


class Bricks:
    """`corners` (element, 8) in the order of ccx, `layer` (element,), 0 in the substrate; nodes are numbered
    as in result.h5, from 0. `layers`: how many. `home`: the first layer that holds a node, -1 for none."""

    def __init__(self, directory):
        model = LayerModel(directory)
        self.positions, self.config, self.supports = model.positions, model.config, model.supports
        self.grid = np.where(model.solid, model.layer, -1)
        solid = self.grid >= 0
        numbers = np.arange(len(self.positions)).reshape([n + 1 for n in self.grid.shape])
        corners = [numbers[tuple(slice(c, c + n) for c, n in zip(corner, self.grid.shape))][solid]
                   for corner in np.ndindex(2, 2, 2)]
        self.corners, self.layer = np.stack(corners, axis=1)[:, BRICK], self.grid[solid]
        self.places = np.argwhere(solid)[:, ::-1]
        self.layers = int(self.layer.max())
        self.volume = np.prod(np.array(model.size) / np.array(model.counts))
        self.home = np.full(len(self.positions), self.layers + 1)
        for layer in range(self.layers, -1, -1):
            self.home[self.corners[self.layer == layer]] = layer
        self.home[self.home > self.layers] = -1

    def nodes(self):
        return np.flatnonzero(self.home >= 0)

    def part_nodes(self):
        return np.unique(self.corners[self.layer > 0])

    def plate_nodes(self):
        """Nodes at the lowest face of the box."""
        nodes = self.nodes()
        return nodes[np.isclose(self.positions[nodes, 2], self.positions[:, 2].min())]

    def open_faces(self, layer):
        """(element, face from 1) of what is built with `layer`, but for those on the plate."""
        built = np.pad((self.grid >= 0) & (self.grid <= layer), 1)
        for face, (axis, side) in enumerate(FACES, start=1):
            step = np.eye(3, dtype=int)[axis] * side
            beside = self.places + step + 1
            is_open = ~built[beside[:, 2], beside[:, 1], beside[:, 0]] & (self.layer <= layer)
            if (axis, side) == (2, -1):
                is_open &= self.places[:, 2] > 0
            yield from ((element, face) for element in np.flatnonzero(is_open))


def number_lines(numbers):
    """Numbers from 0 as lines of numbers from 1."""
    for start in range(0, len(numbers), PER_LINE):
        yield ", ".join(str(n + 1) for n in numbers[start:start + PER_LINE])


def element_lines(corners, layer, layers, kind="C3D8"):
    """An element set L<number> for each layer."""
    for number in range(layers + 1):
        yield f"*ELEMENT, TYPE={kind}, ELSET=L{number}"
        for element in np.flatnonzero(layer == number):
            yield ", ".join(str(n + 1) for n in (element, *corners[element]))
