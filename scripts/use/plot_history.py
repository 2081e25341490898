#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""How optimizations went: one picture of one or several output directories.

    scripts/use/plot_history.py OUTPUT_DIRECTORY... [--labels NAME...] [--seconds] [--picture history.png]

Over the iterations: the first objective term relative to the planar baseline (below 1: better than planar),
the worst relative violation of a constraint (0 and below: all satisfied), the sharpness of the layers, and
the largest change of a variable. With --seconds the first two, over the iterations and over the wall time. A
dot marks the iteration that became the result, hollow where it violates a constraint. Reads history.jsonl
and, where the run has ended, summary.json; a run without one has no baseline and is drawn relative to its
first iteration.
"""

import itertools
import json
import os
import sys

from drawing import ALLOWED, INK, OPTIMIZED, PLANAR, SOFT_INK, parser_of, tidy  # before matplotlib

import matplotlib.pyplot as plt
from matplotlib.ticker import MaxNLocator

from read_run import read_json

COLOURS = [OPTIMIZED, PLANAR, "#7a4fa3", "#c2452d", "#3c7d3c", INK]
LINEAR_VIOLATION = 0.01  # below this the axis of the violations is linear: ends of runs stay readable


class Run:
    """What plot_history.py needs of an output directory; the run may still be going on."""

    def __init__(self, directory, label):
        self.label = label or os.path.basename(os.path.normpath(directory))
        self.history = read_history(os.path.join(directory, "history.jsonl"))
        ended = os.path.exists(os.path.join(directory, "summary.json"))
        self.summary = read_json(directory, "summary.json") if ended else {}
        self.iterations = [line["iteration"] for line in self.history]

    def values(self, key):
        return [line[key] for line in self.history]

    def seconds(self):
        """At the end of each iteration, since the first began."""
        return list(itertools.accumulate(line["seconds"]["total"] for line in self.history))

    def relative_objective(self):
        """(values, whether they are relative to the planar baseline)"""
        terms = [line["objective"][0] for line in self.history]
        responses = self.summary.get("baseline", {}).get("responses", [])
        planar = next((r["value"] for r in responses if r["name"] == "objective_0"), None)
        return [term / (planar or terms[0]) for term in terms], bool(planar)

    def best(self):
        """(position in the history, whether all constraints hold there) of the iteration that became the
        result."""
        number = self.summary.get("best_iteration")
        if number not in self.iterations:
            return None
        return self.iterations.index(number), self.summary.get("feasible", True)


def read_history(path):
    """The lines of a history; a last line that is still being written is left out."""
    if not os.path.exists(path):
        sys.exit(f"plot_history.py: {path}: no such file; only -task optimize writes a history")
    with open(path, encoding="utf-8") as file:
        text = file.read()
    history = [json.loads(line) for line in text[:text.rfind("\n") + 1].splitlines() if line.strip()]
    if not history or not history[0]["objective"]:
        sys.exit(f"plot_history.py: {path} has no iteration with an objective yet")
    return history


def draw_seconds(runs):
    """Objective and violation, over the iterations in the left column and over the wall time in the right
    one."""
    figure, axes = plt.subplots(2, 2, figsize=(10.0, 6.0), sharex="col", sharey="row",
                                height_ratios=[3, 2], constrained_layout=True)
    for run, colour in zip(runs, COLOURS * len(runs)):
        rows = [run.relative_objective()[0], run.values("worst_constraint")]
        for column, abscissa in zip(axes.T, (run.iterations, run.seconds())):
            for axis, row in zip(column, rows):
                axis.plot(abscissa, row, color=colour, lw=1.6, label=run.label)
            mark_best(column, run, rows, colour, abscissa)
    tidy(axes.flat)
    for column in axes.T:
        style_objective(column[0])
        style_violation(column[1], runs)
    axes[0, 0].legend(frameon=False, fontsize=9, loc="upper right")
    for axis in axes[:, 1]:
        axis.set_ylabel("")
    axes[1, 0].set_xlabel("iteration")
    axes[1, 1].set_xlabel("seconds since the first iteration began")
    return figure


def draw(runs):
    figure, axes = plt.subplots(4, 1, figsize=(8.0, 9.0), sharex=True, height_ratios=[3, 2, 1.2, 1.2], constrained_layout=True)
    for run, colour in zip(runs, COLOURS * len(runs)):
        objective, is_relative_to_planar = run.relative_objective()
        label = run.label if is_relative_to_planar else f"{run.label} (relative to its first iteration)"
        rows = [objective, run.values("worst_constraint"), run.values("beta"), run.values("change")]
        for axis, row in zip(axes, rows):
            axis.plot(run.iterations, row, color=colour, lw=1.6, label=label)
        mark_best(axes, run, rows, colour, run.iterations)
    tidy(axes)
    style(axes, runs)
    return figure


def mark_best(axes, run, rows, colour, abscissa):
    if not run.best():
        return
    position, is_feasible = run.best()
    for axis, row in zip(axes[:2], rows):
        axis.plot(abscissa[position], row[position], "o", ms=7, mec=colour, mfc=colour if is_feasible else "white", zorder=5)


def style(axes, runs):
    objective, violation, beta, change = axes
    style_objective(objective)
    objective.legend(frameon=False, fontsize=9, loc="lower left", bbox_to_anchor=(0.0, 1.0), borderaxespad=0.2)
    style_violation(violation, runs)
    beta.set_ylabel("sharpness β")
    beta.set_ylim(bottom=0.0)
    change.set_yscale("log")
    change.set_ylabel("largest change\nof a variable")
    change.set_xlabel("iteration")
    change.xaxis.set_major_locator(MaxNLocator(integer=True))


def style_objective(axis):
    axis.set_yscale("log")
    axis.set_ylabel("first objective term,\nrelative to planar")
    axis.axhline(1.0, color=SOFT_INK, lw=1.0, ls="--")


def style_violation(axis, runs):
    axis.set_ylabel("worst constraint,\nrelative violation")
    axis.set_yscale("symlog", linthresh=LINEAR_VIOLATION)
    low, high = axis.get_ylim()
    axis.axhspan(min(low, -LINEAR_VIOLATION), 0.0, color=ALLOWED, zorder=0)
    axis.set_ylim(min(low, -LINEAR_VIOLATION), max(high, LINEAR_VIOLATION))
    axis.axhline(0.0, color=SOFT_INK, lw=1.0, ls="--")
    if not any(line["constraints"] for run in runs for line in run.history):
        axis.text(0.5, 0.5, "no constraints", transform=axis.transAxes, ha="center", color=SOFT_INK)


def main():
    parser = parser_of(__doc__)
    parser.add_argument("directories", nargs="+", metavar="OUTPUT_DIRECTORY")
    parser.add_argument("--labels", nargs="+", metavar="NAME", help="names in the legend (default: the directories' names)")
    parser.add_argument("--seconds", action="store_true", help="objective and violation only, over iterations and over wall time")
    parser.add_argument("--picture", default="history.png", help="picture to write (default: history.png)")
    arguments = parser.parse_args()
    labels = arguments.labels or [None] * len(arguments.directories)
    if len(labels) != len(arguments.directories):
        parser.error(f"{len(labels)} labels for {len(arguments.directories)} directories")
    runs = [Run(directory, label) for directory, label in zip(arguments.directories, labels)]
    (draw_seconds if arguments.seconds else draw)(runs).savefig(arguments.picture, dpi=150)
    print(arguments.picture)


if __name__ == "__main__":
    main()
