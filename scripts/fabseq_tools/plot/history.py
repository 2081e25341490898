# SPDX-License-Identifier: MIT
"""Draws how one or several optimizations went, over their iterations.

    fabseq-tools plot-history OUTPUT_DIRECTORY... [--labels NAME...] [--seconds] [--picture history.png]

Over the iterations: the first objective term relative to the planar baseline (below 1: better than planar),
the worst relative violation of a constraint (0 and below: all satisfied), the sharpness of the layers, and
the largest change of a variable. With --seconds the first two, over the iterations and over the wall time. A
dot marks the iteration that became the result, hollow where it violates a constraint. Reads history.jsonl
and, where the run has ended, summary.json; a run without one has no baseline and is drawn relative to its
first iteration.
"""

import itertools
import os

import matplotlib.pyplot as plt
from matplotlib.ticker import MaxNLocator

from fabseq_tools.plot.drawing import ALLOWED, INK, OPTIMIZED, PLANAR, SOFT_INK, save, tidy
from fabseq_tools.run.command_line import RunError, parser_of
from fabseq_tools.run.misses import worst_misses
from fabseq_tools.run.read_run import read_history, read_json

COMMAND = "plot-history"

COLOURS = [OPTIMIZED, PLANAR, "#7a4fa3", "#c2452d", "#3c7d3c", INK]
LINEAR_VIOLATION = 0.01  # below this the axis of the violations is linear: ends of runs stay readable


class Curves:
    """What is drawn of an output directory, whose run may still be going on."""

    def __init__(self, directory, label):
        history = read_history(directory)
        if not history or not history[0]["objective"]:
            raise RunError(f"{directory}: history.jsonl has no iteration with an objective yet")
        ended = os.path.exists(os.path.join(directory, "summary.json"))
        summary = read_json(directory, "summary.json") if ended else {}
        terms = [line["objective"][0] for line in history]
        responses = summary.get("baseline", {}).get("responses", [])
        planar = next((r["value"] for r in responses if r["name"] == "objective_0"), None)
        self.label = label + ("" if planar else " (relative to its first iteration)")
        self.constrained = any(line["constraints"] for line in history)
        self.iterations = [line["iteration"] for line in history]
        self.seconds = list(itertools.accumulate(line["seconds"]["total"] for line in history))
        self.history, self.summary = history, summary
        self.values = [[term / (planar or terms[0]) for term in terms], worst_misses(self),
                       *([line[key] for line in history] for key in ("beta", "change"))]
        self.feasible, best = summary.get("feasible", True), summary.get("best_iteration")
        self.best = self.iterations.index(best) if best in self.iterations else None


def draw(runs, over_seconds):
    """A column of charts over the iterations, or two of the first charts, the second over the wall time."""
    heights, columns, size = ([3, 2], 2, (10.0, 6.0)) if over_seconds else ([3, 2, 1.2, 1.2], 1, (8.0, 9.0))
    figure, axes = plt.subplots(len(heights), columns, figsize=size, sharex="col", sharey="row", squeeze=False,
                                height_ratios=heights, constrained_layout=True)
    for run, colour in zip(runs, itertools.cycle(COLOURS)):
        for column, abscissa in zip(axes.T, (run.iterations, run.seconds)):
            for axis, values in zip(column, run.values):
                axis.plot(abscissa, values, color=colour, lw=1.6, label=run.label)
            if run.best is not None:
                for axis, values in zip(column[:2], run.values):
                    axis.plot(abscissa[run.best], values[run.best], "o", ms=7, mec=colour,
                              mfc=colour if run.feasible else "white", zorder=5)
    tidy(axes.flat)
    for column in axes.T:
        column[0].set(yscale="log", ylabel="first objective term,\nrelative to planar")
        column[0].axhline(1.0, color=SOFT_INK, lw=1.0, ls="--")
        style_violation(column[1], any(run.constrained for run in runs))
    axes[-1, 0].set_xlabel("iteration")
    axes[-1, 0].xaxis.set_major_locator(MaxNLocator(integer=True))
    if over_seconds:
        for axis in axes[:, 1]:
            axis.set_ylabel("")
        axes[1, 1].set_xlabel("seconds since the first iteration began")
        axes[0, 0].legend(frameon=False, fontsize=9, loc="upper right")
    else:
        axes[2, 0].set_ylabel("sharpness β")
        axes[2, 0].set_ylim(bottom=0.0)
        axes[3, 0].set(ylabel="largest change\nof a variable", yscale="log")
        axes[0, 0].legend(frameon=False, fontsize=9, loc="lower left", bbox_to_anchor=(0.0, 1.0), borderaxespad=0.2)
    return figure


def style_violation(axis, constrained):
    axis.set_ylabel("worst constraint, missed\nby this share or ratio")
    axis.set_yscale("symlog", linthresh=LINEAR_VIOLATION)
    low, high = axis.get_ylim()
    axis.axhspan(min(low, -LINEAR_VIOLATION), 0.0, color=ALLOWED, zorder=0)
    axis.set_ylim(min(low, -LINEAR_VIOLATION), max(high, LINEAR_VIOLATION))
    axis.axhline(0.0, color=SOFT_INK, lw=1.0, ls="--")
    if not constrained:
        axis.text(0.5, 0.5, "no constraints", transform=axis.transAxes, ha="center", color=SOFT_INK)


def main(words):
    parser = parser_of(__doc__, COMMAND)
    parser.add_argument("directories", nargs="+", metavar="OUTPUT_DIRECTORY")
    parser.add_argument("--labels", nargs="+", metavar="NAME", help="names in the legend (default: the directories' names)")
    parser.add_argument("--seconds", action="store_true", help="objective and violation only, over iterations and over wall time")
    parser.add_argument("--picture", default="history.png", help="picture to write (default: %(default)s)")
    arguments = parser.parse_args(words)
    labels = arguments.labels or [os.path.basename(os.path.normpath(directory)) for directory in arguments.directories]
    if len(labels) != len(arguments.directories):
        parser.error(f"{len(labels)} labels for {len(arguments.directories)} directories")
    save(draw(list(map(Curves, arguments.directories, labels)), arguments.seconds), arguments.picture, 150)
