#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Where a distortion comes from: the layer that builds a place, all later layers, and the release.

    figures/own_layer.py RUN... [--ranks N] [--output output/own_layer]

RUN is the output directory of an optimization at nominal positions. Its binary layers, those of the start
design and the planar baseline are simulated again, and the displacement is taken apart: the motion in the
layer that builds a place, the motion in all layers after it, and, for a distortion after the release, that of
the release. Prints the length of the first distortion term for their sum and for each alone. Takes
displacement, flatness and shape.
"""

import json
import os

import needs_packages  # noqa: F401 (before any package)
from fabseq_tools.run.command_line import RunError, parse, parser_of, run_command, run_script
from fabseq_tools.run.places import PROGRAM

import numpy as np

from fabseq_tools.geometry.grid import node_positions
from fabseq_tools.geometry.node_sets import nodes_of_set
from fabseq_tools.geometry.rigid_motions import rigid_motions
from fabseq_tools.run.read_run import Run, read_fields


def main():
    parser = parser_of(__doc__)
    parser.add_argument("runs", nargs="+", metavar="RUN")
    parser.add_argument("--ranks", type=int, default=2)
    parser.add_argument("--output", default=os.path.join("output", "own_layer"))
    parser.add_argument("--program", default=os.environ.get("FABSEQ_PROGRAM", PROGRAM))
    arguments = parse(parser)
    print("| case | sequence | length | own layer | later layers | release |\n| --- | --- | --- | --- | --- | --- |")
    for directory in arguments.runs:
        run = Run(directory)
        if run.distortion_config.get("measure", "displacement") not in ("displacement", "flatness", "shape"):
            raise RunError(f"{directory}: measures {run.distortion_config['measure']}")
        result = os.path.join(directory, "result.h5")
        nodes = nodes_of_set(run.fields, run.distortion_config["nodes"], result)
        sequences = {"planar": planar_words(run), "start": [], "binary": ["-design", result]}
        for sequence, words in sequences.items():
            motions = motions_of(simulated(arguments, directory, sequence, words), nodes,
                                 run.distortion_config.get("after_release", False))
            lengths = [length(run, nodes, motion) for motion in motions]
            name = os.path.basename(os.path.normpath(directory))
            print(f"| {name} | {sequence} | " + " | ".join(f"{value:.3g}" for value in lengths) + " |", flush=True)


def planar_words(run):
    layers = len(run.summary["baseline"]["layers"])
    sequence = {"type": "planar", "direction": run.config["baseline"]["direction"]}
    return ["-set", "sequence=" + json.dumps(sequence), "-layers", layers, "-set", "constraints=[]", "-set",
            "projection.max=auto"]


def simulated(arguments, directory, sequence, words):
    """The fields of a simulation with binary layers that keeps all stages."""
    output = os.path.join(arguments.output, os.path.basename(os.path.normpath(directory)), sequence)
    run_command(["mpirun", "-np", arguments.ranks, arguments.program, "-config", os.path.join(directory, "config.json"),
                 "-task", "simulate", "-binary", "-stages", *words, "-overwrite", "-output", output])
    return read_fields(os.path.join(output, "result.h5"))


def motions_of(fields, nodes, after_release):
    """Displacement of the nodes (n, dimension): all, in a node's own layer, later, of the release."""
    stages = np.array([stage.reshape(-1, stage.shape[-1])[nodes] for stage in fields["stages/displacement"]], dtype=float)
    moved = np.any(stages != 0.0, axis=2)
    own = np.take_along_axis(stages, np.argmax(moved, axis=0)[None, :, None], axis=0)[0]
    release = fields["release_displacement"].reshape(-1, stages.shape[-1])[nodes] if after_release else np.zeros_like(own)
    return stages[-1] + release, own, stages[-1] - own, release


def length(run, nodes, displacement):
    """Root of the first distortion term."""
    term = run.distortion_config
    measure = term.get("measure", "displacement")
    if measure == "displacement":
        squares = np.sum(displacement ** 2)
        return np.sqrt(squares / len(nodes) if term.get("mean") else squares)
    if measure == "flatness":
        return np.std(displacement[:, "xyz".index(term["axis"])])
    elements = run.fields["density"].shape[::-1]
    positions = node_positions(run.config["domain"]["size"], elements)[nodes]
    motions = fitted_motions(positions - positions.mean(axis=0), term.get("fit", ["translation", "rotation"]))
    rest = displacement.ravel() - motions @ np.linalg.lstsq(motions, displacement.ravel(), rcond=None)[0]
    return np.sqrt(np.sum(rest ** 2) / len(nodes))


def fitted_motions(arms, fit):
    """Columns: rigid motions, and a uniform scale, of nodes at so much from their centre."""
    motions, dimension = rigid_motions(arms), arms.shape[1]
    columns = {"translation": motions[:dimension], "rotation": motions[dimension:], "scale": arms[None]}
    return np.concatenate([columns[kind] for kind in columns if kind in fit]).reshape(-1, arms.size).T


if __name__ == "__main__":
    run_script(main)
