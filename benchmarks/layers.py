#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Seconds of a layer over the number of layers: of its elastic solve on one and two ranks, or by phase.

    benchmarks/layers.py configs/voxel_part.json [--layers 8 16 9 12] [--ranks 1 2] [-- OPTIONS]
    benchmarks/layers.py benchmarks/v_shape.json --phases [--layers 5 10 25] [--ranks 2] [--csv FILE] [--plot
    FILE]

Without --phases each run is a `-task simulate` from a cold start; measured is its phase `primal`: loads,
set-up and solve of every layer, in batches of eight lanes and what is left over in narrower ones.

With --phases each run is an optimization of a few iterations, beside the figures of table 4 of Di Girolamo
2024 (N = 25, 16 cores). Thickness constraints have as target the config's times its number of layers by N, so
that the layers fit into the part.

Medians over the repetitions, which run by turns, and over the iterations after the warm-up.
"""
import os
import tempfile

import program_run
from program_run import LANES, METHODS, PHASES, method_options

LAYERS = [8, 16, 24, 32, 48, 9, 12, 17, 25]
LAYERS_BY_PHASE = [5, 8, 10, 15, 16, 20, 24, 25, 30, 32, 40, 48]
# Seconds of an iteration of the V-shape, 80 x 40 x 80, N = 25, on 16 cores (Di Girolamo 2024, table 4); heat:
# primal and adjoint; responses: layer thickness control.
PUBLISHED_LAYERS = 25
PUBLISHED = {"heat": 0.078 + 2.482, "primal": 28.508, "adjoint": 63.006, "responses": 0.135, "optimizer": 37.117}


def measure(options, layers, ranks, targets, directory):
    """Of each iteration after the warm-up; without targets, of a simulation."""
    arguments = ["-layers", layers, *method_options(options.method, options.tolerance)]
    if targets:
        return program_run.time_iterations(options, ranks, directory, [*arguments, *targets(layers)])
    program_run.run(options, ranks, directory, ["-task", "simulate", *arguments])
    return [{"primal": program_run.read_json(directory, "summary.json")["seconds"]["primal"]}]


def fitting_targets(config, count):
    """Options that keep N times the thickness target what it is in the config, which has `count` layers, for
    any number of layers N."""
    targets = {i: c["target"] * count for i, c in enumerate(config.get("constraints", []))
               if c["type"] == "layer_thickness"}
    return lambda layers: [word for i, height in targets.items()
                           for word in ("-set", f"constraints.{i}.target={height / layers:.12g}")]


def print_primal(options, seconds):
    several = len(options.ranks) > 1
    print(f"{'layers':>6s}" + "".join(f"{f'{r} rank' + 's' * (r > 1):>11s}{'per layer':>10s}" for r in options.ranks)
          + (f"{'speed-up':>10s}" if several else ""))
    for layers in options.layers:
        of_ranks = [seconds[layers, ranks]["primal"] for ranks in options.ranks]
        print(f"{layers:6d}" + "".join(f"{s:11.3f}{s / layers:10.4f}" for s in of_ranks)
              + (f"{of_ranks[0] / of_ranks[-1]:10.2f}" if several else ""))


def print_phases(seconds):
    print("seconds per layer")
    print(f"{'layers':>9s}{'ranks':>6s}" + program_run.heads(PHASES, 11))
    for name, layers, ranks, values in [*((layers, layers, ranks, values) for (layers, ranks), values in seconds.items()),
                                        (f"[D24] {PUBLISHED_LAYERS}", PUBLISHED_LAYERS, 16, PUBLISHED)]:
        per_layer = {phase: value / layers for phase, value in values.items()}
        print(f"{name:>9}{ranks:6d}" + program_run.cells(per_layer, PHASES, "11.5f"))


def plot(path, title, seconds):
    most = max(ranks for _, ranks in seconds)
    runs = sorted((layers, values) for (layers, ranks), values in seconds.items() if ranks == most)
    with program_run.figure(path, title, figsize=(8, 5)) as axes:
        for phase in PHASES[:-2]:
            points = [(layers, values[phase] / layers) for layers, values in runs if values[phase] > 0]
            if not points:
                continue
            line, = axes.semilogy(*zip(*points), "-o", label=f"{phase}, {most} rank{'s' * (most > 1)}", markersize=4)
            if phase in PUBLISHED:
                published = PUBLISHED[phase] / PUBLISHED_LAYERS
                axes.semilogy([PUBLISHED_LAYERS], [published], "*", color=line.get_color(), markersize=11)
        axes.semilogy([], [], "k*", markersize=11, label="Di Girolamo 2024, table 4: V-shape, 16 cores")
        axes.set(xlabel="number of layers N", ylabel="seconds of an iteration, per layer")


def parse_arguments():
    parser = program_run.common_parser(__doc__)
    parser.add_argument("--phases", action="store_true", help="all phases of an iteration, per layer")
    parser.add_argument("--layers", type=int, nargs="+", metavar="N",
                        help=f"default: {' '.join(map(str, LAYERS))}; with --phases: {' '.join(map(str, LAYERS_BY_PHASE))}")
    parser.add_argument("--ranks", type=int, nargs="+", metavar="P", help="default: 1 2; with --phases: 2")
    parser.add_argument("--method", default=LANES, choices=METHODS, help="default: %(default)s")
    parser.add_argument("--tolerance", type=float, default=1e-5, metavar="T", help="default: %(default)s")
    options = program_run.parse_iterations(parser, "with --phases: ", "run and phase")
    if not options.phases and (options.csv or options.plot):
        parser.error("--csv, --plot: only with --phases")
    options.layers = options.layers or (LAYERS_BY_PHASE if options.phases else LAYERS)
    options.ranks = options.ranks or ([2] if options.phases else [1, 2])
    return options


def main():
    options = parse_arguments()
    with tempfile.TemporaryDirectory() as directory:
        output = os.path.join(directory, "output")
        targets = None
        if options.phases:
            targets = fitting_targets(program_run.resolved_config(options, os.path.join(directory, "settings")),
                                      program_run.problem_size(options, directory)["layer_count"])
        samples, machine = program_run.by_turns(
            options, [(layers, ranks) for layers in options.layers for ranks in options.ranks],
            lambda run: measure(options, *run, targets, output))
    seconds = {run: program_run.medians(of_run) for run, of_run in samples.items()}
    title = f"{options.title}, {options.method}, tolerance {options.tolerance:g}"
    print(f"{title}, {options.repetitions} repetitions, {program_run.machine_text(machine)}")
    if options.phases:
        print_phases(seconds)
    else:
        print_primal(options, seconds)
    rows = [{"layers": layers, "ranks": ranks, "phase": phase, "seconds": values[phase],
             "seconds_per_layer": values[phase] / layers}
            for (layers, ranks), values in seconds.items() for phase in PHASES if phase in values]
    runs = [{"layers": layers, "ranks": ranks, "samples": of_run} for (layers, ranks), of_run in samples.items()]
    record = {"method": options.method, "tolerance": options.tolerance, "machine": machine, "table": rows, "runs": runs}
    program_run.write_results(options, record, rows, lambda path: plot(path, title, seconds))


if __name__ == "__main__":
    program_run.run_script(main)
