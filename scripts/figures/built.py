#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Runs the cases of configs/built_cases.json, of material that goes to nominal positions, and prints a table
of what they reach, in length units.

    scripts/figures/built.py [CASE...] [--ranks N] [--output output/built] [--table] [-- PROGRAM OPTIONS]

A case that was interrupted goes on where it was, one that is done is only looked at again; --table runs
nothing. A length is the root of the distortion that was optimized. Gains are of the binary layers, which are
what is built: over planar layers, and over the start design, which is not optimized.
"""

import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "use"))

from command_line import PROGRAM, ROOT, RunError, parse, parser_of, run_script
from read_run import Run, duration
from reproduce import Cases, run

HEAD = ("case", "planar", "start", "smooth", "binary", "gain", "over start", "max planar", "max binary", "constraints", "time")


def main():
    parser = parser_of(__doc__)
    parser.add_argument("names", nargs="*", metavar="CASE")
    parser.add_argument("--ranks", type=int, default=2)
    parser.add_argument("--output", default=os.path.join("output", "built"))
    parser.add_argument("--table", action="store_true", help="only of what is there")
    parser.add_argument("--cases", default=os.path.join(ROOT, "configs", "built_cases.json"))
    parser.add_argument("--program", default=os.environ.get("FABSEQ_PROGRAM", PROGRAM))
    arguments = parse(parser)
    cases = Cases(arguments.cases)
    print("| " + " | ".join(HEAD) + " |\n|" + " --- |" * len(HEAD))
    for name in arguments.names or cases.table:
        directory = os.path.join(arguments.output, name)
        if not arguments.table:
            again = ["-restart", "auto", "-output", directory]
            run(arguments.program, arguments.ranks, [*cases.command(name), *again, *arguments.rest])
        try:
            print("| " + " | ".join([cases[name]["what"], *figures(Run(directory, with_fields=False))]) + " |", flush=True)
        except (RunError, OSError) as error:
            if not arguments.table:
                raise
            print(f"{name}: {error}", file=sys.stderr)


def figures(result):
    """The cells of a run's row."""
    lengths = {block: result.length(block) for block in ("baseline", "start", "optimized", "binary")}
    largest = [result.summary[block]["displacement"]["max"] for block in ("baseline", "binary")]
    return [*(f"{length:.4g}" for length in lengths.values()), f"{lengths['baseline'] / lengths['binary']:.1f}",
            f"{lengths['start'] / lengths['binary']:.1f}", *(f"{length:.3g}" for length in largest),
            "satisfied" if result.summary["feasible"] else f"violated by {result.summary['worst_constraint']:.1%}",
            duration(result.summary["seconds"]["total"])]


if __name__ == "__main__":
    run_script(main)
