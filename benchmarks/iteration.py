#!/usr/bin/python3
"""Seconds of a design iteration by phase, for one config and several solver methods in one run:

    benchmarks/iteration.py configs/voxel_part.json [--ranks 2] [--iterations 3] [--methods multigrid gamg] [--json FILE] [-- OPTIONS]

OPTIONS go to the program as they are. Medians over all iterations but the first (which sets up what later ones reuse), unless there is only one.
The limit printed beside them is memory bandwidth (a triad on the same ranks, before and after): these machines are noisy, so
compare figures of one run only.
"""
import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time

import numpy as np

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
PHASES = ["heat", "layers", "primal", "adjoint", "responses", "optimizer", "output", "total"]


def triad_bandwidth():
    """GB/s of a = b + s c on one core, best of five."""
    b, c = np.ones(8_000_000), np.ones(8_000_000)
    a = np.empty_like(b)
    best = 0.0
    for _ in range(5):
        start = time.perf_counter()
        np.multiply(c, 3.0, out=a)
        np.add(a, b, out=a)
        best = max(best, 5 * 8 * a.size / (time.perf_counter() - start) / 1e9)
    return best


def run(options, method, directory):
    environment = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1", OPENBLAS_NUM_THREADS="1",
                       OMPI_MCA_rmaps_base_oversubscribe="1")
    command = ["mpirun", "-np", str(options.ranks), options.program, "-config", options.config, "-output", directory, "-overwrite",
               "-max_iterations", str(options.iterations), "-set", f"solver.reference_method={method}",
               "-set", "output.every=0", "-set", "output.checkpoint_every=0", *options.rest]
    result = subprocess.run(command, env=environment, capture_output=True, text=True)
    if result.returncode != 0:
        sys.exit(f"{method}: status {result.returncode}: {result.stderr.strip().splitlines()[0]}")
    lines = [json.loads(line) for line in open(os.path.join(directory, "history.jsonl"))]
    lines = lines[1:] or lines
    solves = [len(line["solver_iterations"]["primal"]) + len(line["solver_iterations"]["adjoint"]) for line in lines]
    record = {phase: statistics.median(line["seconds"][phase] for line in lines) for phase in PHASES}
    record["seconds_a_solve"] = statistics.median(
        (line["seconds"]["primal"] + line["seconds"]["adjoint"]) / count for line, count in zip(lines, solves))
    record["iterations_primal"] = statistics.median(i for line in lines for i in line["solver_iterations"]["primal"])
    record["iterations_adjoint"] = statistics.median(i for line in lines for i in line["solver_iterations"]["adjoint"])
    record["solves"] = solves[-1]
    record["peak_memory_gigabytes"] = lines[-1]["peak_memory_bytes"] / 1e9
    return record


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("config")
    parser.add_argument("--ranks", type=int, default=2)
    parser.add_argument("--iterations", type=int, default=3)
    parser.add_argument("--methods", nargs="+", default=["multigrid", "gamg"], choices=["multigrid", "gamg", "direct"])
    parser.add_argument("--program", default=os.path.join(ROOT, "build/release/fabseq"))
    parser.add_argument("--json")
    parser.add_argument("rest", nargs="*")
    options = parser.parse_args()
    bandwidth = [triad_bandwidth()]
    with tempfile.TemporaryDirectory() as directory:
        results = {method: run(options, method, os.path.join(directory, method)) for method in options.methods}
    bandwidth.append(triad_bandwidth())
    print(f"{os.path.basename(options.config)}, {options.ranks} ranks, {options.iterations} iterations, {os.cpu_count()} cores, "
          f"triad {bandwidth[0]:.1f} and {bandwidth[1]:.1f} GB/s a core before and after")
    print(f"{'':24s}" + "".join(f"{method:>12s}" for method in results))
    for key in next(iter(results.values())):
        print(f"{key:24s}" + "".join(f"{record[key]:12.3f}" for record in results.values()))
    if options.json:
        json.dump({"config": options.config, "ranks": options.ranks, "triad": bandwidth, "methods": results}, open(options.json, "w"), indent=1)


if __name__ == "__main__":
    main()
