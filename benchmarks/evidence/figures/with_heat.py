#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Holds fabseq's predictions against a simulation of the process with heat, plastic flow and time.

    figures/with_heat.py [CASE...] [--output output/with_heat] [--table] [--picture FILE]

Cases are studies/with_heat/CASE.json, default: all. Each is optimized, and built three times: in
planar layers, in tilted layers or those of the start, and in optimized layers, all binary. CalculiX
(calculix-ccx, ccx 2.20) first finds the temperatures, then the displacement of elastic, perfectly plastic
steel that shrinks from the solidus, and of its release. fabseq simulates the same layers with a strain that
is constant and with one that follows the temperature. A third, linear model adds the cooling of what is built
(heat_and_plasticity/own_cooling.py). Each gets one factor for its strain, fitted to the planar case.
Displacements are compared after the release, without rigid motions, at the nodes of the part.

Leaves CASE.json with all figures and OUTPUT/CASE.npz with the fields, and prints tables. What is there is not
run again. Takes some minutes per sequence on one core. --table runs nothing.
"""

import json
import os

import needs_packages  # noqa: F401 (before any package)
from fabseq_tools.run.command_line import parse, parser_of, run_command, run_script, write_json
from fabseq_tools.run.places import PROGRAM, ROOT

import numpy as np

from fabseq_tools.geometry.rigid_motions import without_rigid_motion
from fabseq_tools.run.read_run import read_fields, read_json
from heat_and_plasticity import own_cooling
from heat_and_plasticity.bricks import Bricks
from heat_and_plasticity.heat import Schedule, temperatures
from heat_and_plasticity.mechanics import displacements
from heat_and_plasticity.picture import draw

FOLDER = os.path.join(ROOT, "benchmarks", "evidence", "studies", "with_heat")
RUNS = ("constant", "thermal")        # of fabseq
MODELS = (*RUNS, "own cooling")       # the last is own_cooling.py, with the temperatures of ccx
UPRIGHT, TILTED = [0, 0, 1], [0.2588, 0, 0.9659]   # the second leans by 15 degrees
SECOND = {"wall": "tilted", "arm": "start"}


def main():
    parser = parser_of(__doc__)
    parser.add_argument("names", nargs="*", metavar="CASE")
    parser.add_argument("--output", default=os.path.join("output", "with_heat"))
    parser.add_argument("--table", action="store_true", help="only of what is there")
    parser.add_argument("--program", default=os.environ.get("FABSEQ_PROGRAM", PROGRAM))
    parser.add_argument("--picture", metavar="FILE", help="also draw the displacements")
    arguments = parse(parser)
    drawn = {}
    for case in arguments.names or list(SECOND):
        path = os.path.join(arguments.output, case + ".json")
        if not arguments.table:
            write_json(path, Study(arguments, case).figures())
        drawn[case] = read_json(arguments.output, case + ".json")
        print_tables(case, drawn[case])
    if arguments.picture:
        draw(drawn, arguments.picture)


class Study:
    """One part, built in three sequences."""

    def __init__(self, arguments, case):
        self.arguments, self.case = arguments, case
        self.config = os.path.join(FOLDER, case + ".json")
        self.output = os.path.join(arguments.output, case)

    def words_of(self, sequence):
        """Options of a simulation with that sequence."""
        plain = ["-set", "constraints=[]"]
        if sequence == "start":
            return plain
        if sequence == "optimized":
            return [*plain, "-design", os.path.join(self.run("optimize", "optimize"), "result.h5")]
        thickness, direction = 4.0, np.array(TILTED if sequence == "tilted" else UPRIGHT)
        direction = direction / np.linalg.norm(direction)
        length = np.ptp(self.part_points() @ direction)
        return [*plain, "-set", "sequence=" + json.dumps({"type": "planar", "direction": direction.tolist()}),
                "-layers", round(float(length / thickness)), "-set", "projection.max=auto"]

    def part_points(self):
        bricks = Bricks(self.run("optimize", "optimize"))
        return bricks.positions[bricks.part_nodes()]

    def run(self, name, task, *words):
        """The directory of a run of the program, made if it is not there."""
        directory = os.path.join(self.output, name)
        if not os.path.exists(os.path.join(directory, "summary.json")):
            run_command([self.arguments.program, "-config", self.config, "-task", task, *words, "-overwrite",
                         "-output", directory])
        return directory

    def predicted(self, sequence, model):
        words = ["-binary", *self.words_of(sequence)]
        words += ["-set", "thermal.vanishing=1e30"] if model == "constant" else []
        return self.run(f"{sequence}_{model}", "simulate", *words)

    def figures(self):
        sequences = ("planar", SECOND[self.case], "optimized")
        fields, found = {}, {}
        for sequence in sequences:
            fields[sequence], found[sequence] = self.one(sequence)
        for model in MODELS:
            simulated, unscaled = (fields["planar"][key] for key in ("ccx", model))
            scale = float(np.sum(simulated * unscaled) / np.sum(unscaled**2))
            for sequence in sequences:
                theirs, ours = fields[sequence]["ccx"], scale * fields[sequence][model]
                found[sequence][model] |= {"scale": scale, "rms": rms(ours), "error": rms(ours - theirs) / rms(theirs)}
        np.savez(self.output + ".npz", **{f"{s}/{name}": values for s in sequences for name, values in fields[s].items()})
        return found

    def one(self, sequence):
        """Fields at the part's nodes, and figures, of one sequence."""
        directories = {model: self.predicted(sequence, model) for model in RUNS}
        bricks = Bricks(directories["thermal"])
        schedule, folder = Schedule(bricks), os.path.join(self.output, f"{sequence}_ccx")
        heat = temperatures(bricks, schedule, folder)
        moved = displacements(bricks, heat, schedule.ambient, folder)[1]
        nodes, points = bricks.part_nodes(), bricks.positions[bricks.part_nodes()]
        fields = {"points": points, "ccx": without_rigid_motion(moved[nodes], points)}
        for model, directory in directories.items():
            result = read_fields(os.path.join(directory, "result.h5"))
            sum_of = (result["displacement"] + result["release_displacement"]).reshape(-1, 3).astype(float)
            fields[model] = without_rigid_motion(sum_of[nodes], points)
        fields["own cooling"] = without_rigid_motion(own_cooling.displacements(bricks, heat, schedule.ambient)[nodes], points)
        layers = read_json(directories["thermal"], "summary.json")["layers"]
        found = {"ccx": interpass(bricks, heat), "thermal": [layer["interpass_temperature"] for layer in layers[1:]]}
        return fields, {"elements": len(bricks.layer), "layers": bricks.layers, "interpass": found,
                        "ccx": {"rms": rms(fields["ccx"])}, **{model: {} for model in MODELS}}


