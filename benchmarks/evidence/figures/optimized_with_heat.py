#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Optimizes the parts of studies/heat_cases.json with and without the part's temperature, and prints
a table: planar layers, the start, and layers optimized without heat, with it, and within an interpass limit.

    figures/optimized_with_heat.py [CASE...] [--ranks N] [--output output/heat] [--cases FILE.json]
                                           [--table] [-- PROGRAM OPTIONS]

All rows are of binary layers whose strain follows the temperature, with the pause of the row; "without heat"
are layers that were optimized for a strain that does not vanish (`thermal.vanishing` 1e30). A case names a
config and settings, as the cases of reproduce.py do, and its `pauses` (process.dwell) in s. Its `limit`, if
any, is an interpass temperature in °C: one more run at that pause has it as a constraint. Hours count the
pauses. A run that was interrupted goes on where it was, one that is done is only looked at again; --table
runs nothing.
"""

import os

import needs_packages  # noqa: F401 (before any package)
from fabseq_tools.run.command_line import run_script

from built import parse_cases, parser_of_cases, print_cases, rounds_of
from fabseq_tools.run.check_words import inner, result_of
from fabseq_tools.run.words import number
from fabseq_tools.study.comparison import BINARY
from fabseq_tools.study.families import Families, heights_of

HEAD = ("part", "pause, s", "layers", "as built", "released", "highest interpass, °C", "hours")
NO_HEAT = {"thermal.vanishing": 1e30}


def main():
    arguments, cases = parse_cases(parser_of_cases(__doc__, "heat"))

    def rows(name):
        rounds = rounds_of(cases, name, arguments)
        for pause in cases[name]["pauses"]:
            for layers, run in judged(rounds, pause, cases[name].get("limit", {})):
                yield [f"{pause}", layers, *figures(run)]
    print_cases(arguments, cases, HEAD, rows)


def judged(rounds, pause, limit):
    """Names and simulations of a pause's rows."""
    asked = {"process.dwell": pause}
    families = Families(rounds.config, rounds.target_thickness())
    height = heights_of(rounds.run(*families.one_layer().run()))
    planar = families.planar("", "", families.up, height(families.up))
    yield "planar", rounds.run(f"planar_{pause}", planar.settings | asked | BINARY, "simulate")
    yield "start", rounds.run(f"start_{pause}", asked | BINARY, "simulate")
    for layers, name, settings in designs(rounds.config, pause, limit):
        rounds.run(name, settings)
        design = os.path.join(rounds.path(name), "result.h5")
        yield layers, rounds.run(f"{name}_judged_{pause}", asked | BINARY, "simulate", ["-design", design])


def designs(config, pause, limit):
    """Name in the table, folder and settings of the optimized layers. Without heat no pause changes them."""
    yield "without heat", "without", NO_HEAT
    yield "with heat", f"with_{pause}", {"process.dwell": pause}
    if limit.get("pause") == pause:
        constraint = {"type": "interpass_temperature", "limit": limit["value"]}
        constraints = {"constraints": [*config["constraints"], constraint]}
        yield f"with heat, limit {limit['value']} °C", f"limit_{pause}", {"process.dwell": pause} | constraints


def figures(run):
    """The cells of a row. Lengths are the root mean square of the skin's distance from the drawing."""
    block = run.summary[result_of(run)]
    keys = [("finished", "as_built", "skin", "rms"), ("finished", "released", "skin", "rms"),
            ("interpass", "highest", "value"), ("build_hours",)]
    return ["–" if value is None else f"{value:,.0f}" if value >= 100 else number(value)
            for value in (inner(*names)(block) for names in keys)]


if __name__ == "__main__":
    run_script(main)
