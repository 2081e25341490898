#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Whether lanes and reference path find the same displacements, layer by layer, temperatures and gradients:

    benchmarks/agreement.py configs/v_shape_coarse.json --ranks 1 2 3 4 [-- OPTIONS OF THE PROGRAM]
    benchmarks/agreement.py configs/v_shape_coarse.json --wavy 0.3 -- -beta 200

Largest relative differences over all layers, of fields in the maximum norm, of layers' displacements in the
2-norm over all nodes. The reference is solved once, on two ranks. With --wavy A the layers are not those of
the config's first design but cut from a height with waves of that amplitude, rescaled to 0 to 1.
"""
import json
import os
import tempfile

import h5py
import numpy as np

import program_run
from program_run import LANES, REFERENCES


def wavy_time(config, amplitude):
    """[z][y][x] (2D: [y][x]), 0 to 1 over the box."""
    axes = [(np.arange(n) + 0.5) / n for n in config["domain"]["elements"]]
    center = np.meshgrid(*axes[::-1], indexing="ij")[::-1]
    height = center[-1] + amplitude * np.prod([np.sin(2 * np.pi * (2 + axis) * x) for axis, x in enumerate(center[:-1])], axis=0)
    return (height - height.min()) / (height.max() - height.min())


def write_wavy(options, directory):
    """Options of the program that take the wavy layers from a file."""
    config = program_run.resolved_config(options, os.path.join(directory, "config"))
    path = os.path.join(directory, "time.h5")
    with h5py.File(path, "w") as file:
        file["time"] = wavy_time(config, options.wavy)
    changes = {"sequence": {"type": "file", "file": path, "dataset": "time"},
               "objective": config["objective"][:1], "constraints": []}
    return [word for key, value in changes.items() for word in ("-set", f"{key}={json.dumps(value)}")]


def solve(options, method, ranks, directory, wavy):
    """Temperature (if there is one), displacement after every layer, norms of the layers' displacements; and
    gradients, unless the layers are wavy."""
    solver = ["-layer_groups", 1, *program_run.method_options(method, options.tolerance)]
    program_run.run(options, ranks, directory, ["-task", "simulate", "-set", "output.stages=true", *wavy, *solver])
    found = program_run.read_fields(os.path.join(directory, "result.h5"))
    if wavy:
        return found, {}
    program_run.run(options, ranks, directory, ["-task", "evaluate", *solver])
    return found, program_run.read_fields(os.path.join(directory, "gradients.h5"))


def difference(found, correct):
    return np.abs(found - correct).max() / max(np.abs(correct).max(), 1e-300)


def compare(found, gradients, correct, correct_gradients):
    norms, stages = "layer_displacement_norms", "stages/displacement"
    record = {"each stage": max(difference(*pair) for pair in zip(found[stages], correct[stages], strict=True)),
              "layers' norms": float(np.max(np.abs(found[norms] - correct[norms]) / np.maximum(correct[norms], 1e-300))),
              "displacement": difference(found["displacement"], correct["displacement"])}
    if "temperature" in correct:
        record["temperature"] = difference(found["temperature"], correct["temperature"])
    if correct_gradients:
        record["gradients"] = max(difference(gradients[name], correct_gradients[name]) for name in correct_gradients)
    return record


def main():
    parser = program_run.common_parser(__doc__)
    parser.add_argument("--ranks", type=int, nargs="+", default=[2], metavar="P", help="of the lanes (default: 2)")
    parser.add_argument("--tolerance", type=float, default=1e-9, metavar="T", help="of both (default: %(default)s)")
    parser.add_argument("--reference", choices=REFERENCES, default="multigrid",
                        metavar="METHOD", help="default: %(default)s; direct where it fits")
    parser.add_argument("--wavy", type=float, metavar="A", help="amplitude, of the box's height; no gradients then")
    options = program_run.parse(parser)
    results = {}
    with tempfile.TemporaryDirectory() as directory:
        wavy = write_wavy(options, directory) if options.wavy is not None else []
        output = os.path.join(directory, "run")
        correct = solve(options, options.reference, 2, output, wavy)
        for ranks in options.ranks:
            results[ranks] = compare(*solve(options, LANES, ranks, output, wavy), *correct)
            print(f"{options.title}, {len(correct[0]['layer_displacement_norms'])} layers, {options.reference} at "
                  f"{options.tolerance:g}, lanes on {ranks}: "
                  + ", ".join(f"{key} {value:.1e}" for key, value in results[ranks].items()), flush=True)
    if options.json:
        program_run.write_json(options.json, results)


if __name__ == "__main__":
    program_run.run_script(main)
