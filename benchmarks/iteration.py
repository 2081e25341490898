#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Seconds of a design iteration by phase, of one config with several solvers in one go:

    benchmarks/iteration.py configs/voxel_part.json --ranks 2 --json voxel_part.json [-- OPTIONS OF THE
    PROGRAM]

Each reference method has the tolerance that gives its displacement the same true error as the lanes' unless
--reference-tolerance names one. Figures are medians over the repetitions, which run by turns, of medians over
the iterations but the first (unless there is only one). docs/developer/measuring.md explains them. Beside
them stand the cores, how busy they were before, and memory bandwidth (a triad, one core) before and after:
compare figures of one run only.
"""
import itertools
import math
import os
import statistics
import tempfile

import numpy as np

import program_run
from program_run import LANES, METHODS, PHASES, REFERENCES, RunError, method_options

COMPARED = [*PHASES, "seconds_per_solve", "peak_memory_gigabytes"]
TIGHT = 1e-11
# Two errors this close to each other count as equal: one CG iteration more or less is about that.
CLOSE = 1.5
TRIES = 4
# Below this, differences may be the exact solve's own error.
SMALLEST = 1e-9


class DisplacementErrors:
    """True errors of the displacement, and the tolerance that gives a reference method the lanes' error.

    A solver stops at a relative residual that its own preconditioner measures, so that a tolerance means
    different errors with different solvers. Displacements after the last layer, of `-task simulate`, are
    compared with those of a tight solve by the method `exact`: |u - u_exact| / |u_exact| over all nodes.
    """

    def __init__(self, options, directory, exact):
        self.options, self.directory, self.exact = options, directory, exact
        self.found = {}  # by method and tolerance
        self.expected = self.displacement(exact, TIGHT)

    def displacement(self, method, tolerance):
        output = os.path.join(self.directory, "simulate")
        layers = ["-layers", self.options.error_layers] if self.options.error_layers else []
        arguments = ["-task", "simulate", *layers, *method_options(method, tolerance)]
        path = os.path.join(output, "result.h5")
        try:
            program_run.run(self.options, self.options.ranks, output, arguments)
        except RunError:  # of the release, which comes last, at a tight tolerance; the displacement is there by then
            if not os.path.exists(path):
                raise
        result = program_run.read_fields(path)["displacement"]
        os.remove(path)
        return result

    def error(self, method, tolerance):
        key = method, tolerance
        if key not in self.found:
            difference = self.displacement(method, tolerance) - self.expected
            self.found[key] = float(np.linalg.norm(difference) / np.linalg.norm(self.expected))
            print(f"error {self.found[key]:.2e} of {method} at tolerance {tolerance:.2e}", flush=True)
        return self.found[key]

    def matching_tolerance(self, method, tolerance):
        """Tolerance at which a reference method is closest to the lanes' error at `tolerance`."""
        wanted = max(self.error(LANES, tolerance), SMALLEST)
        distance = {}
        trial = tolerance
        for _ in range(TRIES):
            ratio = max(self.error(method, trial), SMALLEST) / wanted
            distance[trial] = abs(math.log(ratio))
            if distance[trial] <= math.log(CLOSE):
                break
            trial = float(f"{min(trial / ratio, 0.5):.2g}")
            if trial in distance:
                break
        return min(distance, key=distance.get)

    def record(self):
        return {"exact": self.exact, "tolerance_of_exact": TIGHT,
                "errors": [{"method": m, "tolerance": t, "error": e} for (m, t), e in self.found.items()]}


def measure(options, method, tolerance, directory):
    """Figures of one run, medians over its iterations."""
    lines = program_run.iterate_only(options, options.ranks, directory, method_options(method, tolerance))
    peak = lines[-1]["peak_memory_bytes"] / 1e9
    lines = lines[1:] or lines
    counts = {kind: [line["solver_iterations"][kind] for line in lines] for kind in ("primal", "adjoint")}
    solves = [len(primal) + len(adjoint) for primal, adjoint in zip(*counts.values(), strict=True)]
    record = {phase: statistics.median(line["seconds"][phase] for line in lines) for phase in PHASES}
    record["seconds_per_solve"] = statistics.median(
        (line["seconds"]["primal"] + line["seconds"]["adjoint"]) / count for line, count in zip(lines, solves, strict=True))
    for kind, lists in counts.items():
        of_all = list(itertools.chain(*lists))
        record |= {f"iterations_{kind}": statistics.median(of_all), f"most_iterations_{kind}": max(of_all)}
    return {**record, "solves": solves[-1], "peak_memory_gigabytes": peak}