def interpass(bricks, heat):
    """Mean temperature of each layer but the last as its pause ends."""
    return [float(heat[layer - 1, -1][bricks.corners[bricks.layer == layer]].mean()) for layer in range(1, bricks.layers)]


def rms(displacement):
    return float(np.sqrt(np.mean(np.sum(displacement**2, axis=1))))


def print_tables(case, found):
    planar = found["planar"]
    scales = ", ".join(f"{planar[model]['scale']:.3g} {model}" for model in MODELS)
    print(f"\n{case}: {planar['elements']} elements; scale of the strain: {scales}\n")
    print("| sequence | layers | highest interpass, °C: ccx | fabseq | rms, mm: ccx | " + " | ".join(MODELS) + " | gain: ccx | "
          + " | ".join(MODELS) + " | error: " + " | ".join(MODELS) + " |\n|" + " --- |" * 15)
    for sequence, row in found.items():
        values = [row[name]["rms"] for name in ("ccx", *MODELS)]
        gains = [planar[name]["rms"] / row[name]["rms"] for name in ("ccx", *MODELS)]
        cells = [sequence, str(row["layers"]), *(f"{max(row['interpass'][name]):.0f}" for name in ("ccx", "thermal")),
                 *(f"{value:.4f}" for value in values), *(f"{gain:.2f}" for gain in gains),
                 *(f"{100 * row[name]['error']:.0f} %" for name in MODELS)]
        print("| " + " | ".join(cells) + " |")


if __name__ == "__main__":
    run_script(main)
