#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Optimizes the parts of studies/heat_cases.json with the linear process and with plastic flow, both with the
part's temperature, and prints a table of what plastic flow says of the layers of both.

    figures/optimized_with_flow.py [CASE...] [--ranks N] [--output output/flow] [--cases FILE.json] [--table]
                                   [-- PROGRAM OPTIONS]

All rows are of binary layers at nominal positions, simulated with plastic flow, with the first pause of a
case. Lengths are the root mean square of the skin's distance from the drawing; seconds are those of an
iteration of the optimization. A run that was interrupted goes on where it was, one that is done is only
looked at again; --table runs nothing.
"""

import os
import statistics
import sys

import needs_packages  # noqa: F401 (before any package)
from fabseq_tools.run.command_line import RunError, run_script
from fabseq_tools.run.read_run import read_history

from built import STUDIES, parse_cases, parser_of_cases, print_line, rounds_of
from fabseq_tools.run.check_words import inner, result_of
from fabseq_tools.run.words import number
from fabseq_tools.study.comparison import BINARY
from fabseq_tools.study.families import Families, heights_of

HEAD = ("part", "layers", "as built", "released", "class", "s per iteration")
NOMINAL = {"process.deposition": "nominal"}
FLOW = NOMINAL | {"process.model": "elastoplastic"}
MODELS = {"optimized, linear": ("linear", NOMINAL), "optimized, with flow": ("flow", FLOW)}


def main():
    parser = parser_of_cases(__doc__, "flow")
    parser.set_defaults(cases=os.path.join(STUDIES, "heat_cases.json"))
    arguments, cases = parse_cases(parser)
    print_line(HEAD)
    print_line(["---"] * len(HEAD))
    for name in arguments.names or cases.table:
        case = cases[name]
        rounds = rounds_of(cases, name, arguments)
        try:
            for layers, run, seconds in judged(rounds, {"process.dwell": case["pauses"][0]}):
                print_line([case["what"], layers, *figures(run), seconds])
        except RunError as error:
            if not arguments.table:
                raise
            print(f"{name}: {error}", file=sys.stderr)


def judged(rounds, pause):
    """Names, simulations and times of a part's rows."""
    families = Families(rounds.config, rounds.target_thickness())
    height = heights_of(rounds.run(*families.one_layer().run()))
    planar = families.planar("", "", families.up, height(families.up))
    yield "planar", rounds.run("planar", planar.settings | pause | FLOW | BINARY, "simulate"), "–"
    for layers, (name, model) in MODELS.items():
        rounds.run(name, pause | model)
        design = os.path.join(rounds.path(name), "result.h5")
        run = rounds.run(f"{name}_judged", pause | FLOW | BINARY, "simulate", ["-design", design])
        yield layers, run, number(iteration_seconds(rounds.path(name)))


def iteration_seconds(directory):
    return statistics.median(line["seconds"]["total"] for line in read_history(directory)[1:])


def figures(run):
    """The cells of a row."""
    block = run.summary[result_of(run)]
    lengths = [inner("finished", state, "skin", "rms")(block) for state in ("as_built", "released")]
    return [*("–" if value is None else number(value) for value in lengths), inner("verdict", "words")(block)]


if __name__ == "__main__":
    run_script(main)
