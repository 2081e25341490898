# SPDX-License-Identifier: MIT
"""Compares displacements that CalculiX has found with those of fabseq.

    fabseq-tools compare-calculix RUN_DIR FILE.dat [--tolerance 1e-5]

RUN_DIR is the output directory of `-task simulate` with binary layers, and FILE.dat what ccx has written for
a deck of `fabseq-tools calculix`:

    layer_0007.dat          needs `-stages`: the displacement after layer 7 less that after layer 6
    finished.dat            needs a simulation of the whole part as one layer (`-set layers.count=1`)
    finished_released.dat   the same, after the release; compared after the best rigid fit

Prints the largest displacement and the largest difference. The status is 1 if their ratio exceeds the
tolerance.
"""

import os
import re

import numpy as np

from fabseq_tools.calculix.layer_model import LayerModel
from fabseq_tools.geometry.grid import nodes_of
from fabseq_tools.geometry.rigid_motions import without_rigid_motion
from fabseq_tools.run.command_line import RunError, parser_of, positive
from fabseq_tools.run.words import number

COMMAND = "compare-calculix"


def main(words):
    parser = parser_of(__doc__, COMMAND)
    parser.add_argument("directory", metavar="RUN_DIR")
    parser.add_argument("file", metavar="FILE.dat")
    parser.add_argument("--tolerance", type=positive, default=1e-5, help="of the ratio (default: %(default)g)")
    arguments = parser.parse_args(words)
    nodes, largest, difference = compare(arguments.directory, arguments.file)
    ratio = difference / largest
    print(f"{nodes:,} nodes, largest displacement {number(largest)}, largest difference {number(difference)}, ratio {ratio:.1e}")
    if not ratio <= arguments.tolerance:
        raise RunError(f"{arguments.file}: the ratio exceeds {arguments.tolerance:g}")


def compare(directory, path):
    """How many nodes are compared, the largest displacement and the largest difference, in the config's
    unit."""
    model = LayerModel(directory)
    name = os.path.splitext(os.path.basename(path))[0]
    expected, nodes = expected_displacement(model, name)
    turn, factor, _ = model.way_back()
    found = read_displacements(path, len(model.positions))[:, :model.dimension] @ turn / factor
    difference = (found - expected)[nodes]
    if np.isnan(difference).any():
        raise RunError(f"{path}: lacks displacements of the nodes of {model.path}; was the deck made of another run?")
    if name == "finished_released":
        difference = without_rigid_motion(difference, model.positions[nodes])
    return len(nodes), np.linalg.norm(expected[nodes], axis=1).max(), np.linalg.norm(difference, axis=1).max()


def expected_displacement(model, name):
    """fabseq's displacement for a deck, (node, axis), and the numbers of the nodes that both have: of what is
    built, since places that are not built yet may count no motion."""
    solid = np.flatnonzero(nodes_of(model.solid))
    found = re.fullmatch(r"layer_(\d+)", name)
    if found:
        layer = int(found[1])
        stages = model.needed("stages/displacement", "simulate with -stages").astype(float)
        if model.config["sequence"]["type"] != "planar" and not model.config["projection"]["binary"]:
            raise RunError(f"{model.path}: its layers are smooth, the deck's are binary; simulate with -binary")
        if not 1 <= layer <= len(stages):
            raise RunError(f"{name}: found layer {layer}; allowed: 1 to {len(stages)}, as many as {model.path} has")
        step = stages[layer - 1] - (stages[layer - 2] if layer > 1 else 0.0)
        built = model.solid & (model.layer <= layer)
        return step.reshape(-1, model.dimension), np.flatnonzero(nodes_of(built))
    if name not in ("finished", "finished_released"):
        raise RunError(f"{name}: allowed: layer_ and a number, finished, finished_released")
    if model.layers != 1:
        raise RunError(f"{model.path}: has {model.layers} layers, the deck one; simulate with -set layers.count=1")
    displacement = model.needed("displacement", "simulate again")
    if name == "finished_released":
        displacement = displacement + model.needed("release_displacement", "a part that falls apart without its plate has none")
    return displacement.reshape(-1, model.dimension), solid


def read_displacements(path, count):
    """Displacements (count, 3) that *NODE PRINT has left; NaN for nodes that have none."""
    values = np.full((count, 3), np.nan)
    with open(path, encoding="ascii", errors="replace") as file:
        for place, line in enumerate(file, 1):
            words = line.split()
            if len(words) == 4 and words[0].isdigit() and 1 <= int(words[0]) <= count:
                found = [fortran_number(word) for word in words[1:]]
                if not np.isfinite(found).all():
                    raise RunError(f"{path}, line {place}: found {' '.join(words[1:])}; allowed: three numbers")
                values[int(words[0]) - 1] = found
    return values


def fortran_number(word):
    """The number in a word that Fortran has written: exponents of three digits stand there without their E.
    NaN for what is no number."""
    found = re.fullmatch(r"([-+]?(?:\d+\.?\d*|\.\d+))(?:[EeDd]?([-+]\d+)|[EeDd](\d+))?", word)
    return float(f"{found[1]}e{found[2] or found[3] or 0}") if found else np.nan
