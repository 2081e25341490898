# SPDX-License-Identifier: MIT
"""Compares several optimizations, such as a parameter study, in one table and one figure.

    fabseq-tools compare OUTPUT_DIRECTORY... [--table compare.csv] [--picture compare.png] [--against KEY]

The table (CSV) has a line per run: the keys of the config in which the runs differ, how the run ended,
values, thickness and evenness of the layers, displacements, time and memory. A run that is not done has a
line without results.

The figure shows distortion, evenness within layers, and thickness and evenness of each layer, over the key in
which the runs differ; over their names, if it is not one key with numbers. KEY chooses one of several. Marks
are hollow where a constraint is violated.
"""

import itertools
import os

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.ticker import FixedLocator, MaxNLocator, NullLocator

from fabseq_tools.plot.drawing import ALLOWED, INK, OPTIMIZED, PLANAR, SOFT_INK, save, tidy
from fabseq_tools.run.command_line import RunError, parser_of, warn, write_rows
from fabseq_tools.run.read_run import Run, read_json
from fabseq_tools.run.settings import NOT_COMPARED, differing_keys, flat

COMMAND = "compare"

BLOCKS = {"optimized": ("smooth layers", OPTIMIZED), "binary": ("binary layers", INK),
          "baseline": ("planar layers", PLANAR)}
SPAN_FOR_LOG = 20.0


class Result:
    """One directory: `config`, `summary`, and `run` (None while there is no result)."""

    def __init__(self, directory):
        self.name = os.path.basename(os.path.normpath(directory))
        self.config = read_json(directory, "config.json")
        try:
            self.run = Run(directory, with_fields=False)
        except RunError as reason:
            warn(COMMAND, reason)
            self.run = None
        ended = os.path.exists(os.path.join(directory, "summary.json"))
        self.summary = read_json(directory, "summary.json") if ended else {}
        self.settings = {key: value for key, value in flat(self.config) if key.split(".")[0] not in NOT_COMPARED}

    def evenness(self, block):
        """Coefficient of variation of the thickness within layers, mean over the layers, by volume."""
        layers = [layer for layer in self.run.layers(block) if layer["cv"] is not None]
        volume = sum(layer["volume"] for layer in layers)
        return sum(layer["volume"] * layer["cv"] for layer in layers) / volume if volume else None


def row_of(result, keys):
    row = {"run": result.name, **{key: result.settings.get(key) for key in keys}}
    for key in ("status", "iterations", "best_iteration", "feasible", "worst_constraint", "beta"):
        row[key] = result.summary.get(key)
    for block in BLOCKS if result.run else ():
        row |= {f"{block}/{name}": value for name, value in block_columns(result, block).items()}
    row |= {"ranks": result.config.get("run", {}).get("ranks"),
            "seconds": result.summary.get("seconds", {}).get("total"),
            "peak_memory_bytes": result.summary.get("peak_memory_bytes")}
    return row


def block_columns(result, block):
    """Of the optimized sequence, the same with binary layers, or the planar baseline."""
    content = result.summary[block]
    columns = {r["name"]: r["value"] for r in content["responses"] if r["name"].startswith("objective")}
    layers = result.run.layers(block)
    thickness = [layer["thickness"] for layer in layers if layer["thickness"] is not None]
    columns["layers"] = len(layers)
    if thickness:
        columns |= {"thickness_min": min(thickness), "thickness_mean": float(np.mean(thickness)),
                    "thickness_max": max(thickness)}
    columns["cv"] = result.evenness(block)
    columns |= {f"displacement_{key}": content["displacement"][key] for key in ("max", "rms")}
    return columns


class Abscissa:
    """What the runs are drawn over: the values of a key, or their names. Sorts the runs."""

    def __init__(self, results, keys, wanted):
        if wanted and wanted not in keys:
            raise RunError(f"the runs do not differ in {wanted}; they do in: {', '.join(keys) or 'nothing'}")
        candidates = [wanted] if wanted else keys
        numeric = [key for key in candidates if all(type(r.settings.get(key)) in (int, float) for r in results)]
        self.key = numeric[0] if len(numeric) == 1 and (wanted or len(keys) == 1) else None
        self.results = sorted(results, key=lambda r: r.settings[self.key]) if self.key else list(results)
        self.values = [r.settings[self.key] for r in self.results] if self.key else list(range(len(results)))
        self.labels = [f"{value:g}" for value in self.values] if self.key else [r.name for r in self.results]

    def style(self, axis):
        if self.key and min(self.values) > 0 and max(self.values) > SPAN_FOR_LOG * min(self.values):
            axis.set_xscale("log")
        axis.xaxis.set_major_locator(FixedLocator(self.values))
        axis.xaxis.set_minor_locator(NullLocator())
        turn = not self.key and max(map(len, self.labels)) * len(self.labels) > 50
        axis.set_xticklabels(self.labels, rotation=30 if turn else 0, ha="right" if turn else "center")
        axis.set_xlabel(self.key or "")


