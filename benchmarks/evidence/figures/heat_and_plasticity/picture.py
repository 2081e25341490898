# SPDX-License-Identifier: MIT
"""Bars: the displacement of each part and sequence by CalculiX and by linear models."""

import matplotlib

matplotlib.use("Agg")

from matplotlib import pyplot

from fabseq_tools.plot.drawing import INK, OPTIMIZED, PLANAR, plain_text, save, tidy
from heat_and_plasticity.compared import BRICKS, FLOW

COLOURS = {BRICKS[0]: INK, BRICKS[1]: "#7f7f7f", FLOW: OPTIMIZED, "constant": PLANAR}
WORDS = {BRICKS[0]: "CalculiX, C3D8I", BRICKS[1]: "CalculiX, C3D8", FLOW: "fabseq, plastic flow, no factor",
         "constant": "fabseq, linear, factor fitted to planar"}
BAR, COLUMNS = 0.2, 3


def draw(cases, path):
    """`cases`: {name: figures of with_heat.py}."""
    columns = min(COLUMNS, len(cases))
    rows = -(-len(cases) // columns)
    with plain_text():
        figure, grid = pyplot.subplots(rows, columns, figsize=(3.4 * columns, 2.3 * rows + 0.7), squeeze=False)
        bottom = 0.8 / (2.3 * rows + 0.7)
        figure.subplots_adjust(left=0.07, right=0.98, top=1.0 - 0.35 * bottom, bottom=bottom, wspace=0.25, hspace=0.45)
        axes = grid.ravel()
        tidy(axes)
        for axis, (case, found) in zip(axes, cases.items()):
            for number, (model, colour) in enumerate(COLOURS.items()):
                places = [place + (number - 1.5) * BAR for place in range(len(found))]
                axis.bar(places, [height_of(row, model) for row in found.values()], BAR, color=colour, label=WORDS[model])
            axis.set_xticks(range(len(found)), list(found))
            axis.set_title(case.replace("_", " "), color=INK)
        for axis in axes[len(cases):]:
            axis.set_axis_off()
        for axis in grid[:, 0]:
            axis.set_ylabel("rms, mm")
        figure.legend(*axes[0].get_legend_handles_labels(), loc="lower center", ncols=2, frameon=False)
        save(figure, path, 150)


def height_of(row, model):
    return row[model]["rms"] if model in BRICKS else row[model][BRICKS[0]]["rms"]
