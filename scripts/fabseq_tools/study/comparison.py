# SPDX-License-Identifier: MIT
"""Layers of several kinds of one part, each with the figures of its row."""

import dataclasses
import os

import numpy as np

from fabseq_tools.run.command_line import RunError
from fabseq_tools.run.read_run import repair_option
from fabseq_tools.run.progress import Progress
from fabseq_tools.run.verdict_words import rank
from fabseq_tools.study import figures
from fabseq_tools.study.families import Families, heights_of

BINARY = {"projection.binary": True}
UNKNOWN = 0.15  # of the strain along each axis: what `spread` is made of


def strains(dimension):
    """Scenarios of material.scenarios: more and less of the strain along each axis, one after the other."""
    factors = [(axis, sign) for axis in range(dimension) for sign in (1.0, -1.0)]
    return [[1.0 + sign * UNKNOWN if other == axis else 1.0 for other in range(dimension)] for axis, sign in factors]


class Comparison:
    """`rounds`: where runs go. `own`: more settings of a kind of layers, by its name (heat, guided).
    `judging`: settings of the simulation that is judged, such as a torch without the clearance that an
    optimizer keeps for safety. `say`: is told what comes next. `scan`: rows of all tilted planar layers."""

    def __init__(self, rounds, own=None, judging=None, say=print):
        self.rounds, self.say, self.scan = rounds, say, []
        self.target = rounds.target_thickness()
        self.families = Families(rounds.config, self.target, own)
        self.judging = BINARY | (judging or {})
        self.scenarios = {"material.scenarios": strains(self.families.dimension)}

    def rows(self, subparts, step, azimuths, curved=("start", "heat", "guided")):
        """One after the other, as they are done. `curved`: methods of Families, by name."""
        families = self.families
        height = heights_of(self.rounds.run(*families.one_layer().run()))
        yield self.row(families.planar("planar", "planar", families.up, height(families.up)))
        best = self.best_of_scan(step, azimuths, height)
        if best is not None:
            yield best
        lean = families.up if best is None or "direction" not in best else np.array(best["direction"])
        for count in subparts:
            yield self.row(families.multi_planar(count, lean))
        for name in curved:
            yield self.row(getattr(families, name)())

    def best_of_scan(self, step, azimuths, height):
        """Those of the best class come first. None where the limit is less than a step."""
        tried = {}
        with Progress("tilted planar layers") as progress:
            directions = list(self.families.directions(step, azimuths))
            for number, (tilt, direction) in enumerate(progress.steps(directions, "direction")):
                name = f"tilted_{tilt:g}_{number % azimuths}"
                family = self.families.planar(f"tilted planar, {tilt:g} degrees", name, direction, height(direction))
                self.scan.append(self.figures_of(family, self.judging) | {"tilt": tilt, "direction": direction.tolist()})
                tried[name] = family
        done = [row for row in self.scan if "reason" not in row]
        if not done:
            return self.scan[0] if self.scan else None
        best = min(done, key=lambda row: (rank(row["class"]), row["objective"]))
        row = self.row(dataclasses.replace(tried[best["folder"]], name="tilted"))
        return row | {"tilt": best["tilt"], "direction": best["direction"]}

    def row(self, family):
        """Its figures, with the spread."""
        self.say(family.label)
        row = self.figures_of(family, self.judging | self.scenarios)
        if "reason" in row:
            self.say(f"  {row['reason']}")
        return row

    def figures_of(self, family, judging):
        """Of the binary layers of a simulation: after an optimization one more, with scenarios that would
        cost solves in each of its iterations. The reason alone if the program refuses these layers or fails.
        `seconds` are those of the optimization where there is one."""
        row = {"layers": family.label, "folder": family.name}
        try:
            if family.task == "simulate":
                return row | figures.row_of(self.rounds.run(family.name, family.settings | judging, "simulate"), self.target)
            run = self.rounds.run(*family.run())
            design = os.path.join(self.rounds.path(family.name), "result.h5")
            options = ["-design", design, *repair_option(run.summary)]
            judged = self.rounds.run(f"{family.name}_judged", family.settings | judging, "simulate", options)
        except RunError as error:
            return row | {"reason": str(error)}
        return row | figures.row_of(judged, self.target) | {"seconds": run.summary["seconds"]["total"]}
