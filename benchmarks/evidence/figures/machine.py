#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Builds the parts of studies/machine_cases.json within the limits of a machine in several kinds of
layers, and prints a table: planar layers, the best tilted ones, the start, heat and guided layers.

    figures/machine.py [CASE...] [--ranks N] [--output output/machine] [--cases FILE.json] [--table]
                               [--step 20] [--azimuths 4] [--thinner] [-- PROGRAM OPTIONS]

The rows are those of `fabseq-tools compare-families`, which says what they mean. A case has a config and
settings as those of reproduce.py; `heat` and `guided`, which are more settings of layers of that kind; and
`judging`, settings of the simulation that is judged: there the torch has no clearance that the optimizer
keeps for safety. A run that was interrupted goes on where it was, one that is done is only looked at again;
--table runs nothing. --thinner prints another table: how much less the part distorts in guided layers than in
upright planar ones, as optimized and with twice and four times as many layers.
"""

import os
import sys

import needs_packages  # noqa: F401 (before any package)
from fabseq_tools.run.command_line import run_script

from built import THINNER, gains_of, gains_with_thinner_layers, parse_cases, parser_of_cases, print_cases, rounds_of
from fabseq_tools.study.compare_families import FIRST, add_scan
from fabseq_tools.study.comparison import Comparison
from fabseq_tools.study.figures import COLUMNS, cells, headings

SHOWN = {key: column for key, column in COLUMNS.items() if key != "largest_tilt"}  # each case limits the tilt


def main():
    parser = parser_of_cases(__doc__, "machine")
    add_scan(parser)
    parser.add_argument("--thinner", action="store_true", help="the table of thinner layers")
    arguments, cases = parse_cases(parser)
    head = ["part", "gain", *THINNER] if arguments.thinner else ["part", FIRST[1], *headings(SHOWN)]
    rows = thinner if arguments.thinner else kinds
    print_cases(arguments, cases, head, lambda name: rows(comparison(cases, name, arguments), arguments))


def kinds(comparison, arguments):
    """A row for each kind of layers."""
    for row in comparison.rows([], arguments.step, arguments.azimuths):
        yield cells(row, FIRST[0], SHOWN)


def thinner(comparison, _):
    """The row of guided layers."""
    family, rounds = comparison.families.guided(), comparison.rounds
    rounds.run(*family.run())
    design = os.path.join(rounds.path(family.name), "result.h5")
    directory = rounds.sensitivity(f"{family.name}_thinner", family.settings, design)
    yield [f"{gains_of(directory)['unchanged']:.1f}", *gains_with_thinner_layers(directory)]


def comparison(cases, name, arguments):
    """Of one part, in a folder of its own."""
    case = cases[name]
    rounds = rounds_of(cases, name, arguments)
    return Comparison(rounds, case, case.get("judging"), say=lambda words: print(f"{name}: {words}", file=sys.stderr, flush=True))


if __name__ == "__main__":
    run_script(main)
