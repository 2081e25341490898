#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Fills results/figures.json from the runs that it names, and says which pages then have another figure.

    figures/fill_figures.py [--output output] [--check]

Figures of runs that are not there stay as they are. --check writes nothing.
"""

import math
import os
import sys

import needs_packages  # noqa: F401 (before any package)
from fabseq_tools.run.command_line import parser_of, run_script
from fabseq_tools.run.read_run import Run, read_json

from figure_list import faults, read_figures, write_figures


def main():
    parser = parser_of(__doc__)
    parser.add_argument("--output", default="output", help="holds a directory for each study (default: %(default)s)")
    parser.add_argument("--check", action="store_true", help="write nothing")
    arguments = parser.parse_args()
    figures = read_figures()
    if not arguments.check:
        for figure in figures:
            if "run" in figure:
                fill(figure, arguments.output)
        write_figures(figures)
    found = faults(figures)
    print("\n".join(found), end="\n" if found else "")
    sys.exit(1 if found else 0)


def fill(figure, output):
    source = figure["run"]
    directory = os.path.join(output, source["study"], source["case"])
    if not os.path.exists(os.path.join(directory, "summary.json")):
        return
    if source.get("worst"):
        # Pages say "at least".
        value = math.floor(10.0 * read_json(directory, "sensitivity.json")["worst"]["length"]["ratio"]) / 10.0
    else:
        run = Run(directory, with_fields=False)
        numerator, denominator = (run.length(block) for block in source["lengths"])
        value = numerator / denominator
    if printed(value) != figure["value"]:
        print(f"{figure['name']}: {figure['value']} becomes {printed(value)}")
        figure["value"] = printed(value)


def printed(ratio):
    return f"{ratio:.1f}"


if __name__ == "__main__":
    run_script(main)
