# SPDX-License-Identifier: MIT
"""The sheet of an overview, from top to bottom: the verdict, the figures, large pictures of layers, and small
pictures and charts."""

import dataclasses
import textwrap

import matplotlib.pyplot as plt

from fabseq_tools.plot.drawing import INK, OPTIMIZED, SOFT_INK
from fabseq_tools.run.verdict_words import COLOURS, FAULTS
from fabseq_tools.run.words import quantity

WIDTH = 16.0  # inches
DOTS_PER_INCH = 120
EDGE, GAP, BEFORE_CHART = 0.03, 0.02, 0.055  # of the width
LINE, LETTERS = 0.27, 150  # inches between the lines below the title, and how many letters one has
TITLE_LETTERS = 70
PLACE_LINE, PLACE_LETTERS = 0.24, 165
SMALL_LETTERS = 34        # of the words below a small picture
TALLEST, SMALL = 6.6, 2.5  # inches: of large pictures, and of small ones and charts
FRAME = "#c5c9ce"
LOOK = {"font.family": "DejaVu Sans", "font.size": 11, "text.color": INK, "axes.labelcolor": SOFT_INK,
        "axes.edgecolor": FRAME, "axes.spines.top": False, "axes.spines.right": False, "axes.axisbelow": True,
        "grid.color": "#e6e8eb", "xtick.color": SOFT_INK, "ytick.color": SOFT_INK, "axes.titlesize": 11,
        "axes.titlelocation": "left", "axes.titleweight": "bold", "axes.titlepad": 14}
TITLE, CARDS, CAPTIONS, PICTURES, LEGEND, PLACES, HEADINGS, CHARTS, FOOT = range(9)  # rows
CARD, CAPTION = 1.48, 0.42  # inches
CARD_LETTERS = 225  # of small text in a card, over the number of cards


@dataclasses.dataclass
class Content:
    """What a sheet shows. `kind`: class of the verdict, None where nobody knows; `cards`: Figures, of what is
    `measured`; `captions`: a title and a short verdict with its class for each picture of `layers`;
    `place_lines`: of the last of them; `labels`: for each picture of `shapes`; `charts`: functions that draw
    on axes; `small`: lines at the end."""

    title: str
    kind: str
    sentences: list
    cards: list
    captions: list
    place_lines: list
    labels: list
    charts: list
    unit: str
    measured: str
    small: list = dataclasses.field(default_factory=list)


def draw_sheet(path, content, layers, shapes):
    """Writes the picture."""
    plt.rcParams.update(LOOK)
    title = textwrap.wrap(content.title, TITLE_LETTERS)
    told = [line for words in content.sentences for line in textwrap.wrap(words, LETTERS)]
    lines = [line for words in content.place_lines for line in textwrap.wrap(words, PLACE_LETTERS)]
    small = [line for words in content.small for line in textwrap.wrap(words, PLACE_LETTERS)]
    count = len(layers.images)
    width = (1.0 - 2 * EDGE - GAP * (count - 1)) / count
    tall = min(width * WIDTH * layers.aspect, TALLEST)
    sheet = Sheet([0.5 + 0.44 * len(title) + LINE * len(told), (CARD + 0.45) * bool(content.cards), CAPTION, tall,
                   0.45 * bool(layers.faults) + 0.1, PLACE_LINE * len(lines) + 0.25, 0.42, SMALL,
                   0.85 + PLACE_LINE * len(small)])
    draw_title(sheet, title, told, content.kind)
    draw_cards(sheet, content.cards, content.unit, content.measured)
    for number_of, (image, caption, pins) in enumerate(zip(layers.images, content.captions, layers.pins)):
        draw_layers(sheet, EDGE + number_of * (width + GAP), width, image, caption, pins)
    draw_legend(sheet, layers.faults)
    for place, line in enumerate(lines):
        sheet.text(EDGE, PLACES, 0.1 + PLACE_LINE * place, line, fontsize=10.5)
    draw_small(sheet, content, shapes)
    for place, line in enumerate(small):
        sheet.text(EDGE, FOOT, 0.8 + PLACE_LINE * place, line, fontsize=9.5, color=SOFT_INK)
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

    def picture(self, left, row, width, image):
        axes = self.axes(left, row, width)
        axes.imshow(image)
        axes.set_axis_off()
        return axes

    def text(self, left, row, down, text, **how):
        return self.figure.text(left, self.up(row, down), text, va="center", **how)

    def box(self, left, row, width, top, tall, **how):
        """A filled or framed rectangle."""
        self.figure.add_artist(plt.Rectangle((left, self.up(row, top + tall)), width, tall / self.height,
                                             transform=self.figure.transFigure, zorder=-1, **how))


def draw_title(sheet, title, told, kind):
    """White on the colour of the verdict, or dark where nobody knows."""
    known = kind in COLOURS
    if known:
        sheet.box(0.0, TITLE, 1.0, 0.0, sheet.rows[TITLE] - 0.15, color=COLOURS[kind])
    for place, line in enumerate(title):
        sheet.text(EDGE, TITLE, 0.36 + 0.44 * place, line, fontsize=26, weight="bold", color="white" if known else INK)
    for place, line in enumerate(told):
        sheet.text(EDGE, TITLE, 0.30 + 0.44 * len(title) + LINE * place, line, fontsize=13, color="white" if known else SOFT_INK)


