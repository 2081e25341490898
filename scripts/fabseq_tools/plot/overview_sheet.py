# SPDX-License-Identifier: MIT
"""The sheet of an overview: a headline, a row of pictures with their legends, and a row of charts."""

import textwrap

import matplotlib.pyplot as plt
import numpy as np

from fabseq_tools.plot import render_part
from fabseq_tools.plot.drawing import INK, SOFT_INK
from fabseq_tools.run.words import quantity

WIDTH = 16.0  # inches
DOTS_PER_INCH = 120
LINE = 0.25   # inches: height of a line below the headline
LETTERS = 165  # of such a line, at most
TITLE_LINE, TITLE_LETTERS = 0.38, 95  # the same of the headline
BETWEEN_PANELS, BETWEEN_GROUPS = 0.01, 0.03  # of the width
CHEQUERED = "chequered: thickness out of range"
TITLE, HEADINGS, PICTURES, LEGENDS, CHARTS = range(5)  # rows
LOOK = {"font.family": "DejaVu Sans", "font.size": 11, "text.color": INK, "axes.labelcolor": SOFT_INK,
        "axes.edgecolor": "#c5c9ce", "axes.spines.top": False, "axes.spines.right": False, "axes.axisbelow": True,
        "grid.color": "#e6e8eb", "xtick.color": SOFT_INK, "ytick.color": SOFT_INK, "axes.titlesize": 13,
        "axes.titlelocation": "left", "axes.titleweight": "bold", "axes.titlepad": 14}


def draw_sheet(path, title, sentences, pictures, labels, charts, unit):
    """Writes the picture. `sentences`: those below the headline, each on a line of its own or more. `labels`:
    words and colour for each of `pictures`. `charts`: functions that draw on axes."""
    plt.rcParams.update(LOOK)
    headings = textwrap.wrap(title, TITLE_LETTERS)
    more = TITLE_LINE * (len(headings) - 1)
    lines = [line for sentence in sentences for line in textwrap.wrap(sentence, LETTERS)]
    panels = Panels(pictures)
    tall = min(max(panels.width * WIDTH * pictures.aspect, 1.8), 5.5)
    sheet = Sheet([0.80 + more + LINE * len(lines), 0.55, tall, 1.55, 2.9, 0.75])
    for number, line in enumerate(headings):
        sheet.text(0.03, TITLE, 0.48 + TITLE_LINE * number, line, fontsize=min(22, 1500 / max(map(len, headings))), weight="bold")
    for number, line in enumerate(lines):
        sheet.text(0.03, TITLE, 0.90 + more + LINE * number, line, fontsize=11.5, color=SOFT_INK)
    panels.draw(sheet, pictures, labels)
    panels.add_legends(sheet, pictures, unit)
    width = (0.93 - 0.075 * (len(charts) - 1)) / max(len(charts), 1)
    for column, plot in enumerate(charts):
        plot(sheet.axes(0.055 + (width + 0.07) * column, CHARTS, width))
    sheet.figure.savefig(path, dpi=DOTS_PER_INCH)
    plt.close(sheet.figure)


class Sheet:
    """A figure of rows with heights in inches, top to bottom; lengths across are fractions of the width."""

    def __init__(self, rows):
        self.rows = rows
        self.height = sum(rows)
        self.figure = plt.figure(figsize=(WIDTH, self.height), dpi=DOTS_PER_INCH, facecolor="white")

    def up(self, row, down):
        """Height, as a fraction of the figure's, of what lies `down` inches below the upper edge of a row."""
        return 1.0 - (sum(self.rows[:row]) + down) / self.height

    def axes(self, left, row, width, top=0.0, tall=None):
        """Axes `top` inches below a row's upper edge, `tall` inches high (default: the rest of the row)."""
        tall = self.rows[row] - top if tall is None else tall
        return self.figure.add_axes([left, self.up(row, top + tall), width, tall / self.height])

    def text(self, left, row, down, text, **how):
        self.figure.text(left, self.up(row, down), text, va="center", **how)


class Panels:
    """Where pictures stand: those of layers in a group, then those of distorted shapes, all of one width."""

    def __init__(self, pictures):
        counts = pictures.layers, len(pictures.images) - pictures.layers
        self.width = (0.95 - BETWEEN_GROUPS - BETWEEN_PANELS * (sum(counts) - 2)) / sum(counts)
        self.lefts, self.groups, left = [], [], 0.025
        for count in counts:
            self.groups.append((left, left + count * self.width + (count - 1) * BETWEEN_PANELS))
            self.lefts += [left + k * (self.width + BETWEEN_PANELS) for k in range(count)]
            left = self.groups[-1][1] + BETWEEN_GROUPS

    def draw(self, sheet, pictures, labels):
        for left, image, (words, colour) in zip(self.lefts, pictures.images, labels):
            axes = sheet.axes(left, PICTURES, self.width)
            axes.imshow(image)
            axes.set_axis_off()
            sheet.text(left + self.width / 2, LEGENDS, 0.18, words, ha="center", weight="bold", color=colour)

    def add_legends(self, sheet, pictures, unit):
        headings = "Layers, in the order they are built", f"Distorted shape, drawn {scale_words(pictures.exaggeration)}"
        for (left, _), words in zip(self.groups, headings):
            sheet.text(max(left, 0.03), HEADINGS, 0.20, words, fontsize=13, weight="bold")
        middles = [(left + right) / 2 for left, right in self.groups]
        legend(sheet, middles[0], render_part.LAYER_COLOURS, "built first", "built last")
        legend(sheet, middles[1], render_part.DISPLACEMENT_COLOURS, "displacement  0", quantity(pictures.largest, unit))
        notes = ["grey: undistorted"] + ["dots: where distortion is measured"] * bool(len(pictures.measured))
        marks = [f"red: {pictures.failing_words}"] * pictures.marks + [CHEQUERED] * pictures.chequers
        if marks:
            sheet.text(middles[0], LEGENDS, 0.90, "      ".join(marks), ha="center", fontsize=10.5, color=SOFT_INK)
        sheet.text(middles[1], LEGENDS, 0.90, "      ".join(notes), ha="center", fontsize=10.5, color=SOFT_INK)


def scale_words(exaggeration):
    return "as it is" if exaggeration == 1 else f"{exaggeration:g} times {'larger' if exaggeration > 1 else 'as large'}"


def legend(sheet, middle, colours, low, high):
    left, width = middle - 0.09, 0.18
    axes = sheet.axes(left, LEGENDS, width, top=0.52, tall=0.14)
    axes.imshow(np.linspace(0, 1, 256)[None, :], aspect="auto", cmap=colours)
    axes.set_axis_off()
    sheet.text(left - 0.006, LEGENDS, 0.59, low, ha="right", fontsize=10.5, color=SOFT_INK)
    sheet.text(left + width + 0.006, LEGENDS, 0.59, high, ha="left", fontsize=10.5, color=SOFT_INK)
