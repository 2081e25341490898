# SPDX-License-Identifier: MIT
"""The fifth step of a plan: the chosen layers with all elements, beside planar ones and the best
alternative."""

import dataclasses

import numpy as np

from fabseq_tools.plan.configs import full_config
from fabseq_tools.plan.layers import length, rounds_of
from fabseq_tools.plan.watched import Watched
from fabseq_tools.run.command_line import RunError
from fabseq_tools.run.read_run import Run, read_json
from fabseq_tools.run.verdict_words import answer
from fabseq_tools.run.words import duration, less, quantity
from fabseq_tools.study.comparison import Comparison
from fabseq_tools.study.families import heights_of

RUNS = "runs"       # folder of a plan
NEVER = 1e30        # °C at which the strain vanishes: it stays as it is, whatever the heat
CURVED = "baseline_even", "start"  # blocks of summary.json of the design that guided layers begin with


def build(steps, placed, chosen):
    """Rows of what was chosen, of planar layers and of the best alternative: figures of their layers with
    hours and mass, and the folders of their runs."""
    arguments = steps.arguments
    path = steps.path(f"{arguments.name}.json")
    made = full_config(arguments, path, placed["scale"], placed["rotate"], **{"fill-holes": placed["fill_holes"]})
    with Watched(steps.path(RUNS)) as progress:
        rows = Rows(Comparison(rounds_of(arguments, path, steps.path(RUNS)), judging=heat_of(steps, placed), say=progress.say))
        built = rows.chosen(chosen["chosen"], chosen["rows"])
        if "reason" in built:
            raise RunError(f"{built['layers']}: {built['reason']}")
        planar, other = rows.planar(), rows.alternative(built, chosen["simplest"], chosen["rows"])
    line = f"{built['layers']}, {made.found.elements:,} elements: {quantity(length(built), 'mm')}, {built['verdict']}"
    other = None if other and other["folder"] in (planar["folder"], built["folder"]) else other
    rival = other or planar
    if rival["folder"] != built["folder"] and "reason" not in rival:
        line += f"; {less(length(rival) / length(built))} in {rival['layers']} ({rival['verdict']})"
    line += f"; optimized in {duration(built['seconds'])}" * chosen["optimized"]
    return {"line": line, "warnings": made.warnings, "config": path,
            "built": built, "planar": planar, "other": other}


def heat_of(steps, placed):
    """Settings with which a simulation tells pauses and no length changes; empty without what they need."""
    if not placed["density"] or "deposition_rate" not in steps.machine.get("process", {}):
        return {}
    return {"thermal": {"heat_input": steps.arguments.heat_input, "film_coefficient": steps.arguments.film, "vanishing": NEVER}}


class Rows:
    """The rows of one Comparison."""

    def __init__(self, comparison):
        self.comparison, self.families = comparison, comparison.families
        self.height = heights_of(comparison.rounds.run(*self.families.one_layer().run()))

    def chosen(self, row, rows):
        """The layers of one of the fourth step's rows."""
        if row["folder"] == "planar":
            return self.planar()
        if "direction" in row:
            return self.tilted(row["layers"], row["direction"])
        name, count = row["folder"].rpartition("_")[::2]
        lean = next((np.array(other["direction"]) for other in rows if "direction" in other), self.families.up)
        return self.row(self.families.multi_planar(int(count), lean) if name else self.families.guided())

    def planar(self):
        up = self.families.up
        return self.row(self.families.planar("planar", "planar", up, self.height(up)))

    def tilted(self, label, direction):
        return self.row(self.families.planar(label, "tilted", direction, self.height(direction)))

    def alternative(self, built, simplest, rows):
        """What the run of optimized layers has found best beside them, or else the best of the fourth step
        that nobody has to optimize."""
        best = answer(Run(built["run"], with_fields=False, simulations=True)).get("best_alternative") or {}
        block = best.get("block")
        if block == "baseline_tilted":
            return self.tilted(best["title"], read_json(built["run"], "summary.json")[block]["direction"])
        if block in CURVED:
            return self.row(dataclasses.replace(self.families.guided(), label=best["title"], name="even", task="simulate"))
        return self.chosen(simplest, rows)

    def row(self, family):
        """With hours, mass, and the folders: `run` of the optimization, `judged` of the simulation of its
        layers, which are one where nothing was optimized."""
        comparison = self.comparison
        row = comparison.row(family)
        if "reason" in row:
            return row
        judged = family.name if family.task == "simulate" else f"{family.name}_judged"
        row |= {"run": comparison.rounds.path(family.name), "judged": comparison.rounds.path(judged)}
        return row | totals_of(row["judged"])


def totals_of(directory):
    """Hours and mass of a simulation, and the largest deviation of its skin."""
    summary = read_json(directory, "summary.json")
    heat, finished = summary.get("interpass", {}), summary.get("finished", {})
    skin = (finished.get("released") or finished.get("as_built") or {}).get("skin", {})
    hours = heat.get("build_hours") or summary.get("build_hours")
    return {"largest": skin.get("max"), "hours": hours, "mass": summary.get("wire_mass")}
