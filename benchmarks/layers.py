#!/usr/bin/python3
"""Seconds of a layer's elastic solve, over the number of layers and of ranks:

    benchmarks/layers.sh configs/voxel_part.json [--layers 8 16 9 12] [--ranks 1 2] [-- OPTIONS OF THE PROGRAM]

Layers are solved in batches of eight lanes; what is left over, in narrower ones. Each run is a `-task simulate` from a cold start;
measured is its phase `primal`: loads, set-up and solve of every layer. Medians over the repetitions, which run by turns.
"""
import argparse
import os
import statistics
import sys
import tempfile

import program_run
from program_run import LANES, METHODS, method_options

LAYERS = [8, 16, 24, 32, 48, 9, 12, 17, 25]


def measure(options, layers, ranks, directory):
    arguments = ["-task", "simulate", "-layers", layers, *method_options(options.method, options.tolerance)]
    program_run.run(options, ranks, directory, arguments)
    return program_run.read_json(directory, "summary.json")["seconds"]["primal"]


def print_table(options, seconds):
    print(f"{'layers':>6s}" + "".join(f"{f'{r} rank' + ('s' if r > 1 else ''):>11s}{'a layer':>10s}" for r in options.ranks)
          + (f"{'speed-up':>10s}" if len(options.ranks) > 1 else ""))
    for layers in options.layers:
        of_ranks = [statistics.median(seconds[layers, ranks]) for ranks in options.ranks]
        line = "".join(f"{s:11.3f}{s / layers:10.4f}" for s in of_ranks)
        print(f"{layers:6d}{line}" + (f"{of_ranks[0] / of_ranks[-1]:10.2f}" if len(of_ranks) > 1 else ""))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    program_run.add_common_options(parser)
    parser.add_argument("--layers", type=int, nargs="+", default=LAYERS, metavar="N", help=f"default: {' '.join(map(str, LAYERS))}")
    parser.add_argument("--ranks", type=int, nargs="+", default=[1, 2], metavar="P", help="default: 1 2")
    parser.add_argument("--method", default=LANES, choices=METHODS, help="default: %(default)s")
    parser.add_argument("--tolerance", type=float, default=1e-5, metavar="T", help="default: %(default)s")
    options = program_run.parse(parser)
    seconds = {(layers, ranks): [] for layers in options.layers for ranks in options.ranks}
    bandwidth = [program_run.triad_bandwidth()]
    with tempfile.TemporaryDirectory() as directory:
        for _ in range(options.repetitions):
            for (layers, ranks), values in seconds.items():
                values.append(measure(options, layers, ranks, os.path.join(directory, "simulate")))
    bandwidth.append(program_run.triad_bandwidth())
    print(f"{os.path.basename(options.config)}, {options.method}, tolerance {options.tolerance:g}, {options.repetitions} repetitions, "
          f"{os.cpu_count()} cores, triad {bandwidth[0]:.1f} and {bandwidth[1]:.1f} GB/s a core before and after")
    print_table(options, seconds)
    if options.json:
        program_run.write_json(options.json, {
            "config": options.config, "arguments": sys.argv[1:], "method": options.method, "tolerance": options.tolerance,
            "triad": bandwidth, "runs": [{"layers": layers, "ranks": ranks, "primal_seconds": values}
                                         for (layers, ranks), values in seconds.items()]})


if __name__ == "__main__":
    main()
