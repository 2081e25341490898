#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Draws how the materials of configs/materials change with temperature.

    figures/material_curves.py [--picture docs/material_curves.svg] [--heat docs/material_heat_curves.svg]

The first picture has modulus, yield stress and elongation, and a vertical line at the cut_off. The second has
conductivity and heat capacity. Both have a panel per file.
"""

import os

import needs_packages  # noqa: F401 (before any package)

import matplotlib

matplotlib.use("Agg")

from matplotlib import pyplot

from fabseq_tools.plot.drawing import INK, OPTIMIZED, PLANAR, SOFT_INK, plain_text, save, tidy
from fabseq_tools.run.command_line import parse, parser_of, run_script
from fabseq_tools.run.places import ROOT
from fabseq_tools.run.read_run import read_json

FOLDER = os.path.join(ROOT, "configs", "materials")
FACTORS = {"young_factors": ("modulus", OPTIMIZED), "yield_factors": ("yield stress and hardening", PLANAR)}
HEAT_FACTORS = {"conductivity_factors": ("conductivity", OPTIMIZED), "heat_capacity_factors": ("heat capacity", PLANAR)}


def main():
    parser = parser_of(__doc__)
    parser.add_argument("--picture", metavar="FILE", default=os.path.join(ROOT, "docs", "material_curves.svg"))
    parser.add_argument("--heat", metavar="FILE", default=os.path.join(ROOT, "docs", "material_heat_curves.svg"))
    arguments = parse(parser)
    with plain_text():
        save(draw(draw_material, "share of the value at 20 °C"), arguments.picture, 150)
        save(draw(draw_heat, "share of the file's number"), arguments.heat, 150)


def draw(panel, share):
    names = sorted(name for name in os.listdir(FOLDER) if name.endswith(".json"))
    figure, axes = pyplot.subplots(2, (len(names) + 1) // 2, figsize=(11.0, 5.4), sharey=True)
    figure.subplots_adjust(left=0.06, right=0.94, top=0.94, bottom=0.17, wspace=0.1, hspace=0.34)
    tidy(axes.ravel())
    for axis, name in zip(axes.ravel(), names):
        lines = panel(axis, read_json(FOLDER, name))
        axis.set_title(name.removesuffix(".json"), color=INK)
    for axis in axes[:, 0]:
        axis.set_ylabel(share)
    for axis in axes[-1]:
        axis.set_xlabel("°C")
    figure.legend(lines, [line.get_label() for line in lines], loc="lower center", ncols=len(lines), frameon=False)
    return figure


def draw_material(axis, material):
    """Returns the lines that a legend names. Elongations have an axis of their own, in per cent."""
    temperatures, lines = material["temperatures"], draw_factors(axis, material, FACTORS)
    axis.set_ylim(0, 1.05)
    right = axis.twinx()
    right.spines["top"].set_visible(False)
    right.set_ylim(0, 3.15)
    right.tick_params(labelright=axis.get_subplotspec().is_last_col())
    lines += right.plot(temperatures, [100 * strain for strain in material["elongations"]], color=SOFT_INK,
                        label="elongation, % (right)")
    lines.append(axis.axvline(material["cut_off"], color=INK, linewidth=0.9, linestyle=":", label="cut_off"))
    return lines


def draw_heat(axis, material):
    axis.set_ylim(0, 3.5)
    return draw_factors(axis, material, HEAT_FACTORS)


def draw_factors(axis, material, factors):
    return [axis.plot(material["temperatures"], material[key], color=colour, label=words)[0]
            for key, (words, colour) in factors.items()]


if __name__ == "__main__":
    run_script(main)