def draw(abscissa):
    figure, axes = plt.subplots(2, 2, figsize=(11.0, 8.0), constrained_layout=True)
    (distortion, evenness), (thickness, variation) = axes
    draw_values(distortion, abscissa, BLOCKS, lambda result, block: result.run.distortion(block))
    distortion.set_ylabel(abscissa.results[0].run.measure())
    if all(result.run.distortion(block) > 0 for result in abscissa.results for block in BLOCKS):
        distortion.set_yscale("log")
    draw_values(evenness, abscissa, ("optimized", "binary"), Result.evenness)
    evenness.set_ylabel("variation of the thickness within a layer (cv),\nmean over the layers")
    draw_layers(thickness, abscissa, "thickness")
    thickness.set_ylabel("thickness of each layer (binary layers)")
    draw_layers(variation, abscissa, "cv")
    variation.set_ylabel("variation of the thickness within it (cv)")
    for axis in (evenness, variation):
        axis.set_ylim(bottom=0.0)
    tidy(axes.flat)
    for axis in axes[0]:
        axis.legend(frameon=False, fontsize=9)
    for axis in axes[1]:
        axis.legend(title=abscissa.key, frameon=False, fontsize=9, title_fontsize=9, alignment="left")
    return figure


def draw_values(axis, abscissa, blocks, value):
    for block in blocks:
        label, colour = BLOCKS[block]
        heights = [value(result, block) for result in abscissa.results]
        axis.plot(abscissa.values, heights, color=colour, ls="-" if abscissa.key else "none", lw=1.6, label=label)
        for x, y, result in zip(abscissa.values, heights, abscissa.results):
            filled = block == "baseline" or result.summary.get("feasible", True)
            if y is not None:
                axis.plot(x, y, "o", ms=7, mec=colour, mfc=colour if filled else "white", zorder=5)
    abscissa.style(axis)


def draw_layers(axis, abscissa, quantity):
    """A line per run over the layers' numbers; the thickness with the allowed range of the first run."""
    colours = plt.get_cmap("viridis")(np.linspace(0.0, 0.85, len(abscissa.results)))
    constraint = abscissa.results[0].run.thickness_constraint()
    if quantity == "thickness" and constraint:
        target, tolerance = constraint["target"], constraint["tolerance"]
        axis.axhspan(target * (1 - tolerance), target * (1 + tolerance), color=ALLOWED, zorder=0)
        axis.axhline(target, color=SOFT_INK, lw=1.0, ls="--")
    for result, label, colour in zip(abscissa.results, abscissa.labels, colours):
        layers = [layer for layer in result.run.layers("binary") if layer[quantity] is not None]
        axis.plot([layer["number"] for layer in layers], [layer[quantity] for layer in layers], "o-", ms=3.5, lw=1.3,
                  color=colour, label=label)
    axis.xaxis.set_major_locator(MaxNLocator(integer=True))
    axis.set_xlabel("layer")


def main(words):
    parser = parser_of(__doc__, COMMAND)
    parser.add_argument("directories", nargs="+", metavar="OUTPUT_DIRECTORY")
    parser.add_argument("--table", default="compare.csv", help="table to write (default: %(default)s)")
    parser.add_argument("--picture", default="compare.png", help="picture to write (default: %(default)s)")
    parser.add_argument("--against", metavar="KEY", help="key of the config to draw the runs over")
    arguments = parser.parse_args(words)
    results = [Result(directory) for directory in arguments.directories]
    keys = differing_keys(results)
    finished = [result for result in results if result.run]
    abscissa = Abscissa(finished, keys, arguments.against) if finished else None
    rows = [row_of(result, keys) for result in results]
    # Columns of the run itself last, also where the first line has no results.
    of_the_run = ("ranks", "seconds", "peak_memory_bytes")
    columns = sorted(dict.fromkeys(itertools.chain(*rows)), key=lambda name: name in of_the_run)
    write_rows(arguments.table, rows, columns)
    print(arguments.table)
    if not finished:
        raise RunError("none of the runs is done: no picture")
    save(draw(abscissa), arguments.picture, 120)
