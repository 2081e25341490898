# SPDX-License-Identifier: MIT
"""Plastic flow while the part is built: a deck of ccx that follows given temperatures.

Layers are taken out at first and added strain free (*MODEL CHANGE), one after the other. ccx counts the
strain of such elements from the displacements and temperatures of their nodes after the first increment of
the step. So material goes to its nominal position. For it to shrink from the solidus, each layer has nodes of
its own that wait at the solidus and are tied by equations to those of the layers below, and nothing else
changes in the step that adds it.

Bricks are C3D8, with 2x2x2 points as fabseq's, or C3D8I, which have further shapes inside and lock less in
bending and in plastic flow.
"""

import numpy as np

from heat_and_plasticity import steel
from heat_and_plasticity.bricks import element_lines, number_lines
from heat_and_plasticity.ccx import run_ccx, tables_of


class OwnNodes:
    """Nodes of layers. `corners` as those of the bricks; `of` (node,): the node of the grid that each is at;
    `layer` (node,): the layer that has it. The first nodes are those of the grid."""

    def __init__(self, bricks):
        self.corners, count = bricks.corners.copy(), len(bricks.positions)
        of, layer = [np.arange(count)], [bricks.home]
        for number in range(1, bricks.layers + 1):
            members = bricks.layer == number
            foreign = np.unique(bricks.corners[members][bricks.home[bricks.corners[members]] < number])
            renamed = np.arange(len(bricks.positions))
            renamed[foreign] = count + np.arange(len(foreign))
            self.corners[members] = renamed[bricks.corners[members]]
            of.append(foreign)
            layer.append(np.full(len(foreign), number))
            count += len(foreign)
        self.of, self.layer = np.concatenate(of), np.concatenate(layer)
        self.there = np.flatnonzero(self.layer >= 0)
        self.tied = np.arange(len(bricks.positions), count)


def deck_lines(bricks, temperatures, ambient, kind):
    own = OwnNodes(bricks)
    yield from model_lines(bricks, own, kind)
    yield f"*INITIAL CONDITIONS, TYPE=TEMPERATURE\nALL, {ambient}"
    yield "*BOUNDARY\nHELD, 1, 3"
    yield "*STEP, INC=1000\n*STATIC, DIRECT\n1., 1.\n*MODEL CHANGE, TYPE=ELEMENT, REMOVE"
    yield from (f"L{layer}" for layer in range(1, bricks.layers + 1))
    yield "*TEMPERATURE"
    yield from (f"{n + 1}, {ambient if own.layer[n] == 0 else steel.SOLIDUS}" for n in own.there)
    yield "*END STEP"
    for layer, fields in enumerate(temperatures, start=1):
        active = own.there[own.layer[own.there] <= layer]
        yield f"*STEP\n*STATIC, DIRECT\n1., 1.\n*MODEL CHANGE, TYPE=ELEMENT, ADD=STRAIN FREE\nL{layer}\n*END STEP"
        for field in fields:
            yield "*STEP, INC=1000\n*STATIC\n0.25, 1., 1e-5, 1."
            yield "*TEMPERATURE"
            yield from (f"{n + 1}, {min(field[own.of[n]], steel.SOLIDUS):.6g}" for n in active)
            yield "*END STEP"
    yield from last_step(["*TEMPERATURE", f"ALL, {ambient}"])
    yield from last_step(["*BOUNDARY, OP=NEW", *three_supports(bricks)])


def model_lines(bricks, own, kind):
    positions = bricks.positions[own.of]
    yield "*NODE, NSET=ALL"
    yield from (f"{n + 1}, {x:.9g}, {y:.9g}, {z:.9g}" for n, (x, y, z) in zip(own.there, positions[own.there]))
    yield from element_lines(own.corners, bricks.layer, bricks.layers, kind)
    yield "*MATERIAL, NAME=STEEL"
    yield from steel.mechanical_lines()
    yield from (f"*SOLID SECTION, ELSET=L{number}, MATERIAL=STEEL" for number in range(bricks.layers + 1))
    yield "*NSET, NSET=HELD"
    yield from number_lines(bricks.supports)
    yield "*NSET, NSET=GRID"
    yield from number_lines(bricks.nodes())
    for node in own.tied:
        for axis in (1, 2, 3):
            yield f"*EQUATION\n2\n{node + 1}, {axis}, 1., {own.of[node] + 1}, {axis}, -1."


def last_step(lines):
    yield "*STEP, INC=1000\n*STATIC\n0.25, 1., 1e-5, 1."
    yield from lines
    yield "*NODE PRINT, NSET=GRID, FREQUENCY=100000\nU\n*END STEP"


def three_supports(bricks):
    """Three of the nodes that were held, on the lowest face, keep the part in its place without a force."""
    held = bricks.supports[np.isclose(bricks.positions[bricks.supports, 2], bricks.positions[:, 2].min())]
    points = bricks.positions[held]
    first = held[np.argmin(points[:, 0] + points[:, 1])]
    along_x = held[np.argmax(points[:, 0] - points[:, 1])]
    along_y = held[np.argmax(points[:, 1] - points[:, 0])]
    yield f"{first + 1}, 1, 3\n{along_x + 1}, 2, 3\n{along_y + 1}, 3, 3"


def displacements(bricks, temperatures, ambient, folder, kind):
    """Of the grid's nodes (node, 3), cold: on the plate, and released. `kind`: the type of brick of ccx."""
    lines = deck_lines(bricks, temperatures, ambient, kind)
    tables = tables_of(run_ccx(folder, f"mechanics_{kind}", lines), len(bricks.positions), 3)
    assert len(tables) == 2, f"{len(tables)} tables of displacements"
    return tables
