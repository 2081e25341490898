# SPDX-License-Identifier: MIT
"""Writes the simulation of a run as decks for CalculiX (ccx), another solver.

    fabseq-tools calculix RUN_DIR [--layer j] [--output DIR]

RUN_DIR is the output directory of an optimization or a simulation; its binary layers are taken. Three decks
are written into DIR (default: RUN_DIR/calculix):

    layer_0007.inp          the step of layer 7 (default: of the last one): what the strain of the
                            layer does to what is built by then
    finished.inp            the whole part, with the strains of all its elements at once, on the plate
    finished_released.inp   the same with the plate gone, held at three nodes (in 2D two) that take no
                            force; not for a part that falls apart without its plate

The bricks are those of the simulation, and nodes and elements have its numbers, from 1. Nodes lie where the
part was drawn: in the coordinates of its mesh file if it has one. The inherent strain is the expansion under
a temperature of 1. Run `ccx -i DIR/layer_0007`, and compare with `fabseq-tools
compare-calculix`.
"""

import itertools
import os

import numpy as np
from scipy import ndimage

from fabseq_tools.calculix.deck import write_deck
from fabseq_tools.calculix.layer_model import LayerModel
from fabseq_tools.geometry.grid import nodes_of
from fabseq_tools.geometry.placement import Placement
from fabseq_tools.geometry.rigid_motions import rigid_motions
from fabseq_tools.run.command_line import RunError, count, parser_of

COMMAND = "calculix"


def main(words):
    parser = parser_of(__doc__, COMMAND)
    parser.add_argument("directory", metavar="RUN_DIR")
    parser.add_argument("--layer", type=count, metavar="j", help="layer whose step is written, from 1 (default: the last)")
    parser.add_argument("--output", metavar="DIR", help="(default: RUN_DIR/calculix)")
    arguments = parser.parse_args(words)
    for path in export(arguments.directory, arguments.layer, arguments.output or os.path.join(arguments.directory, "calculix")):
        print(path)


def export(directory, layer, output):
    """Writes the decks, and returns their paths."""
    model = LayerModel(directory)
    layer = model.layers if layer is None else layer
    if not 1 <= layer <= model.layers or not (model.layer == layer).any():
        raise RunError(f"--layer: found {layer}; allowed: a layer from 1 to {model.layers} that holds an element")
    os.makedirs(output, exist_ok=True)
    held = [(model.supports, 0, 2)]
    decks = {f"layer_{layer:04d}": (layer, layer, held, f"step of layer {layer} of {model.layers}"),
             "finished": (1, model.layers, held, "finished part, all strains at once, on the plate")}
    if ndimage.label(model.solid)[1] <= 1:
        decks["finished_released"] = (1, model.layers, free_supports(model),
                                      "finished part, all strains at once, without the plate, held at nodes that take no force")
    paths, placement = [], Placement(model.config)
    for name, (first, last, fixed, what) in decks.items():
        paths.append(os.path.join(output, name + ".inp"))
        title = [f"fabseq, {' '.join(model.config.get('name', 'part').split())}: {what}.",
                 "Nodes and elements have the numbers of result.h5, from 1, x fastest.",
                 f"Coordinates are {placement.system}{f', in {placement.unit}' if placement.unit else ''}."]
        write_step(paths[-1], title, model, first, last, fixed)
    return paths


def write_step(path, title, model, first, last, fixed):
    nodes, turn = model.drawn_positions(), model.way_back()[0]
    corners, strain = model.corners(), model.strain(first, last)[model.there]
    strain = turn @ strain @ turn.T
    plane = model.dimension == 2
    if plane:  # a slab: its back has the nodes' numbers plus their number
        back = np.full((len(nodes), 1), model.config["domain"].get("thickness", 1.0))
        nodes = np.concatenate([np.pad(nodes, ((0, 0), (0, 1))), np.concatenate([nodes, back], axis=1)])
        fixed = [(both_sides(held, len(back)), low, min(high, 1)) for held, low, high in fixed]
        corners = np.concatenate([corners, corners + len(back)], axis=1)
        strain = np.pad(strain, ((0, 0), (0, 1), (0, 1)))
    bricks = (np.flatnonzero(model.there), corners)
    write_deck(path, title, nodes, bricks, model.stiffness(last)[model.there], strain, model.material["poisson"], plane, fixed)


def both_sides(nodes, count):
    return np.concatenate([nodes, nodes + count])


def free_supports(model):
    """Supports of three nodes of the part, in 2D two, that leave it no rigid motion and hold back no strain:
    one is held along all axes, the next ones along fewer."""
    numbers = np.flatnonzero(nodes_of(model.solid))
    points, dimension = model.drawn_positions()[numbers], model.dimension
    first = np.argmin(points.sum(axis=1))
    away = points - points[first]
    second = np.argmax((away**2).sum(axis=1))
    line = away[second] / np.linalg.norm(away[second])
    third = np.argmax(((away - np.outer(away @ line, line))**2).sum(axis=1))
    chosen = [first, second, third][:dimension]
    motions = rigid_motions(away[chosen] / np.abs(away).max())  # [motion][point][axis]
    all_axes, others = range(dimension), {2: ([0], [1]), 3: ([0, 1], [1, 2], [0, 2])}[dimension]
    ways = [[list(all_axes), *way] for way in itertools.product(others, *[[[a] for a in all_axes]] * (dimension - 2))]

    def stiffness(way):
        return abs(np.linalg.det(np.concatenate([motions[:, point, axes] for point, axes in enumerate(way)], axis=1)))

    best = max(ways, key=stiffness)
    return [(numbers[[chosen[point]]], axis, axis) for point, axes in enumerate(best) for axis in axes]
