#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Optimizes the parts of studies/tolerance_cases.json from several starts, with solves to a fixed tolerance
and to one that follows the design, and prints a table of what both end with.

    figures/tolerances.py [CASE...] [--ranks N] [--output output/tolerance] [--cases FILE.json] [--table]
                          [--every] [-- PROGRAM OPTIONS]

Two runs of one start are a pair. A length is the root of the first distortion of binary layers. Median and
worst are over the starts. The second table compares the pairs: the mean logarithm of the lengths' ratio with
its standard error, how often `auto` has the longer length, and the p value of Wilcoxon's signed-rank test
that the logarithms lie about 0. Steps count the elastic solves of all iterations, forward and adjoint, by
each layer's slowest side. Seconds are medians of a whole run. --every prints each run, too. A run that was
interrupted goes on where it was, one that is done is only looked at again; --table runs nothing.
"""

import collections
import dataclasses
import math
import statistics

import needs_packages  # noqa: F401 (before any package)
from fabseq_tools.run.command_line import run_script
from fabseq_tools.run.read_run import Run, read_history
from fabseq_tools.run.verdict_words import CLASSES, class_of, rank
from fabseq_tools.run.words import number

from built import parse_cases, parser_of_cases, print_line, rounds_of
from scipy import stats

TOLERANCES = 1e-6, "auto"
HEAD = ("part", "tolerance", "median", "worst", *(name.replace("_", " ") for name in CLASSES), "satisfied", "steps, forward",
        "steps, adjoint", "seconds")
PAIRS_HEAD = ("part", "pairs", "auto over 1e-6", "longer", "p", "median over median", "worst over worst", "class better, worse",
              "steps", "seconds")


@dataclasses.dataclass
class End:
    """What a run ends with."""

    length: float
    rank: int  # of the verdict's class, 0 the best
    feasible: bool
    forward: int  # steps of the elastic solves
    adjoint: int
    seconds: float


def main():
    parser = parser_of_cases(__doc__, "tolerance")
    parser.add_argument("--every", action="store_true", help="a line of each run, too")
    arguments, cases = parse_cases(parser)
    found = {}
    for name in arguments.names or cases.table:
        ends = collections.defaultdict(list)
        rounds = rounds_of(cases, name, arguments)
        for place, start in enumerate(cases[name]["starts"]):
            for tolerance in TOLERANCES:
                run = f"{place}_{tolerance}"
                rounds.run(run, {"sequence.initial": start, "solver.tolerance": tolerance})
                ends[tolerance].append(end_of(rounds.path(run)))
        found[cases[name]["what"]] = ends
    if arguments.every:
        print_every(found)
    print_table(HEAD, [row for part, ends in found.items() for row in rows(part, ends)])
    print_table(PAIRS_HEAD, [pair_row(part, [ends]) for part, ends in found.items()] + [pair_row("all", list(found.values()))])


def end_of(directory):
    run, steps = Run(directory, with_fields=False), read_history(directory)

    def sum_of(kind):
        return sum(sum(line["solver_iterations"][kind]) for line in steps)
    return End(run.length("binary"), rank(class_of(run.summary["binary"]["verdict"])), run.summary["feasible"],
               sum_of("primal"), sum_of("adjoint"), run.summary["seconds"]["total"])


def rows(part, ends):
    """Of a part: one for each tolerance."""
    for tolerance, of_starts in ends.items():
        lengths = [end.length for end in of_starts]
        classes = [sum(end.rank == place for end in of_starts) for place in range(len(CLASSES))]
        median = [statistics.median(values) for values in zip(*((end.forward, end.adjoint, end.seconds) for end in of_starts))]
        yield [part, str(tolerance), number(statistics.median(lengths)), number(max(lengths)), *map(str, classes),
               str(sum(end.feasible for end in of_starts)), *(f"{value:.0f}" for value in median)]


def pair_row(part, parts):
    """How the second tolerance compares with the first, in pairs of all these parts."""
    first, second = ([end for ends in parts for end in ends[tolerance]] for tolerance in TOLERANCES)
    lengths = [(one.length, two.length) for one, two in zip(first, second)]
    ranks = [(one.rank, two.rank) for one, two in zip(first, second)]
    return [part, str(len(first)), *ratio_cells(lengths), over(parts, statistics.median), over(parts, max),
            class_cell(ranks),
            f"{sum(end.forward + end.adjoint for end in second) / sum(end.forward + end.adjoint for end in first):.2f}",
            f"{statistics.median(two.seconds / one.seconds for one, two in zip(first, second)):.2f}"]


def ratio_cells(pairs):
    """Mean logarithm of the second length over the first with its standard error, how often the second is
    longer, and p of Wilcoxon's signed-rank test."""
    logarithms = [math.log(second / first) for first, second in pairs]
    error = statistics.stdev(logarithms) / math.sqrt(len(logarithms))
    return [f"{statistics.mean(logarithms):+.3f} ± {error:.3f}", str(sum(value > 0 for value in logarithms)),
            f"{stats.wilcoxon(logarithms).pvalue:.2f}"]


def class_cell(pairs):
    """How often the second rank is better than the first, and worse."""
    return f"{sum(second < first for first, second in pairs)}, {sum(second > first for first, second in pairs)}"


def over(parts, figure):
    """The ratio of a figure of the lengths; – of several parts, whose lengths do not compare."""
    if len(parts) > 1:
        return "–"
    first, second = (figure([end.length for end in parts[0][tolerance]]) for tolerance in TOLERANCES)
    return f"{second / first:.3f}"


def print_every(found):
    lines = []
    for part, ends in found.items():
        for tolerance, of_starts in ends.items():
            lines += [[part, str(place), str(tolerance), number(end.length), CLASSES[end.rank].replace("_", " "),
                       "yes" if end.feasible else "no", f"{end.forward} + {end.adjoint}", f"{end.seconds:.0f}"]
                      for place, end in enumerate(of_starts, start=1)]
    print_table(("part", "start", "tolerance", "length", "class", "satisfied", "steps", "seconds"), lines)


def print_table(head, lines):
    for line in (head, ["---"] * len(head), *lines):
        print_line(line)
    print()


if __name__ == "__main__":
    run_script(main)
