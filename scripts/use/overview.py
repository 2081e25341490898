#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""One picture of a finished optimization: its layers and distortion beside those of planar layers, and how it
got there.

    scripts/use/overview.py OUTPUT_DIR [PICTURE.png] [--table]

OUTPUT_DIR is the output directory of a run with `-task optimize`; the picture goes to OUTPUT_DIR/overview.png
unless said otherwise. `--table` also prints the main figures. Without a display it draws in memory
(virtual_display.py).
"""

import logging
import os

from command_line import parser_of, run_script
from drawing import ALLOWED, INK, OPTIMIZED, PLANAR, SOFT_INK

logging.getLogger("matplotlib.font_manager").setLevel(logging.ERROR)  # the first run would announce its font cache
import matplotlib.pyplot as plt
import numpy as np
from matplotlib import colormaps, ticker

import render_part
from read_run import Run, duration, factor, number
from virtual_display import ensure_display

WIDTH = 16.0  # inches
DOTS_PER_INCH = 120
PALE = "#d5d9de"
DRAWN_DISPLACEMENT = 0.12  # of the box's longest edge: how far the largest displacement is drawn, at most
MOST_DOTS = 24


def main():
    parser = parser_of(__doc__)
    parser.add_argument("directory", metavar="OUTPUT_DIR")
    parser.add_argument("picture", metavar="PICTURE.png", nargs="?")
    parser.add_argument("--table", action="store_true", help="print the main figures")
    arguments = parser.parse_args()
    run = Run(arguments.directory)
    ensure_display()
    draw(run, arguments.picture or os.path.join(arguments.directory, "overview.png"))
    if arguments.table:
        print(table(run))


def draw(run, path):
    plt.rcParams.update({"font.family": "DejaVu Sans", "font.size": 11, "text.color": INK, "axes.labelcolor": SOFT_INK,
                         "axes.edgecolor": "#c5c9ce", "axes.spines.top": False, "axes.spines.right": False,
                         "axes.axisbelow": True, "grid.color": "#e6e8eb", "xtick.color": SOFT_INK, "ytick.color": SOFT_INK,
                         "axes.titlesize": 13, "axes.titlelocation": "left", "axes.titleweight": "bold", "axes.titlepad": 14})
    pictures = Pictures(run)
    sheet = Sheet([1.30, 0.55, min(max(0.225 * WIDTH * pictures.aspect, 1.8), 5.5), 1.55, 2.9, 0.75])
    write_title(sheet, run)
    draw_pictures(sheet, run, pictures)
    constrained = run.config.get("constraints") and any(line["worst_constraint"] is not None for line in run.history)
    charts = [plot_distortion] + [plot_violation] * bool(constrained)
    charts += [plot_layers] * any(layer["thickness"] is not None for layer in run.layers("optimized"))
    width = (0.93 - 0.075 * (len(charts) - 1)) / len(charts)
    for column, plot in enumerate(charts):
        plot(sheet.axes(0.055 + (width + 0.07) * column, 4, width), run)
    sheet.figure.savefig(path, dpi=DOTS_PER_INCH)


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


class Pictures:
    """The four pictures of the part, all with the same view and the same colours."""

    def __init__(self, run):
        fields, config = run.fields, run.config
        self.part = render_part.VoxelPart(fields["density"], config["domain"]["size"], config.get("build_plate", "z-"))
        self.displacements = [render_part.node_vectors(self.part, fields[name])
                              for name in ("planar/displacement", "displacement")]
        shown = np.unique(self.part.faces)
        self.lengths = [np.linalg.norm(displacement, axis=1) for displacement in self.displacements]
        self.largest_each = [length[shown].max() for length in self.lengths]
        self.largest = max(self.largest_each)
        self.exaggeration = plain_number(DRAWN_DISPLACEMENT * max(self.part.size) / (self.largest or 1.0))
        self.frame = np.vstack([self.part.nodes[shown]] + [(self.part.nodes + self.exaggeration * u)[shown]
                               for u in self.displacements])
        self.measured = spread(self.part.nodes, run.measured_nodes(), MOST_DOTS)
        images = [render_part.render(self.part, frame=self.frame,
                                     face_colours=render_part.layer_colours(self.part, layer, int(layer.max())))
                  for layer in (fields["planar/layer"], fields["layer"])]
        for displacement, length in zip(self.displacements, self.lengths):
            colours = render_part.scalar_colours(length, self.largest, render_part.DISPLACEMENT_COLOURS)
            images.append(render_part.render(self.part, frame=self.frame, node_colours=colours, ghost=True,
                                             offset=self.exaggeration * displacement, marked=self.measured))
        self.images = crop_together(images)
        self.aspect = self.images[0].shape[0] / self.images[0].shape[1]


def plain_number(value):
    """The largest 1, 2, 3 or 5 times a power of ten up to `value`."""
    power = 10.0 ** np.floor(np.log10(value))
    return max(step for step in (1.0, 2.0, 3.0, 5.0) if step * power <= value * (1 + 1e-9)) * power


def spread(points, chosen, most):
    """At most `most` of the nodes `chosen`, far from each other."""
    if len(chosen) <= most:
        return chosen
    picked = [0]
    distance = np.full(len(chosen), np.inf)
    while len(picked) < most:
        distance = np.minimum(distance, np.linalg.norm(points[chosen] - points[chosen[picked[-1]]], axis=1))
        picked.append(int(distance.argmax()))
    return chosen[picked]


def crop_together(images, margin=12):
    """The images without the white rim that all of them have."""
    rows, columns = np.nonzero(np.any([np.any(image < 250, axis=2) for image in images], axis=0))
    top, left = max(rows.min() - margin, 0), max(columns.min() - margin, 0)
    return [image[top:rows.max() + margin, left:columns.max() + margin] for image in images]


def write_title(sheet, run):
    planar, optimized, binary = (run.length(block) for block in ("baseline", "optimized", "binary"))
    name = run.name.replace("_", " ")
    title = f"{name[:1].upper()}{name[1:]}: distortion {compared(planar, binary)} than with planar layers"
    sheet.text(0.03, 0, 0.48, title, fontsize=min(22, 1500 / len(title)), weight="bold")
    how = dict(fontsize=11.5, color=SOFT_INK)
    start = f", not optimized {number(run.length('start'))}" if "start" in run.summary else ""
    sheet.text(0.03, 0, 0.90, f"Distortion ({run.measure()}): planar {number(planar)}{start}, optimized {number(binary)} "
               f"(with smooth layers {number(optimized)}).", **how)
    built = int((run.fields["density"] > 0).sum())
    unmet = "" if run.summary.get("feasible", True) else "  Not all constraints are satisfied."
    sheet.text(0.03, 0, 1.15, f"{built:,} elements, {len(run.layers('optimized'))} layers, "
               f"{run.summary['iterations']} iterations in {duration(run.summary['seconds']['total'])}.{unmet}", **how)


def compared(planar, other):
    return f"{factor(planar / other)} times smaller" if other <= planar else f"{factor(other / planar)} times larger"


def draw_pictures(sheet, run, pictures):
    lefts, width = (0.025, 0.260, 0.515, 0.750), 0.225
    kinds = ("planar", "optimized")
    labels = [f"{kind}, {len(run.layers(block))} layers" for kind, block in zip(kinds, ("baseline", "optimized"))]
    labels += [f"{kind}, displacement up to {number(length)}" for kind, length in zip(kinds, pictures.largest_each)]
    for left, image, label, colour in zip(lefts, pictures.images, labels, (PLANAR, OPTIMIZED, PLANAR, OPTIMIZED)):
        axes = sheet.axes(left, 2, width)
        axes.imshow(image)
        axes.set_axis_off()
        sheet.text(left + width / 2, 3, 0.18, label, ha="center", weight="bold", color=colour)
    sheet.text(0.03, 1, 0.20, "Layers, in the order they are built", fontsize=13, weight="bold")
    sheet.text(0.515, 1, 0.20, f"Distorted shape, drawn {pictures.exaggeration:g} times larger", fontsize=13, weight="bold")
    notes = ["grey: undistorted"] + ["dots: where distortion is measured"] * bool(len(pictures.measured))
    sheet.text(0.745, 3, 0.90, "      ".join(notes), ha="center", fontsize=10.5, color=SOFT_INK)
    legend(sheet, 0.165, render_part.LAYER_COLOURS, "built first", "built last")
    legend(sheet, 0.655, render_part.DISPLACEMENT_COLOURS, "displacement  0", number(pictures.largest))


def legend(sheet, left, colours, low, high):
    axes = sheet.axes(left, 3, 0.18, top=0.52, tall=0.14)
    axes.imshow(np.linspace(0, 1, 256)[None, :], aspect="auto", cmap=colours)
    axes.set_axis_off()
    sheet.text(left - 0.006, 3, 0.59, low, ha="right", fontsize=10.5, color=SOFT_INK)
    sheet.text(left + 0.186, 3, 0.59, high, ha="left", fontsize=10.5, color=SOFT_INK)


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


def plot_violation(axes, run):
    iterations = run.iterations
    percent = 100 * np.array([np.nan if line["worst_constraint"] is None else line["worst_constraint"] for line in run.history])
    axes.plot(iterations, percent, color=OPTIMIZED, linewidth=2)
    axes.set_yscale("symlog", linthresh=1.0, linscale=0.6)
    largest = np.nanmax(np.append(percent, 1.0))
    decades = [10.0**k for k in range(9) if 10.0**k < 5 * largest]
    axes.set_ylim(-10.0, max(5.0, 1.8 * largest))
    axes.set_yticks([-10, -1, 0] + decades)
    axes.yaxis.set_minor_locator(ticker.NullLocator())
    axes.yaxis.set_major_formatter(ticker.FuncFormatter(lambda value, _: f"{value:g} %"))
    axes.axhspan(-10, 0, color=ALLOWED, zorder=0)
    axes.text(0.99, 0.02, "satisfied", transform=axes.transAxes, ha="right", va="bottom", color=SOFT_INK)
    only_thickness = all(c["type"] == "layer_thickness" for c in run.config["constraints"])
    finish_over_iterations(axes, iterations, f"Worst violation of {'layer thickness' if only_thickness else 'a constraint'}")


def finish_over_iterations(axes, iterations, title, note=""):
    axes.set_xlabel("iteration")
    axes.set_xlim(iterations[0] - 0.5, max(iterations[-1], iterations[0] + 1) + 0.5)
    axes.xaxis.set_major_locator(ticker.MaxNLocator(6, integer=True))
    axes.grid(axis="y")
    heading(axes, title, note)


def plot_layers(axes, run):
    """Thickness of each layer, with its spread inside the layer and the band that is allowed."""
    constraint = run.thickness_constraint()
    total = len(run.summary["optimized"]["layers"])
    unit = constraint["target"] if constraint else 1.0
    for layer in run.layers("optimized"):
        if layer["thickness"] is None:
            continue
        value, j = layer["thickness"] / unit, layer["number"]
        spread_inside = value * (layer["cv"] or 0.0)
        axes.plot([j, j], [value - spread_inside, value + spread_inside], color=PALE, linewidth=3, solid_capstyle="round")
        axes.plot([j], [value], "o", markersize=9, markeredgecolor="white", zorder=3,
                  color=colormaps[render_part.LAYER_COLOURS]((j - 0.5) / total))
    if constraint:
        axes.axhspan(1 - constraint["tolerance"], 1 + constraint["tolerance"], color=ALLOWED, zorder=0)
    axes.set_xlabel("layer")
    axes.set_xlim(0.3, total + 0.7)
    axes.xaxis.set_major_locator(ticker.MaxNLocator(8, integer=True))
    axes.grid(axis="y")
    heading(axes, "Layer thickness / target" if constraint else "Layer thickness",
            ("green: allowed     " if constraint else "") + "bar: spread inside a layer")


def heading(axes, title, note=""):
    axes.set_title(title)
    axes.text(1.0, 1.0, note, transform=axes.transAxes, ha="right", va="bottom", fontsize=10, color=SOFT_INK)


def table(run):
    """The main figures of a run, planar beside optimized, as lines of text."""
    blocks = [block for block in ("baseline", "start", "optimized", "binary") if block in run.summary]
    names = {"baseline": "planar", "start": "start, binary", "optimized": "optimized, smooth", "binary": "optimized, binary"}
    constraint = run.thickness_constraint()
    unit = constraint["target"] if constraint else 1.0

    def span(block):
        values = [layer["thickness"] / unit for layer in run.layers(block) if layer["thickness"] is not None]
        return f"{min(values):.2f} .. {max(values):.2f}" if values else "-"

    rows = {"": (names[block] for block in blocks),
            "distortion": (f"{run.distortion(block):.3e}" for block in blocks),
            "length": (f"{run.length(block):.3e}" for block in blocks),
            "planar / this": (factor(run.length("baseline") / run.length(block)) for block in blocks),
            "largest displacement": (f"{run.summary[block]['displacement']['max']:.3e}" for block in blocks),
            "thickness" + " / target" * bool(constraint): map(span, blocks),
            "layers used": (len(run.layers(block)) for block in blocks)}
    lines = [f"{name:<22}" + "".join(f"{cell:>20}" for cell in cells) for name, cells in rows.items()]
    seconds = run.summary["seconds"]["total"]
    return "\n".join([*lines, f"{run.summary['iterations']} iterations, {seconds:.{0 if seconds >= 10 else 1}f} seconds"])


if __name__ == "__main__":
    run_script(main)
