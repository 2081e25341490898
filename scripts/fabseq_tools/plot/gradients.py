# SPDX-License-Identifier: MIT
"""Draws how close adjoint gradients come to differences, over the step.

    fabseq-tools plot-gradients OUTPUT_DIR [--picture FILE]

OUTPUT_DIR is the output directory of a run with `-task check_gradients`; the picture goes to
OUTPUT_DIR/gradient_check.svg unless said otherwise. It has a curve for each component of each response and
each kind of variables: the relative error of the central difference against its step.
"""

import itertools
import math
import os

import numpy as np
from matplotlib import ticker
from matplotlib.figure import Figure

from fabseq_tools.plot.drawing import draw_directory, tidy
from fabseq_tools.run.read_run import read_json

COMMAND = "plot-gradients"

COLOURS = ["#1b6ca8", "#d1495b", "#2e933c", "#8a5fbf", "#c77d0a", "#444444"]
DASHES = ["-", "--", ":", "-."]
LOWEST, HIGHEST = 1e-12, 10.0  # errors; those beyond are drawn at the end of the axis
LINE = 0.19  # inches of a line of the legend


def label(component):
    variables = component["variables"]
    return f"{component['name']} {component['type']}{'' if variables == 'design' else f', {variables}'}"


def draw(check, title):
    components = check["components"]
    figure = Figure(figsize=(9.0, max(5.0, 0.8 + LINE * len(components))), constrained_layout=True)
    axis = figure.add_subplot()
    for component, (dash, colour) in zip(components, itertools.cycle(itertools.product(DASHES, COLOURS))):
        errors = np.clip(component["relative_errors"], LOWEST, HIGHEST)
        axis.plot(check["steps"], errors, color=colour, ls=dash, lw=1.4, label=label(component))
    axis.set(xscale="log", yscale="log", ylim=(LOWEST, HIGHEST), xlabel="step, fraction of the variable's range",
             ylabel="relative error of the directional derivative")
    for ends in (axis.xaxis, axis.yaxis):
        ends.set_major_formatter(ticker.FuncFormatter(lambda value, _: f"1e{round(math.log10(value))}"))
    figure.suptitle(title, x=0.02, ha="left")
    tidy([axis])
    axis.legend(frameon=False, fontsize=8, loc="upper left", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.0)
    return figure


def main(words):
    def draw_check(directory):
        check = read_json(directory, "gradient_check.json")
        return draw(check, f"Gradients of {check.get('name', os.path.basename(os.path.normpath(directory)))}")
    draw_directory(words, __doc__, COMMAND, "gradient_check.svg", draw_check, 150)
