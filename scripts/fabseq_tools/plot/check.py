# SPDX-License-Identifier: MIT
"""Draws what -task check -picture saw: elements by their first layers, plate and node sets.

    fabseq-tools plot-check OUTPUT_DIR [--picture FILE]

The picture goes to OUTPUT_DIR/check.svg unless said otherwise. `fabseq -task check -picture` calls this
itself. Solids are seen from the front, the right and above, two-dimensional parts from the front. Where there
are more than 72 elements along an axis, several are drawn as one: the layer is then the last of theirs.
Reads check.h5.
"""

import os

import h5py
import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.colors import LinearSegmentedColormap, to_hex
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from fabseq_tools.plot.drawing import INK, SOFT_INK, draw_directory
from fabseq_tools.plot.voxel_view import Box, faces_of_cells, side
from fabseq_tools.run.command_line import RunError

COMMAND = "plot-check"

MOST_CELLS = 72  # along an axis
PLATE, SUBSTRATE = "#d8d2c4", "#b8b8b8"
NODE_SETS = ["#111111", "#c2185b", "#00695c", "#5d4037", "#283593"]
EARLY_TO_LATE = LinearSegmentedColormap.from_list("layers", ["#29388c", "#21789e", "#38a878", "#a8cc45", "#fae045"])


class Check:
    """What check.h5 holds. `content` of the cells that are drawn, [x][y][z]: 0 for nothing, 1 for the
    substrate, 1 + j for layer j."""

    def __init__(self, path):
        with opened(path) as file:
            missing = {"layer", "substrate", "spacing"} - set(file)
            if missing:
                raise RunError(f"{path} holds no {', '.join(sorted(missing))}: it is not of -task check -picture")
            layer, substrate = file["layer"][...], file["substrate"][...]
            self.name, self.unit, self.plate = (str(file.attrs[key]) for key in ("name", "unit", "plate"))
            self.spacing = file["spacing"][...]
            self.node_sets = [(name, int(file.attrs[f"node_sets/{name}"]), nodes[...])
                              for name, nodes in file.get("node_sets", {}).items()]
        self.elements = layer.shape[::-1]
        self.block = (max(self.elements) - 1) // MOST_CELLS + 1
        self.content = joined(np.where(substrate > 0, 1, np.where(layer > 0, layer + 1, 0)).T.astype(int), self.block)
        self.layers = max(self.content.max() - 1, 0)

    def colours(self):
        """Of each content from 1 on."""
        layers = [EARLY_TO_LATE((layer - 0.5) / self.layers) for layer in range(1, self.layers + 1)]
        return [to_hex(colour) for colour in [SUBSTRATE, *layers]]

    def title(self):
        blocks = f", drawn in blocks of {self.block}" if self.block > 1 else ""
        return f"{self.name}: [{','.join(map(str, self.elements))}] elements{blocks}"

    def size(self):
        edges = " × ".join(f"{count * edge:g}" for count, edge in zip(self.elements, self.spacing))
        return f"box {edges} {self.unit}".rstrip()

    def legend(self):
        """Colour and words of each line."""
        colours = self.colours()
        yield PLATE, f"build plate {self.plate}"
        if (self.content == 1).any():
            yield SUBSTRATE, "substrate"
        if self.layers:
            yield colours[1], "layer 1 of the start design"
        if self.layers > 1:
            yield colours[-1], f"layer {self.layers}"
        for colour, (name, count, _) in zip(cycled(NODE_SETS, self.node_sets), self.node_sets):
            yield colour, f"node set {name}, {count} nodes"


def opened(path):
    try:
        return h5py.File(path, "r")
    except OSError as error:  # does not name it
        raise RunError(f"{path}: {error}") from error


def cycled(colours, of):
    return [colours[number % len(colours)] for number in range(len(of))]


def joined(content, block):
    """The largest value of each block of elements."""
    content = np.pad(content, [(0, -count % block) for count in content.shape])
    for axis, count in enumerate(content.shape):
        blocks = (*content.shape[:axis], count // block, block, *content.shape[axis + 1:])
        content = content.reshape(blocks).max(axis=axis + 1)
    return content


def draw(check):
    box = Box(check.content.shape, check.spacing)
    figure = Figure(figsize=(10.0, 6.4))
    axis = figure.add_axes([0.02, 0.04, 0.68, 0.84])
    axis.set_aspect("equal")
    axis.set_axis_off()
    plate = [box.project(side(check.content.shape, "xyz".index(check.plate[0]), check.plate[1] == "+"))]
    axis.add_collection(PolyCollection(plate, facecolors=PLATE, edgecolors=PLATE, linewidths=6.0 if box.flat else 0.3,
                                       gid="plate", clip_on=False))
    corners, colours = faces_of_cells(check.content, check.colours())
    if len(corners):
        axis.add_collection(PolyCollection(box.project(corners), facecolors=colours, edgecolors=colours, linewidths=0.3,
                                           joinstyle="round", gid="cells", clip_on=False))
    for colour, (_, _, nodes) in zip(cycled(NODE_SETS, check.node_sets), check.node_sets):
        axis.plot(*box.project(nodes / check.block).T, "o", color=colour, ms=3, mew=0, gid="nodes", clip_on=False)
    axis.autoscale_view()
    handles = [Patch(color=colour, label=words) for colour, words in check.legend()]
    figure.legend(handles=handles, loc="upper left", bbox_to_anchor=(0.71, 0.90), frameon=False, fontsize=9,
                  handlelength=1.0, handleheight=1.0)
    figure.text(0.03, 0.94, check.title(), fontsize=13, color=INK)
    figure.text(0.03, 0.905, check.size(), fontsize=9, color=SOFT_INK)
    return figure


def main(words):
    draw_directory(words, __doc__, COMMAND, "check.svg", lambda directory: draw(Check(os.path.join(directory, "check.h5"))), 100)
