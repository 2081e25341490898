#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Holds fabseq's predictions against a simulation of the process with heat, plastic flow and time.

    figures/with_heat.py [CASE...] [--output output/with_heat] [--table] [--picture FILE]

CASES names the parts; without a name all are run. Each part is built three times: in planar layers, in
tilted layers or the start design's, and in layers optimized for the linear model, all binary. CalculiX
(calculix-ccx, ccx 2.20) first finds the temperatures, then the displacement of elastic, plastic steel that
shrinks from the solidus, and of its release, with two types of brick. Sequences in REFINED_RUNS are simulated
once more on elements of half the size, heat as well as displacement. fabseq simulates the same layers

- with plastic flow (process.model elastoplastic), the steel's curves and no factor; with two values of
  cut_off, and on elements of half the size, there also with heat properties that are constants,
- with its linear model and heat properties that are constants, a strain that is constant or follows the
  temperature, and one factor for it.

A third linear model adds the cooling of what is built (heat_and_plasticity/own_cooling.py). Each factor is
fitted to the planar case, for each type of brick. Displacements are compared after the release, without rigid
motions, at the nodes of the part.

Leaves CASE.json with all figures and OUTPUT/CASE.npz with the fields, and prints tables. What is there is not
run again. Takes some minutes per sequence on one core, and a quarter of an hour and more per refined brick.
--table runs nothing.
"""

import json
import os

import needs_packages  # noqa: F401 (before any package)
from fabseq_tools.run.command_line import RunError, parse, parser_of, run_command, run_script, write_json
from fabseq_tools.run.places import PROGRAM, ROOT

import numpy as np

from fabseq_tools.geometry.rigid_motions import without_rigid_motion
from fabseq_tools.run.read_run import read_fields, read_json
from heat_and_plasticity import own_cooling, steel
from heat_and_plasticity.bricks import Bricks
from heat_and_plasticity.compared import BRICKS, FINE, FINE_CONSTANTS, FINE_HOTTER, FLOW, HOTTER, LINEAR, REFINED, compared
from heat_and_plasticity.finer import at_coarse_nodes, finer_settings
from heat_and_plasticity.heat import Schedule, temperatures
from heat_and_plasticity.mechanics import displacements
from heat_and_plasticity.picture import draw
from heat_and_plasticity.tables import print_tables

FOLDER = os.path.join(ROOT, "benchmarks", "evidence", "studies", "with_heat")
THREE = ("planar", "tilted", "optimized")
# Each with its file in FOLDER, its sequences and its settings. The wall is cold after longer pauses.
CASES = {"arm": ("arm", ("planar", "start", "optimized"), {}),
         "wall": ("wall", THREE, {}),
         "cold_wall": ("wall", THREE, {"process.dwell": 45}),
         "cross": ("cross", THREE, {}),
         "tee": ("tee", THREE, {})}
# What CalculiX simulates on refined elements, too.
REFINED_RUNS = {case: dict.fromkeys(sequences, BRICKS[:1])
                for case, sequences in (("arm", CASES["arm"][1]), ("wall", THREE), ("cross", THREE))}
REFINED_RUNS["wall"]["planar"] = BRICKS
# Of linear models, and of the sequence that is optimized with one.
CONSTANT = {"thermal.conductivity": 0.0407, "thermal.heat_capacity": 606}
UPRIGHT, TILTED = [0, 0, 1], [0.2588, 0, 0.9659]   # the second leans by 15 degrees


def flow_settings(*cut_off):
    material = {f"material.{key}": value for key, value in steel.flow_material(*cut_off).items()}
    return {"process.model": "elastoplastic", **dict.fromkeys(CONSTANT, "material"), **material}


# Settings of fabseq's models; own cooling is none of fabseq.
RUNS = {"thermal": {}, "constant": {"thermal.vanishing": 1e30}, FLOW: flow_settings(), HOTTER: flow_settings(1200.0)}
FINER_RUNS = {FINE: RUNS[FLOW], FINE_HOTTER: RUNS[HOTTER], FINE_CONSTANTS: RUNS[FLOW] | CONSTANT}


def main():
    parser = parser_of(__doc__)
    parser.add_argument("names", nargs="*", metavar="CASE")
    parser.add_argument("--output", default=os.path.join("output", "with_heat"))
    parser.add_argument("--table", action="store_true", help="only of what is there")
    parser.add_argument("--coarse", action="store_true", help="without CalculiX on refined elements")
    parser.add_argument("--program", default=os.environ.get("FABSEQ_PROGRAM", PROGRAM))
    parser.add_argument("--picture", metavar="FILE", help="also draw the displacements")
    arguments = parse(parser)
    unknown = [name for name in arguments.names if name not in CASES]
    if unknown:
        raise RunError(f"no case {unknown[0]}; cases: {', '.join(CASES)}")
    found = {}
    for case in arguments.names or CASES:
        path = os.path.join(arguments.output, case + ".json")
        if not arguments.table:
            write_json(path, Study(arguments, case, {} if arguments.coarse else REFINED_RUNS.get(case, {})).figures())
        found[case] = read_json(arguments.output, case + ".json")
    print_tables(found)
    if arguments.picture:
        draw(found, arguments.picture)


class Study:
    """One part, built in its sequences. `refined_runs`: types of brick by sequence, as in REFINED_RUNS."""

    def __init__(self, arguments, case, refined_runs=()):
        name, self.sequences, settings = CASES[case]
        self.settings = {**CONSTANT, **settings}
        self.refined_runs = dict(refined_runs)
        self.arguments, self.config = arguments, os.path.join(FOLDER, name + ".json")
        self.output = os.path.join(arguments.output, case)

    def words_of(self, sequence):
        """Options of a simulation with that sequence."""
        plain = set_words({"constraints": []})
        if sequence == "start":
            return plain
        if sequence == "optimized":
            return [*plain, "-design", os.path.join(self.run("optimize", "optimize"), "result.h5")]
        thickness, direction = 4.0, np.array(TILTED if sequence == "tilted" else UPRIGHT)
        direction = direction / np.linalg.norm(direction)
        length = np.ptp(self.part_points() @ direction)
        planar = {"sequence": {"type": "planar", "direction": direction.tolist()}, "projection.max": "auto"}
        return [*plain, *set_words(planar), "-layers", round(float(length / thickness))]

    def part_points(self):
        bricks = Bricks(self.run("optimize", "optimize"))
        return bricks.positions[bricks.part_nodes()]

    def run(self, name, task, *words):
        """The directory of a run of the program, made if it is not there."""
        directory = os.path.join(self.output, name)
        if not os.path.exists(os.path.join(directory, "summary.json")):
            run_command([self.arguments.program, "-config", self.config, "-task", task, *set_words(self.settings), *words,
                         "-overwrite", "-output", directory])
        return directory

    def predicted(self, sequence, model):
        words = ["-binary", *self.words_of(sequence), *set_words(RUNS[model])]
        return self.run(f"{sequence}_{model.replace(' ', '_')}", "simulate", *words)

    def finer(self, sequence, bricks, name):
        """A model with plastic flow, the same layers, elements of half the size."""
        settings = finer_settings(bricks, os.path.join(self.output, f"{sequence}_layers.h5"))
        distortion = bricks.config["objective"][:1]  # a file says no gradient of the times, for their uniformity
        words = set_words({"constraints": [], "objective": distortion, **FINER_RUNS[name], **settings})
        return self.run(f"{sequence}_{name.replace(' ', '_')}", "simulate", "-binary", *words)

    def refined(self, sequence, finer):
        """Types of brick and displacements by CalculiX on the finer run's elements, with their own heat."""
        kinds = self.refined_runs.get(sequence, ())
        if kinds:
            bricks = Bricks(finer)
            schedule, folder = Schedule(bricks), os.path.join(self.output, f"{sequence}_ccx_fine")
            heat = temperatures(bricks, schedule, folder)
            for kind in kinds:
                yield kind, displacements(bricks, heat, schedule.ambient, folder, kind)[1]

    def figures(self):
        fields, found = {}, {}
        for sequence in self.sequences:
            fields[sequence], found[sequence] = self.one(sequence)
        for sequence, values in compared(fields).items():
            found[sequence] |= values
        np.savez(self.output + ".npz", **{f"{s}/{name}": values for s in fields for name, values in fields[s].items()})
        return found

    def one(self, sequence):
        """Fields at the part's nodes, and figures, of one sequence."""
        directories = {model: self.predicted(sequence, model) for model in RUNS}
        bricks = Bricks(directories["thermal"])
        schedule, folder = Schedule(bricks), os.path.join(self.output, f"{sequence}_ccx")
        heat = temperatures(bricks, schedule, folder)
        nodes, points = bricks.part_nodes(), bricks.positions[bricks.part_nodes()]
        moved = {kind: displacements(bricks, heat, schedule.ambient, folder, kind)[1] for kind in BRICKS}
        for model, directory in directories.items():
            moved[model] = moved_of(directory)
        finer = {name: self.finer(sequence, bricks, name) for name in FINER_RUNS}
        for name, directory in finer.items():
            moved[name] = at_coarse_nodes(moved_of(directory), bricks.grid.shape)
        for kind, values in self.refined(sequence, finer[FINE]):
            moved[REFINED[kind]] = at_coarse_nodes(values, bricks.grid.shape)
        moved[LINEAR[-1]] = own_cooling.displacements(bricks, heat, schedule.ambient)
        fields = {name: without_rigid_motion(values[nodes], points) for name, values in moved.items()}
        layers = read_json(directories[FLOW], "summary.json")["layers"]
        found = {"ccx": interpass(bricks, heat), "fabseq": [layer["interpass_temperature"] for layer in layers[1:]]}
        return {"points": points, **fields}, {"elements": len(bricks.layer), "layers": bricks.layers, "interpass": found}


def set_words(settings):
    return [word for key, value in settings.items() for word in ("-set", f"{key}={json.dumps(value)}")]


def moved_of(directory):
    """Displacement of a run's nodes after the release."""
    result = read_fields(os.path.join(directory, "result.h5"))
    return (result["displacement"] + result["release_displacement"]).reshape(-1, 3).astype(float)


def interpass(bricks, heat):
    """Mean temperature of each layer but the last as its pause ends."""
    return [float(heat[layer - 1, -1][bricks.corners[bricks.layer == layer]].mean()) for layer in range(1, bricks.layers)]


if __name__ == "__main__":
    run_script(main)
