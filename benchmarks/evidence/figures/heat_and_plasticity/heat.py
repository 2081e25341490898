# SPDX-License-Identifier: MIT
"""Heat while the part is built: a deck of ccx with one element set per layer, added one after the other."""

import numpy as np

from heat_and_plasticity import steel
from heat_and_plasticity.bricks import element_lines, number_lines
from heat_and_plasticity.ccx import run_ccx, tables_of

PAUSE = (0.1, 0.35, 1.0)   # ends of the parts of a pause whose temperatures the mechanics get
INCREMENTS = 8             # of each step in time, at least


class Schedule:
    """How long each layer takes, in seconds, as fabseq has it (docs/formulation.md 14.1)."""

    def __init__(self, bricks):
        process, thermal = bricks.config["process"], bricks.config["thermal"]
        masses = steel.DENSITY * bricks.volume * np.bincount(bricks.layer)[1:]
        self.welding = masses / (process["deposition_rate"] / 3600.0)
        self.pause = process["dwell"]
        self.source = thermal["heat_input"] * steel.DENSITY  # J/mm3
        self.film, self.ambient, self.plate = thermal["film_coefficient"], thermal["ambient"], thermal["plate"]


def deck_lines(bricks, schedule):
    nodes = bricks.nodes()
    yield "*NODE, NSET=ALL"
    yield from (f"{n + 1}, {x:.9g}, {y:.9g}, {z:.9g}" for n, (x, y, z) in zip(nodes, bricks.positions[nodes]))
    yield from element_lines(bricks.corners, bricks.layer, bricks.layers)
    yield "*MATERIAL, NAME=STEEL"
    yield from steel.thermal_lines()
    yield from (f"*SOLID SECTION, ELSET=L{number}, MATERIAL=STEEL" for number in range(bricks.layers + 1))
    yield "*NSET, NSET=PLATE"
    yield from number_lines(bricks.plate_nodes())
    yield f"*INITIAL CONDITIONS, TYPE=TEMPERATURE\nALL, {schedule.plate}"
    yield f"*BOUNDARY\nPLATE, 11, 11, {schedule.plate}"
    for layer in range(1, bricks.layers + 1):
        welding = schedule.welding[layer - 1]
        yield from step_lines(welding)
        if layer == 1 and bricks.layers > 1:
            yield "*MODEL CHANGE, TYPE=ELEMENT, REMOVE"
            yield from (f"L{later}" for later in range(2, bricks.layers + 1))
        if layer > 1:
            yield f"*MODEL CHANGE, TYPE=ELEMENT, ADD=STRAIN FREE\nL{layer}"
        yield "*FILM, OP=NEW"
        yield from (f"{e + 1}, F{face}, {schedule.ambient}, {schedule.film}" for e, face in bricks.open_faces(layer))
        yield f"*DFLUX, OP=NEW\nL{layer}, BF, {schedule.source / welding:.9g}"
        yield "*END STEP"
        for start, end in zip((0.0, *PAUSE), PAUSE):
            yield from step_lines((end - start) * schedule.pause)
            yield "*DFLUX, OP=NEW\nL0, BF, 0."
            yield "*END STEP"


def step_lines(duration):
    yield "*STEP, INC=100000, AMPLITUDE=STEP\n*HEAT TRANSFER"
    yield f"{duration / INCREMENTS:.9g}, {duration:.9g}, {1e-6 * duration:.3g}, {duration / INCREMENTS:.9g}"
    yield "*NODE PRINT, NSET=ALL, FREQUENCY=100000\nNT"


def temperatures(bricks, schedule, folder):
    """[layer - 1][time][node]: at the end of welding and at the ends of the parts of the pause."""
    tables = tables_of(run_ccx(folder, "heat", deck_lines(bricks, schedule)), len(bricks.positions), 1)
    times = 1 + len(PAUSE)
    assert len(tables) == bricks.layers * times, f"{len(tables)} tables of temperatures"
    return np.array(tables)[:, :, 0].reshape(bricks.layers, times, -1)
