#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Runs the cases of configs/built_cases.json, of material that goes to nominal positions, and prints a table
of what they reach, in length units, and of what is left of it under the changes of -task sensitivity.

    scripts/figures/built.py [CASE...] [--ranks N] [--output output/built] [--cases FILE.json] [--table]
                             [-- PROGRAM OPTIONS]

A case that was interrupted goes on where it was, one that is done is only looked at again; --table runs
nothing. A length is the root of the first distortion that was optimized. Gains are of the binary layers,
which are what is built: over planar layers, over the start design, which is not optimized, over planar layers
on a grid twice as fine, and the worst under any change. Of rms it is that of the whole part.
"""

import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "use"))

from command_line import PROGRAM, ROOT, RunError, parse, parser_of, run_script
from read_run import Run, duration, read_json
from reproduce import Cases, run

HEAD = ("case", "planar", "start", "smooth", "binary", "gain", "over start", "rms", "finer grid", "worst", "constraints", "time")


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
            again = ["-restart", "auto", "-sensitivity", "-output", directory]
            run(arguments.program, arguments.ranks, [*cases.command(name), *again, *arguments.rest])
        try:
            print("| " + " | ".join([cases[name]["what"], *figures(directory)]) + " |", flush=True)
        except (RunError, OSError) as error:
            if not arguments.table:
                raise
            print(f"{name}: {error}", file=sys.stderr)


def figures(directory):
    """The cells of a run's row."""
    result = Run(directory, with_fields=False)
    lengths = {block: result.length(block) for block in ("baseline", "start", "optimized", "binary")}
    rms = [result.summary[block]["displacement"]["rms"] for block in ("baseline", "binary")]
    return [*(f"{length:.4g}" for length in lengths.values()), f"{lengths['baseline'] / lengths['binary']:.1f}",
            f"{lengths['start'] / lengths['binary']:.1f}", f"{rms[0] / rms[1]:.1f}", *gains_under_changes(directory),
            "satisfied" if result.summary["feasible"] else f"violated by {result.summary['worst_constraint']:.1%}",
            duration(result.summary["seconds"]["total"])]


def gains_under_changes(directory):
    """On the finer grid, and the worst with the change that brings it; dashes without a table of changes."""
    if not os.path.exists(os.path.join(directory, "sensitivity.json")):
        return "–", "–"
    table = read_json(directory, "sensitivity.json")
    finer = [change["ratio"]["length"] for change in table["changes"]
             if change["change"] == "grid twice as fine" and "ratio" in change]
    worst = table["worst"]["length"]
    return f"{finer[0]:.1f}" if finer else "–", f"{worst['ratio']:.1f}, {worst['change']}"


if __name__ == "__main__":
    run_script(main)