def draw_cards(sheet, cards, unit, measured):
    """The figures side by side: root mean square large, largest beside it."""
    if not cards:
        return
    width = (1.0 - 2 * EDGE - GAP * (len(cards) - 1)) / len(cards)
    for place, card in enumerate(cards):
        draw_card(sheet, EDGE + place * (width + GAP), width, card, unit, CARD_LETTERS // len(cards))
    if any(card.rms is not None for card in cards):
        sheet.text(EDGE, CARDS, CARD + 0.16, f"Large: root mean square of {measured}, after the best rigid fit.", fontsize=9,
                   color=SOFT_INK)


def draw_card(sheet, left, width, card, unit, letters):
    inner, outer = left + 0.012, left + width - 0.012
    colour = OPTIMIZED if card.is_ours else FRAME
    sheet.box(left, CARDS, width, 0.0, CARD, facecolor="white", edgecolor=colour, linewidth=2.5 if card.is_ours else 1.0)
    sheet.text(inner, CARDS, 0.2, card.title, fontsize=12, weight="bold")
    if card.rms is not None:
        sheet.text(inner, CARDS, 0.57, quantity(card.rms, unit), fontsize=24, weight="bold")
        if card.largest is not None:
            sheet.text(outer, CARDS, 0.6, f"largest {quantity(card.largest, unit)}", ha="right", color=SOFT_INK)
    if card.verdict:
        sheet.text(inner, CARDS, 0.89, card.verdict, weight="bold", color=COLOURS.get(card.kind, INK))
    for line, words in enumerate(textwrap.wrap("   ".join(f"{name} {text}" for name, text in card.more), letters)):
        sheet.text(inner, CARDS, (1.13 if card.verdict else 0.5) + 0.2 * line, words, fontsize=9, color=SOFT_INK)


def draw_layers(sheet, left, width, image, caption, pins):
    title, verdict, kind = caption
    head = sheet.text(left, CAPTIONS, 0.22, title, fontsize=14, weight="bold")
    end = head.get_window_extent(sheet.figure.canvas.get_renderer()).x1 / (WIDTH * DOTS_PER_INCH)
    sheet.text(end + 0.01, CAPTIONS, 0.22, verdict, fontsize=14, weight="bold", color=COLOURS.get(kind, INK))
    axes = sheet.picture(left, PICTURES, width, image)
    for column, row, colour, place in reversed(pins):
        axes.annotate(str(place), (column, row), xytext=(0, 20), textcoords="offset points", ha="center", va="center",
                      color="white", weight="bold", fontsize=10, annotation_clip=False,
                      bbox={"boxstyle": "circle,pad=0.25", "facecolor": colour, "edgecolor": "white"},
                      arrowprops={"arrowstyle": "-", "color": colour, "lw": 2})


def draw_legend(sheet, faults):
    """The colours of what cannot be built, where there is any."""
    left = EDGE
    for kind in faults:
        _, words, colour = FAULTS[kind - 1]
        sheet.box(left, LEGEND, 0.011, 0.15, 0.17, color=colour)
        label = sheet.text(left + 0.016, LEGEND, 0.24, words, color=SOFT_INK)
        left = label.get_window_extent(sheet.figure.canvas.get_renderer()).x1 / (WIDTH * DOTS_PER_INCH) + 0.02


def draw_small(sheet, content, shapes):
    """Distorted shapes and charts in a row."""
    count = len(shapes.images) + len(content.charts)
    width = (1.0 - 2 * EDGE - BEFORE_CHART * len(content.charts) - GAP * len(shapes.images)) / count
    left = EDGE
    sheet.text(EDGE, HEADINGS, 0.12, f"Distorted shape, drawn {scale_words(shapes.exaggeration)}", weight="bold")
    for image, (words, colour) in zip(shapes.images, content.labels):
        sheet.picture(left, CHARTS, width, image)
        for place, line in enumerate(textwrap.wrap(words, SMALL_LETTERS)):
            sheet.text(left + width / 2, FOOT, 0.14 + 0.2 * place, line, ha="center", fontsize=10, color=colour, weight="bold")
        left += width + GAP
    notes = ["grey: undistorted", *["dots: where distortion is measured"] * bool(len(shapes.measured)),
             f"yellow to red: displacement up to {quantity(shapes.largest, content.unit)}"]
    sheet.text(EDGE, FOOT, 0.56, "   ".join(notes), fontsize=9, color=SOFT_INK)
    for plot in content.charts:
        left += BEFORE_CHART
        plot(sheet.axes(left, CHARTS, width))
        left += width


def scale_words(exaggeration):
    return "as it is" if exaggeration == 1 else f"{exaggeration:g} times {'larger' if exaggeration > 1 else 'as large'}"
