# SPDX-License-Identifier: MIT
"""The curves of `fabseq-tools tradeoff`."""

import matplotlib.pyplot as plt
from matplotlib.ticker import FixedLocator, NullLocator

from fabseq_tools.plot.drawing import INK, OPTIMIZED, PLANAR, plain_text, save, tidy
from fabseq_tools.run.verdict_words import CLASSES

CURVES = (("skin", "as built", OPTIMIZED), ("skin_released", "after the release", INK))
SUFFIXES = (".svg", ".png")
FILLS = dict(zip(CLASSES, ("full", "bottom", "none")))
DOTS = 130  # per inch, of the PNG


def draw(rows, record, path):
    """PATH.svg and PATH.png: lengths over the limit. Points are full where the layers can be built, half full
    where they can but for some places, else hollow."""
    with plain_text():
        figure, axes = plt.subplots(1, 2, figsize=(11.0, 4.4), constrained_layout=True)
        measured, skin = axes
        curve(measured, rows, "objective", "binary layers", OPTIMIZED)
        measured.axhline(record["planar"], color=PLANAR, lw=1.2, ls="--", label="planar layers")
        measured.set_ylabel(record["measure"])
        for key, label, colour in CURVES:
            curve(skin, rows, key, label, colour)
        skin.set_ylabel("deviation of the skin, root mean square")
        tidy(axes)
        for axis in axes:
            style(axis, rows, record)
        for suffix in SUFFIXES:
            save(figure, path + suffix, DOTS)
        plt.close(figure)


def curve(axis, rows, key, label, colour):
    shown = [row for row in rows if row.get(key) is not None]
    axis.plot([row["place"] for row in shown], [row[key] for row in shown], color=colour, lw=1.6, label=label)
    for row in shown:
        axis.plot(row["place"], row[key], "o", ms=7, mec=colour, color=colour, markerfacecoloralt="white", zorder=5,
                  fillstyle=FILLS.get(row["class"], "none"))


def style(axis, rows, record):
    """A tick for each limit. Lengths begin at 0, so that the eye sees factors."""
    if record["over"] == "thickness":
        axis.set_xscale("log")
    axis.xaxis.set_major_locator(FixedLocator([row["place"] for row in rows]))
    axis.xaxis.set_minor_locator(NullLocator())
    axis.set_xticklabels([row["limit"].removesuffix(" degrees") for row in rows], rotation=20, ha="right", fontsize=8)
    unit = f"; lengths in {record['unit']}" if record["unit"] else ""
    axis.set_xlabel(f"{record['label']}\n(half full: buildable but for places; hollow: not buildable{unit})", fontsize=9)
    axis.set_ylim(0.0, 1.05 * axis.get_ylim()[1])
    axis.legend(frameon=False, fontsize=9)
