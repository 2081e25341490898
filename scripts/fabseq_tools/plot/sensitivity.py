# SPDX-License-Identifier: MIT
"""Draws how much better than planar layers a sequence stays under stated changes.

    fabseq-tools plot-sensitivity OUTPUT_DIR [--picture FILE]

OUTPUT_DIR is the output directory of a run with `-task sensitivity` or with `output.sensitivity`; the picture
goes to OUTPUT_DIR/sensitivity.svg unless said otherwise. It has a line for each change, with two ratios of
the planar layers' value to the sequence's: length of the first distortion term, and root mean square of the
part's displacement.
"""

import numpy as np
from matplotlib import ticker
from matplotlib.figure import Figure

from fabseq_tools.plot.drawing import INK, draw_directory, tidy
from fabseq_tools.run.read_run import read_json

COMMAND = "plot-sensitivity"

RATIOS = {"length": ("#d1495b", "length of the first distortion term"),
          "rms": ("#1b6ca8", "rms displacement of the part")}
LINE = 0.24  # inches of a change
MANY = 1e3  # of the axis, end to end: powers of ten alone have numbers


def draw(table):
    changes = table["changes"]
    figure = Figure(figsize=(9.0, 1.5 + LINE * len(changes)), constrained_layout=True)
    axis = figure.add_subplot()
    drawn = []
    for kind, (colour, meaning) in RATIOS.items():
        ratios = [change.get("ratio", {}).get(kind) for change in changes]
        places = [place for place, ratio in enumerate(ratios) if ratio]  # none, or 0: no mark
        drawn += [ratios[place] for place in places]
        axis.plot([ratios[place] for place in places], places, "o", color=colour, ms=6, label=meaning)
    axis.axvline(1.0, color=INK, lw=1.0, zorder=0)
    axis.set(xscale="log", xlabel="planar / this, under the same change", ylim=(len(changes) - 0.5, -0.5))
    axis.set_yticks(range(len(changes)),
                    [change["change"] + " (skipped)" * ("skipped" in change) for change in changes], fontsize=9)
    axis.tick_params(axis="y", length=0)
    style_ratios(axis, drawn)
    tidy([axis])
    axis.legend(frameon=False, fontsize=9, ncol=2, loc="lower left", bbox_to_anchor=(0.0, 1.0))
    figure.suptitle(f"Sensitivity of {table['name']}", x=0.02, ha="left")
    return figure


def style_ratios(axis, ratios):
    """From a round number to another, with 1 and all ratios between them."""
    rounds = np.array([digit * 10.0 ** decade for decade in range(-9, 10) for digit in (1.0, 2.0, 5.0)])
    low = rounds[rounds <= min([0.5, *ratios])].max(initial=rounds[0])
    high = rounds[rounds >= max([2.0, *ratios])].min(initial=rounds[-1])
    axis.set_xlim(low, high)
    axis.xaxis.set_major_locator(ticker.LogLocator(subs=(1.0, 2.0, 5.0) if high / low < MANY else (1.0,)))
    axis.xaxis.set_major_formatter(ticker.FuncFormatter(lambda value, _: f"{value:g}"))
    axis.xaxis.set_minor_locator(ticker.NullLocator())


def main(words):
    draw_directory(words, __doc__, COMMAND, "sensitivity.svg", lambda directory: draw(read_json(directory, "sensitivity.json")),
                   150)
