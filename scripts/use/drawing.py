# SPDX-License-Identifier: MIT
"""What the programs that draw with matplotlib share: colours, the look of axes, command line, tables."""

import argparse
import csv
import os

os.environ.setdefault("MPLBACKEND", "Agg")

INK, SOFT_INK, GRID, ALLOWED = "#22262b", "#6b727b", "#e6e8eb", "#e3f0ea"
OPTIMIZED, PLANAR = "#1f6f8b", "#b0762b"


def parser_of(text):
    """A parser of the command line that prints a program's docstring as it stands."""
    return argparse.ArgumentParser(description=text, formatter_class=argparse.RawDescriptionHelpFormatter)


def tidy(axes):
    """A pale grid behind the curves, no frame at top and right."""
    for axis in axes:
        axis.grid(color=GRID)
        axis.set_axisbelow(True)
        axis.spines[["top", "right"]].set_visible(False)


def write_rows(path, rows, columns):
    with open(path, "w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, columns, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
