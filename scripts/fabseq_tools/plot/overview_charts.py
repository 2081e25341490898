# SPDX-License-Identifier: MIT
"""The charts of an overview: how an optimization went, and the layers of its result or of a simulation."""

import numpy as np
from matplotlib import colormaps, ticker

from fabseq_tools.plot import render_part
from fabseq_tools.plot.drawing import ALLOWED, OPTIMIZED, PLANAR, SOFT_INK
from fabseq_tools.run.words import quantity

PALE = "#d5d9de"


def plot_distortion(axes, run):
    planar = run.distortion("baseline")
    iterations = run.iterations
    values = np.array([line["objective"][run.distortion_term] for line in run.history], dtype=float) / planar
    if run.distortion_config.get("type") == "distortion":
        values = np.sqrt(values)  # lengths
    axes.axhline(1.0, color=PLANAR, linewidth=1.4)
    axes.semilogy(iterations, values, color=OPTIMIZED, linewidth=2)
    low, high = min(values.min(), 1.0) / 1.8, max(values.max(), 1.0) * 2.5
    axes.set_ylim(low, high)
    axes.yaxis.set_major_locator(ticker.LogLocator(subs=(1.0,) if high / low > 50 else (1.0, 2.0, 5.0)))
    axes.yaxis.set_major_formatter(ticker.FuncFormatter(lambda value, _: f"{value:g}"))
    axes.yaxis.set_minor_formatter(ticker.NullFormatter())
    side, gap = ("top", -5) if values[-1] > 1 else ("bottom", 4)
    axes.annotate("planar = 1", (1.0, 1.0), xycoords=axes.get_yaxis_transform(), xytext=(0, gap), textcoords="offset points",
                  ha="right", va=side, color=PLANAR)
    chosen = iterations == run.summary.get("best_iteration")
    axes.plot(iterations[chosen], values[chosen], "o", color=OPTIMIZED,
              markersize=8, markeredgecolor="white", clip_on=False, zorder=5)
    finish_over_iterations(axes, iterations, "Distortion relative to planar", "dot: the result" if chosen.any() else "")


def finish_over_iterations(axes, iterations, title, note=""):
    finish(axes, "iteration", (iterations[0] - 0.5, max(iterations[-1], iterations[0] + 1) + 0.5), 6, title, note)


def plot_layers(axes, run, block="optimized"):
    """Thickness of each layer, with its spread inside the layer and the band that is allowed."""
    constraint = run.thickness_constraint()
    total = len(run.summary[block]["layers"])
    unit = constraint["target"] if constraint else 1.0
    for layer in run.layers(block):
        if layer["thickness"] is None:
            continue
        value, j = layer["thickness"] / unit, layer["number"]
        spread_inside = value * (layer["cv"] or 0.0)
        axes.plot([j, j], [value - spread_inside, value + spread_inside], color=PALE, linewidth=3, solid_capstyle="round")
        plot_dot(axes, j, value, total)
    if constraint:
        axes.axhspan(1 - constraint["tolerance"], 1 + constraint["tolerance"], color=ALLOWED, zorder=0)
    title = f"Layer thickness / target of {quantity(unit, run.unit)}" if constraint else in_unit("Layer thickness", run)
    finish_over_layers(axes, total, title, ("green: allowed     " if constraint else "") + "bar: spread inside a layer")


def plot_motion(axes, run):
    """How much each layer of a simulation moves the nodes, all together."""
    norms = run.summary["layer_displacement_norms"]
    for j, norm in enumerate(norms, start=1):
        axes.plot([j, j], [0.0, norm], color=PALE, linewidth=3)
        plot_dot(axes, j, norm, len(norms))
    axes.set_ylim(bottom=0.0)
    finish_over_layers(axes, len(norms), in_unit("Displacement by each layer", run), "root of the sum of squares over all nodes")


def plot_dot(axes, layer, value, total):
    axes.plot([layer], [value], "o", markersize=9, markeredgecolor="white", zorder=3,
              color=colormaps[render_part.LAYER_COLOURS]((layer - 0.5) / total))


def in_unit(title, run):
    return f"{title}, {run.unit}" if run.unit else title


def finish_over_layers(axes, total, title, note):
    finish(axes, "layer", (0.3, total + 0.7), 8, title, note)


def finish(axes, over, limits, most_ticks, title, note):
    axes.set(xlabel=over, xlim=limits, title=title)
    axes.xaxis.set_major_locator(ticker.MaxNLocator(most_ticks, integer=True))
    axes.grid(axis="y")
    axes.text(1.0, 1.0, note, transform=axes.transAxes, ha="right", va="bottom", fontsize=10, color=SOFT_INK)
