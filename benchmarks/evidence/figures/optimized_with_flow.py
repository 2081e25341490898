#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Optimizes the parts of studies/flow_cases.json with the linear process and with plastic flow, both with the
part's temperature, and prints a table of what plastic flow says of the layers of both.

    figures/optimized_with_flow.py [CASE...] [--ranks N] [--output output/flow] [--cases FILE.json] [--table]
                                   [-- PROGRAM OPTIONS]

All rows are of binary layers at nominal positions, simulated with plastic flow. A length is the root mean
square of the skin's distance from the drawing. Seconds count one iteration of the optimization. A run that
was interrupted goes on where it was, one that is done is only looked at again; --table runs nothing.
"""

import os
import statistics

import needs_packages  # noqa: F401 (before any package)
from fabseq_tools.run.command_line import run_script
from fabseq_tools.run.read_run import read_history

from built import parse_cases, parser_of_cases, print_cases, rounds_of
from fabseq_tools.run.check_words import inner, result_of
from fabseq_tools.run.words import number
from fabseq_tools.study.comparison import BINARY
from fabseq_tools.study.families import Families, heights_of

HEAD = ("part", "layers", "as built", "released", "class", "s per iteration")
NOMINAL = {"process.deposition": "nominal"}
FLOW = NOMINAL | {"process.model": "elastoplastic"}
MODELS = {"optimized, linear": ("linear", NOMINAL), "optimized, with flow": ("flow", FLOW)}


def main():
    arguments, cases = parse_cases(parser_of_cases(__doc__, "flow"))

    def rows(name):
        for layers, run, seconds in judged(rounds_of(cases, name, arguments)):
            yield [layers, *figures(run), seconds]
    print_cases(arguments, cases, HEAD, rows)


def judged(rounds):
    """Names, simulations and times of a part's rows."""
    families = Families(rounds.config, rounds.target_thickness())
    height = heights_of(rounds.run(*families.one_layer().run()))
    planar = families.planar("", "", families.up, height(families.up))
    yield "planar", rounds.run("planar", planar.settings | FLOW | BINARY, "simulate"), "–"
    for layers, (name, model) in MODELS.items():
        rounds.run(name, model)
        design = os.path.join(rounds.path(name), "result.h5")
        run = rounds.run(f"{name}_judged", FLOW | BINARY, "simulate", ["-design", design])
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
