#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""How distortion depends on the number of layers and on the grid, by both deposition models.

    figures/deposition_convergence.py [--layers 5 10 20 40] [--grids 20,10,20 40,20,40]
                                              [--ranks N] [--output output/deposition] [--picture FILE.png]

The V-shape of configs/v_shape_coarse.json, in planar layers and optimized for either model, on each grid; a
run that is done is only looked at again. Prints a table and draws a figure: the rms displacement of the top
edge and of the whole part, both of binary layers.
"""

import json
import os

import needs_packages  # noqa: F401 (before any package)
from fabseq_tools.run.command_line import parse, parser_of, run_command, run_script
from fabseq_tools.run.places import PROGRAM, ROOT
from fabseq_tools.plot.drawing import OPTIMIZED, PLANAR, save, tidy

import matplotlib.pyplot as plt

from fabseq_tools.run.read_run import read_json

CONFIG = os.path.join(ROOT, "configs", "v_shape_coarse.json")
MODELS = "follow", "nominal"
HEIGHT = 2.5  # number of layers times their thickness


def main():
    parser = parser_of(__doc__)
    parser.add_argument("--layers", type=int, nargs="+", default=[5, 10, 20, 40])
    parser.add_argument("--grids", nargs="+", default=["20,10,20", "40,20,40"], help="elements, the first is the coarsest")
    parser.add_argument("--ranks", type=int, default=2)
    parser.add_argument("--output", default=os.path.join("output", "deposition"))
    parser.add_argument("--picture", default="deposition_convergence.png")
    parser.add_argument("--program", default=os.environ.get("FABSEQ_PROGRAM", PROGRAM))
    arguments = parse(parser)
    figures = {}
    for grid in arguments.grids:
        for count in arguments.layers:
            # One planar run has both models; of an optimization it is the binary layers of the best design.
            planar = summary(arguments, "planar", grid, count, "-task", "simulate",
                             "-set", 'sequence={"type": "planar"}')
            for model in MODELS:
                optimized = summary(arguments, model, grid, count, "-deposition", model, "-restart", "auto")
                figures["planar", model, grid, count] = numbers(planar, model)
                figures["optimized", model, grid, count] = numbers(optimized["binary"], model)
    print_table(arguments, figures)
    draw(arguments, figures)


def summary(arguments, name, grid, count, *options):
    """summary.json of a run, which is made unless it is done."""
    directory = os.path.join(arguments.output, f"{name}_{grid.replace(',', 'x')}_{count}")
    if not os.path.exists(os.path.join(directory, "summary.json")):
        target = [{"type": "layer_thickness", "target": HEIGHT / count, "tolerance": 0.1}]
        run_command(["mpirun", "-np", arguments.ranks, arguments.program, "-config", CONFIG,
                     "-elements", grid, "-layers", count,
                     "-set", "constraints=" + json.dumps(target), *options, "-output", directory], capture=False)
    return read_json(directory, "summary.json")


def numbers(block, model):
    """Root mean square of the top edge and of the whole part, length unit."""
    deposition = block["deposition"][model]
    return deposition["nodes"]["rms"], deposition["displacement"]["rms"]


def print_table(arguments, figures):
    print("| grid | sequence | model | " + " | ".join(f"N = {count}" for count in arguments.layers) + " |")
    print("| --- | --- | --- |" + " --- |" * len(arguments.layers))
    for grid in arguments.grids:
        for sequence in ("planar", "optimized"):
            for model in MODELS:
                cells = [" / ".join(f"{value:.4f}" for value in figures[sequence, model, grid, count])
                         for count in arguments.layers]
                print(f"| {grid.replace(',', '×')} | {sequence} | {model} | " + " | ".join(cells) + " |")


def draw(arguments, figures):
    figure, (*axes, beside) = plt.subplots(1, 3, figsize=(10.5, 3.6),
                                           layout="constrained", gridspec_kw={"width_ratios": (3, 3, 1.6)})
    tidy(axes)
    for number, (axis, title) in enumerate(zip(axes, ("top edge, rms", "whole part, rms"), strict=True)):
        for sequence, colour in (("planar", PLANAR), ("optimized", OPTIMIZED)):
            for model, line in (("follow", "--"), ("nominal", "-")):
                for index, grid in enumerate(arguments.grids):
                    values = [figures[sequence, model, grid, count][number] for count in arguments.layers]
                    axis.loglog(arguments.layers, values, line, color=colour, marker="os^"[index % 3], markersize=4,
                                alpha=1 if index else 0.55, label=f"{sequence}, {model}, {grid.replace(',', '×')}")
        axis.set(title=title, xlabel="number of layers")
        axis.set_xticks(arguments.layers, [str(count) for count in arguments.layers])
        axis.minorticks_off()
    beside.axis("off")
    beside.legend(*axes[0].get_legend_handles_labels(), loc="center left", fontsize=8, frameon=False)
    save(figure, arguments.picture, 150)


if __name__ == "__main__":
    run_script(main)
