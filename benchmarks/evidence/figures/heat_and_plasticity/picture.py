# SPDX-License-Identifier: MIT
"""Bars: the displacement of each part and sequence by CalculiX and by linear models."""

import matplotlib

matplotlib.use("Agg")

from matplotlib import pyplot

from fabseq_tools.plot.drawing import INK, OPTIMIZED, PLANAR, plain_text, save, tidy

COLOURS = {"ccx": INK, "constant": PLANAR, "thermal": OPTIMIZED, "own cooling": "#7fb3a6"}
WORDS = {"ccx": "CalculiX, heat and plastic flow", "constant": "constant strain",
         "thermal": "strain of the ground's temperature", "own cooling": "with the cooling of what is built"}
BAR = 0.2


def draw(cases, path):
    """`cases`: {name: figures of with_heat.py}."""
    with plain_text():
        figure, axes = pyplot.subplots(1, len(cases), figsize=(4.4 * len(cases), 3.2), squeeze=False)
        figure.subplots_adjust(left=0.09, right=0.98, top=0.9, bottom=0.27, wspace=0.2)
        tidy(axes[0])
        for axis, (case, found) in zip(axes[0], cases.items()):
            for number, (model, colour) in enumerate(COLOURS.items()):
                places = [place + (number - 1.5) * BAR for place in range(len(found))]
                axis.bar(places, [row[model]["rms"] for row in found.values()], BAR, color=colour, label=WORDS[model])
            axis.set_xticks(range(len(found)), list(found))
            axis.set_title(case, color=INK)
        axes[0][0].set_ylabel("displacement after the release, rms, mm")
        figure.legend(*axes[0][0].get_legend_handles_labels(), loc="lower center", ncols=2, frameon=False)
        save(figure, path, 150)
