#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Seconds of a run on an idle machine and beside busy processes, with ranks that spin while they wait for
each other, and with ranks that yield the core (Open MPI's mpi_yield_when_idle, set by environment.sh):

    benchmarks/busy_machine.py configs/demo.json [--ranks 1 2] [--busy 0 2] [-- OPTIONS OF THE PROGRAM]

Measured is the whole run, from the start of mpirun to its end. Figures are medians over the repetitions,
which run by turns.
"""
import contextlib
import itertools
import os
import subprocess
import sys
import tempfile
import time

import program_run

WAITING = ["spin", "yield"]


@contextlib.contextmanager
def busy_processes(count):
    """So many of them, on a core each as far as there are, within a with statement. Each has a session of
    its own, as another user's has, since Linux shares cores out by sessions first."""
    processes = [subprocess.Popen([sys.executable, "-c", "while True: pass"], start_new_session=True) for _ in range(count)]
    try:
        yield
    finally:
        for process in processes:
            process.kill()
            process.wait()


def measure(options, ranks, busy, waiting, directory):
    environment = {**os.environ, "OMPI_MCA_mpi_yield_when_idle": str(WAITING.index(waiting))}
    with busy_processes(busy):
        start = time.perf_counter()
        program_run.run(options, ranks, directory, [], env=environment)
        return [{"seconds": time.perf_counter() - start}]


def print_table(seconds):
    print(f"{'ranks':>5s}{'busy':>6s}" + program_run.heads(WAITING, 9) + f"{'spin / yield':>14s}")
    for ranks, busy in dict.fromkeys((ranks, busy) for ranks, busy, _ in seconds):
        of_row = {waiting: seconds[ranks, busy, waiting] for waiting in WAITING}
        print(f"{ranks:5d}{busy:6d}" + program_run.cells(of_row, WAITING, "9.1f") + f"{of_row['spin'] / of_row['yield']:14.2f}")


def parse_arguments():
    parser = program_run.common_parser(__doc__)
    parser.add_argument("--ranks", type=int, nargs="+", default=[1, 2], metavar="P", help="default: 1 2")
    parser.add_argument("--busy", type=int, nargs="+", default=[0, 2], metavar="B",
                        help="busy processes beside the run (default: 0 2)")
    return program_run.parse(parser)


def main():
    options = parse_arguments()
    with tempfile.TemporaryDirectory() as directory:
        output = os.path.join(directory, "output")
        samples, machine = program_run.by_turns(options, list(itertools.product(options.ranks, options.busy, WAITING)),
                                                lambda run: measure(options, *run, output))
    seconds = {run: program_run.medians(of_run)["seconds"] for run, of_run in samples.items()}
    print(f"{options.title}, {options.repetitions} repetitions, {program_run.machine_text(machine)}; seconds of a run")
    print_table(seconds)
    runs = [{"ranks": ranks, "busy": busy, "waiting": waiting, "seconds": seconds[ranks, busy, waiting],
             "samples": [sample["seconds"] for sample in of_run]} for (ranks, busy, waiting), of_run in samples.items()]
    program_run.write_results(options, {"machine": machine, "runs": runs})


if __name__ == "__main__":
    program_run.run_script(main)