def solver_settings(options, method, tolerance, directory):
    """What the solver is and its options: those of the config, and for a reference method what PETSc says."""
    view = os.path.join(directory, "view.txt")
    petsc = [] if method == LANES else ["-elasticity_ksp_view", ":" + view]
    output = os.path.join(directory, "settings")
    arguments = ["-task", "simulate", "-layers", 1, *method_options(method, tolerance), *petsc]
    printed = program_run.run(options, options.ranks, output, arguments)
    record = {"description": printed.splitlines()[0], "config": program_run.read_json(output, "config.json")["solver"]}
    if petsc:
        with open(view, encoding="utf-8") as file:
            lines = file.read().splitlines()
        # A solver per layer, all with the same options.
        second = [i for i, line in enumerate(lines) if line.startswith("KSP Object:")][1:2]
        record["petsc"] = lines[:second[0] if second else None]
        os.remove(view)
    return record


def print_settings(settings):
    for record in settings.values():
        print("== " + record["description"])
        print("   config: " + ", ".join(f"{key} {value}" for key, value in record["config"].items()))
        for line in record.get("petsc", []):
            print("   " + line)


def print_table(methods, tolerances, results, found):
    def row(name, values, last=""):
        print(f"{name:24s}" + "".join(f"{value:>12s}" for value in values) + last)

    references = [m for m in methods if m != LANES]
    row("", methods, "   reference / lanes" if references and LANES in methods else "")
    row("tolerance", [f"{tolerances[m]:.2g}" for m in methods])
    if found:
        row("error of displacement", [f"{found[m, tolerances[m]]:.2g}" for m in methods])
    # The faster reference method: by the whole iteration.
    fastest = min(references, key=lambda m: results[m]["total"], default=None)
    for key in results[methods[0]]:
        last = ""
        if fastest and LANES in methods and key in COMPARED and results[LANES][key] > 0:
            last = f"{results[fastest][key] / results[LANES][key]:20.2f}"
        row(key, [f"{results[m][key]:.3f}" for m in methods], last)


def parse_arguments():
    parser = program_run.common_parser(__doc__)
    parser.add_argument("--ranks", type=int, default=2, metavar="P", help="default: %(default)s")
    parser.add_argument("--iterations", type=int, default=2, metavar="I",
                        help="design iterations of a run (default: %(default)s)")
    parser.add_argument("--methods", nargs="+", default=[LANES, "multigrid", "gamg"], choices=METHODS, metavar="METHOD",
                        help=f"of {', '.join(METHODS)}; the lanes and the first two unless given")
    parser.add_argument("--tolerance", type=float, default=1e-5, metavar="T", help="of the lanes (default: %(default)s)")
    parser.add_argument("--reference-tolerance", type=float, metavar="T",
                        help="of every reference method (default: searched for)")
    parser.add_argument("--error", action="store_true",
                        help=f"measure the true errors against a solve to {TIGHT:g}; the search does so anyway")
    parser.add_argument("--error-layers", type=int, metavar="N", help="measure errors with this many layers, to save time")
    parser.add_argument("--exact", choices=METHODS, metavar="METHOD",
                        help="of the solve that errors are measured against (default: the first reference method)")
    options = program_run.parse(parser)
    if options.iterations < 1:
        parser.error("--iterations: at least 1")
    return options


def main():
    options = parse_arguments()
    references = [m for m in options.methods if m in REFERENCES]
    with tempfile.TemporaryDirectory() as directory:
        errors = None
        if options.error or (references and options.reference_tolerance is None):
            errors = DisplacementErrors(options, directory, options.exact or (references + ["multigrid"])[0])
        tolerances = {m: options.tolerance if m == LANES else options.reference_tolerance
                      or errors.matching_tolerance(m, options.tolerance) for m in options.methods}
        if errors:
            for method in options.methods:
                errors.error(method, tolerances[method])
            errors.error(LANES if errors.exact != LANES else "multigrid", TIGHT)  # whether the exact one is
        settings = {m: solver_settings(options, m, tolerances[m], directory) for m in options.methods}
        samples, machine = program_run.by_turns(options, options.methods, lambda method: [
            measure(options, method, tolerances[method], os.path.join(directory, method))])
    results = {method: program_run.medians(of_method) for method, of_method in samples.items()}
    print_settings(settings)
    print(f"\n{options.title}, {options.ranks} ranks, {options.iterations} iterations, {options.repetitions} "
          f"repetitions, {program_run.machine_text(machine)}")
    print_table(options.methods, tolerances, results, errors.found if errors else {})
    program_run.write_results(options, {
        "ranks": options.ranks, "machine": machine, "tolerances": tolerances, "errors": errors.record() if errors else None,
        "medians": results, "samples": samples, "settings": settings})


if __name__ == "__main__":
    program_run.run_script(main)
