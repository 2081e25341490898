#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Times plastic flow against the linear process in one run: seconds, sweeps and memory.

    benchmarks/flow.py benchmarks/v_shape.json [--yield-stress 0.0015] [--hardening 0.01] [--ranks 1]
    [-- OPTIONS OF THE PROGRAM]

Both have nominal deposition and no least squares, all elements count. Without a yield stress, the
material's own. Measured are the iterations of an optimization after the warm-up, which begin from the last
design's state, and simulations from a cold start: the linear one to 1e-6, that with flow until sweeps change
displacements by 1e-3 and 1e-5, for errors of about 1e-2 and 1e-4 at most. Medians over the repetitions,
which run by turns, and over the iterations. Sweeps are means over the steps.
"""
import os
import statistics
import tempfile

import program_run
from program_run import LANES, method_options

LINEAR, FLOW = "linear", "elastoplastic"
TOLERANCES = {LINEAR: (1e-6,), FLOW: (1e-2, 1e-4)}


def arguments_of(options, model):
    words = ["-set", f"process.model={model}", "-set", "process.deposition=nominal", "-set", "solver.region=whole"]
    terms = options.terms
    words += [word for i in range(len(terms)) if terms[i]["type"] == "distortion"
              for word in ("-set", f"objective.{i}.least_squares=false")]
    if options.yield_stress is not None:
        words += ["-set", f"material.yield_stress={options.yield_stress}", "-set", f"material.hardening={options.hardening}"]
    return words


def iterations(options, model, directory):
    """Of each iteration after the warm-up."""
    arguments = [*arguments_of(options, model), *method_options(LANES, 1e-6)]
    lines = program_run.iterate_only(options, options.ranks, directory, arguments)[options.warm_up:]
    return [{"seconds": line["seconds"]["total"], "gigabytes": line["peak_memory_bytes"] / 1e9,
             "sweeps": statistics.mean(line["solver_iterations"]["primal"]),
             "adjoint_sweeps": statistics.mean(line["solver_iterations"]["adjoint"])} for line in lines]


def simulation(options, model, tolerance, directory):
    program_run.run(options, options.ranks, directory,
                    ["-task", "simulate", *arguments_of(options, model), *method_options(LANES, tolerance)])
    summary = program_run.read_json(directory, "summary.json")
    return {"seconds": summary["seconds"]["primal"], "sweeps": statistics.mean(summary["solver_iterations"]["primal"])}


def median_of(rows):
    return {key: statistics.median(row[key] for row in rows) for key in rows[0]}


def print_table(found, simulated):
    print(f"{'':32s}{'linear':>10s}{'flow':>10s}{'ratio':>8s}")
    names = {"seconds": "iteration, s", "gigabytes": "memory, GB"}
    for key, name in names.items():
        linear, flow = (found[model][key] for model in (LINEAR, FLOW))
        print(f"{name:32s}{linear:10.3f}{flow:10.3f}{flow / linear:8.2f}")
    print(f"{'sweeps, and of an adjoint':32s}{'':10s}{found[FLOW]['sweeps']:10.1f}{found[FLOW]['adjoint_sweeps']:8.1f}")
    linear = simulated[LINEAR, TOLERANCES[LINEAR][0]]
    for tolerance in TOLERANCES[FLOW]:
        flow = simulated[FLOW, tolerance]
        print(f"{f'cold simulation to {tolerance:g}, s':32s}{linear['seconds']:10.3f}{flow['seconds']:10.3f}"
              f"{flow['seconds'] / linear['seconds']:8.2f}{flow['sweeps']:8.1f} sweeps")


def main():
    parser = program_run.common_parser(__doc__)
    parser.add_argument("--ranks", type=int, default=1)
    parser.add_argument("--yield-stress", type=float, metavar="S")
    parser.add_argument("--hardening", type=float, default=0.01, metavar="H")
    options = program_run.parse_iterations(parser, "", "model", iterations=6)
    rows, found_of = {LINEAR: [], FLOW: []}, {}
    with tempfile.TemporaryDirectory(prefix="fabseq_flow_") as folder:
        program_run.run(options, 1, os.path.join(folder, "check"), ["-task", "simulate", "-layers", 1])
        options.terms = program_run.read_json(os.path.join(folder, "check"), "config.json")["objective"]
        for _ in range(options.repetitions):
            for model in (LINEAR, FLOW):
                rows[model] += iterations(options, model, os.path.join(folder, model))
                for tolerance in TOLERANCES[model]:
                    found_of.setdefault((model, tolerance), []).append(
                        simulation(options, model, tolerance, os.path.join(folder, "simulated")))
    found = {model: median_of(of_model) for model, of_model in rows.items()}
    simulated = {key: median_of(values) for key, values in found_of.items()}
    print_table(found, simulated)
    if options.json:
        program_run.write_json(options.json, {"iterations": rows, "simulations": {
            f"{model} {tolerance:g}": values for (model, tolerance), values in found_of.items()}})


if __name__ == "__main__":
    program_run.run_script(main)
