#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Optimizes the parts of studies/tolerance_cases.json from several starts, with the linear process and with
plastic flow, and prints a table of what plastic flow says of the layers of both.

    figures/flow_starts.py [CASE...] [--ranks N] [--output output/flow_starts] [--cases FILE.json] [--table]
                           [-- PROGRAM OPTIONS]

Two runs of one start are a pair. A length is the root mean square of the skin's distance from the drawing,
of binary layers after the release, simulated with plastic flow. Median and worst are over the starts. The
ratio column is the mean over the pairs of the logarithm of the length with flow over the linear one, and the
standard error of this mean; p is the p value of Wilcoxon's signed-rank test that they lie about 0.
Flow has the yield stress and hardening of mild steel at a strain of 1 %, unless options say otherwise. A run
that was interrupted goes on where it was, one that is done is only looked at again; --table runs nothing.
"""

import os
import statistics

import needs_packages  # noqa: F401 (before any package)
from fabseq_tools.run.check_words import inner, result_of
from fabseq_tools.run.command_line import run_script
from fabseq_tools.run.verdict_words import class_of, rank
from fabseq_tools.run.words import number
from fabseq_tools.study.comparison import BINARY

from built import parse_cases, parser_of_cases, rounds_of
from optimized_with_flow import FLOW, MODELS
from tolerances import class_cell, print_table, ratio_cells

STEEL = {"material.yield_stress": 0.0019, "material.hardening": 0.0017}
HEAD = ("part", "pairs", "median, linear", "with flow", "worst, linear", "with flow", "flow over linear", "flow longer",
        "p", "class better, worse")


def main():
    parser = parser_of_cases(__doc__, "tolerance")
    parser.set_defaults(output=os.path.join("output", "flow_starts"))
    arguments, cases = parse_cases(parser)
    found = {cases[name]["what"]: list(ends(rounds_of(cases, name, arguments), cases[name]["starts"]))
             for name in arguments.names or cases.table}
    together = [row_of(part, pairs) for part, pairs in found.items()]
    print_table(HEAD, [*together, row_of("all", [pair for pairs in found.values() for pair in pairs], are_alike=False)])


def ends(rounds, starts):
    """Pairs of (length, rank of the class): of the linear process, with flow."""
    for place, start in enumerate(starts):
        yield [judged(rounds, place, start, name, model | STEEL) for name, model in MODELS.values()]


def judged(rounds, place, start, name, model):
    run, settings = f"{place}_{name}", {"sequence.initial": start}
    rounds.run(run, model | settings)
    design = os.path.join(rounds.path(run), "result.h5")
    simulated = rounds.run(f"{run}_judged", FLOW | STEEL | BINARY | settings, "simulate", ["-design", design])
    block = simulated.summary[result_of(simulated)]
    return inner("finished", "released", "skin", "rms")(block), rank(class_of(block["verdict"]))


def row_of(part, pairs, are_alike=True):
    """`are_alike`: whether lengths of different pairs compare."""
    lengths, ranks = ([[end[which] for end in pair] for pair in pairs] for which in range(2))
    figures = [number(figure(of_model)) if are_alike else "–"
               for figure in (statistics.median, max) for of_model in zip(*lengths)]
    return [part, str(len(pairs)), *figures, *ratio_cells(lengths), class_cell(ranks)]


if __name__ == "__main__":
    run_script(main)
