#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Runs the cases of studies/built_cases.json, of material that goes to nominal positions, and prints
a table of what they reach, in length units, and of what is left of it under the changes of -task sensitivity.

    figures/built.py [CASE...] [--ranks N] [--output output/built] [--cases FILE.json] [--table]
                             [-- PROGRAM OPTIONS]

A case that was interrupted goes on where it was, one that is done is only looked at again; --table runs
nothing. A length is the root of the first distortion that was optimized. Gains are of the binary layers,
which are what is built: over planar layers, over the start design, which is not optimized, of the whole
part's rms, on a grid twice as fine, the worst under changes of strain, layers and grid, and under the other
deposition model.
"""

import argparse
import os
import sys

import needs_packages  # noqa: F401 (before any package)
from fabseq_tools.run.command_line import RunError, parse, parser_of, run_script
from fabseq_tools.run.places import PROGRAM, ROOT
from fabseq_tools.run.read_run import Run, read_json
from fabseq_tools.run.words import duration
from fabseq_tools.study.rounds import Rounds
from reproduce import Cases, run

STUDIES = os.path.join(ROOT, "benchmarks", "evidence", "studies")
THINNER = "layers doubled", "layers quadrupled", "ever thinner"
HEAD = ("case", "planar", "start", "smooth", "binary", "gain", "over start", "rms", "finer grid", "worst", "other model",
        *THINNER, "constraints", "time")


def main():
    arguments, cases = parse_cases(parser_of_cases(__doc__, "built"))

    def rows(case):
        directory = os.path.join(arguments.output, case)
        if not arguments.table:
            again = ["-restart", "auto", "-sensitivity", "-output", directory]
            run(arguments.program, arguments.ranks, [*cases.command(case), *again, *arguments.rest])
        yield figures(directory)
    print_cases(arguments, cases, HEAD, rows)


def parser_of_cases(documentation, name):
    """The words of a script that runs the cases of studies/NAME_cases.json into output/NAME."""
    parser = parser_of(documentation)
    parser.add_argument("names", nargs="*", metavar="CASE")
    parser.add_argument("--ranks", type=int, default=2)
    parser.add_argument("--output", default=os.path.join("output", name))
    parser.add_argument("--table", action="store_true", help="only of what is there")
    parser.add_argument("--cases", default=os.path.join(STUDIES, f"{name}_cases.json"))
    parser.add_argument("--program", default=os.environ.get("FABSEQ_PROGRAM", PROGRAM))
    return parser


def parse_cases(parser):
    arguments = parse(parser)
    return arguments, Cases(arguments.cases)


def rounds_of(cases, name, arguments):
    """Rounds of the case: its config and settings, in the folder that has its name."""
    own = {"config": cases.config(name), "output": os.path.join(arguments.output, name)}
    return Rounds(argparse.Namespace(**vars(arguments) | own), cases[name]["set"], may_run=not arguments.table)


def print_cases(arguments, cases, head, rows):
    """Prints a table: what a case is, and each of its rows(name). With --table, it ends where its runs do."""
    print_line(head)
    print_line(["---"] * len(head))
    for name in arguments.names or cases.table:
        try:
            for row in rows(name):
                print_line([cases[name]["what"], *row])
        except (RunError, OSError) as error:
            if not arguments.table:
                raise
            print(f"{name}: {error}", file=sys.stderr)


def print_line(cells):
    """Of a table of Markdown."""
    print("| " + " | ".join(cells) + " |", flush=True)


def figures(directory):
    """The cells of a run's row."""
    result = Run(directory, with_fields=False)
    lengths = {block: result.length(block) for block in ("baseline", "start", "optimized", "binary")}
    rms = [result.summary[block]["displacement"]["rms"] for block in ("baseline", "binary")]
    return [*(f"{length:.4g}" for length in lengths.values()), f"{lengths['baseline'] / lengths['binary']:.1f}",
            f"{lengths['start'] / lengths['binary']:.1f}", f"{rms[0] / rms[1]:.1f}",
            *gains_under_changes(directory), *gains_with_thinner_layers(directory),
            "satisfied" if result.summary["feasible"] else result.summary["violated"]["words"],
            duration(result.summary["seconds"]["total"])]


def gains_of(directory):
    """By change; none without a table."""
    if not os.path.exists(os.path.join(directory, "sensitivity.json")):
        return {}
    changes = read_json(directory, "sensitivity.json")["changes"]
    return {change["change"]: change["ratio"]["length"] for change in changes if change.get("ratio", {}).get("length")}


def gains_with_thinner_layers(directory):
    """With twice and four times as many layers, planar ones too, and what this tends to, or dashes."""
    gains = gains_of(directory)
    if not gains:
        return ["–"] * len(THINNER)
    limit = read_json(directory, "sensitivity.json")["thin_layers"]["length"]
    found = [next((gain for name, gain in gains.items() if name.startswith(times)), None) for times in THINNER[:2]]
    return [f"{gain:.1f}" if gain else "–" for gain in [*found, limit]]


def gains_under_changes(directory):
    """On the finer grid, the worst with its change, by the other model; dashes without a table."""
    gains = gains_of(directory)
    if not gains:
        return "–", "–", "–"
    of_part = {name: gain for name, gain in gains.items() if not name.startswith(("void", "deposition"))}
    worst = min(of_part, key=of_part.get)
    shown = {name: f"{gain:.1f}" for name, gain in gains.items()}
    other = next((text for name, text in shown.items() if name.startswith("deposition")), "–")
    return shown.get("grid twice as fine", "–"), f"{shown[worst]}, {worst}", other


if __name__ == "__main__":
    run_script(main)
