# SPDX-License-Identifier: MIT
"""Runs the program under the counting library and compares what it sent with the model."""

import csv
import os
import re
import tempfile
from collections import Counter, defaultdict

from ... import program_run
from .counts import Iteration, count_iteration
from .machine import PHASES
from .plan import Plan

FIGURES = ["messages", "message_bytes", "collectives", "collective_bytes"]
# Iterations of a run; the last is compared. By then groups have met all numbers of lanes that they are dealt:
# what is set up at first use is sent only once.
ITERATIONS = 6
# Of these phases the bytes of MPI_Alltoallv are left out: graphs of basins (IslandMap), as large as the
# stiffness makes them.
PHASES_WITH_GRAPHS = ("primal", "adjoint")
# On two boxes: one all of material, which the model knows to the last byte, and one with a void.
BLOCK = {
    "name": "block", "domain": {"size": [2.0, 1.0, 2.0], "elements": [32, 16, 32]},
    "part": {"box": {"min": [0, 0, 0], "max": [2, 1, 2]}},
    "node_sets": {"edge": {"box": {"min": [2, 0, 2], "max": [2, 1, 2]}}},
    "process": {"deposition": "follow"},  # as benchmarks/v_shape.json
    "sequence": {"type": "heat", "characteristic_length": 2.0}, "layers": {"count": 11},
    "objective": [{"type": "distortion", "nodes": "edge", "scaling": "current", "least_squares": False},
                  {"type": "layer_uniformity"}],
    "constraints": [{"type": "layer_thickness", "target": 0.18}]}
V_SHAPE = {**BLOCK, "name": "v_shape", "part": {"difference": [
    {"union": [{"box": {"min": [0, 0, 0], "max": [2, 1, 0.6]}}, {"box": {"min": [1.2, 0, 0], "max": [2, 1, 2]}}]},
    {"half_space": {"point": [1, 0, 0], "normal": [-1, 0, 1]}}]},
    "constraints": [{"type": "layer_thickness", "target": 0.22}]}
CASES = {case["name"]: case for case in (BLOCK, V_SHAPE)}


def build_library(directory):
    """The preloaded library; it needs MPI's compiler only."""
    library = os.path.join(directory, "message_count.so")
    source = os.path.join(os.path.dirname(__file__), "message_count.cc")
    program_run.run_command(["mpicxx", "-std=c++20", "-O1", "-fPIC", "-shared", "-o", library, source, "-ldl"])
    return library


def read_counts(directory, iteration):
    """Messages of all ranks, collective calls of a mean rank, and bytes: by phase, and of the whole run."""
    by_phase, whole = defaultdict(Counter), Counter()
    files = [name for name in os.listdir(directory) if name.endswith(".csv")]
    for name in files:
        with open(os.path.join(directory, name), encoding="utf-8", newline="") as file:
            for row in csv.DictReader(file):
                count, size, alone = int(row["count"]), int(row["bytes"]), row["ranks"] == "1"
                kind, share = ("message", 1.0) if row["kind"] == "message" else ("collective", 1.0 / len(files))
                phase = row["stage"].removeprefix("fabseq ")
                if row["kind"] in ("gather", "scatter", "alltoall", "alltoallv"):
                    whole[phase, "gathered_bytes"] += count * size
                if kind == "message" or not alone or row["kind"] in ("gather", "scatter"):
                    whole[phase, kind + "s"] += count * share
                    whole[phase, kind + "_bytes"] += count * size * share
                    whole[phase, row["kind"]] += count * share
                if int(row["iteration"]) == iteration and not alone:
                    by_phase[phase][kind + "s"] += count * share
                    if row["kind"] != "alltoallv" or phase not in PHASES_WITH_GRAPHS:
                        by_phase[phase][kind + "_bytes"] += count * size * share
    return by_phase, whole


def read_log(path):
    """Messages, bytes and reductions by stage, of -log_view."""
    result = {}
    with open(path, encoding="utf-8") as file:
        for line in file:
            stage = re.match(r"\s*\d+:\s+fabseq (\w+):((?:\s+\S+){10})", line)
            if stage and "%" in line:
                values = [float(v.rstrip("%")) for v in stage[2].split()]
                result[stage[1]] = {"messages": values[4], "message_bytes": values[4] * values[6],
                                    "reductions": values[8]}
    return result


def model_counts(tallies, elastic, heat):
    result = {phase: Counter() for phase in PHASES}

    for tally in tallies:
        for (phase, what, *size), times in tally.traffic.items():
            traffic = getattr(heat if phase == "heat" else elastic, what)(*size)
            result[phase]["messages"] += times * traffic.messages
            result[phase]["message_bytes"] += times * traffic.bytes
        for (phase, _, comm, size), times in tally.collectives.items():
            system = heat if phase == "heat" else elastic
            share = system.levels[comm].ranks / system.ranks if isinstance(comm, int) else 1.0
            result[phase]["collectives"] += times * share / len(tallies)
            result[phase]["collective_bytes"] += times * share / len(tallies) * size
    return result


def model_of(plan_program, config, lines, groups, ranks):
    """The model's counts of the last iteration of a history."""
    before, last = (line["solver_iterations"] for line in lines[-2:])
    iteration = Iteration(last["primal"], last["adjoint"], last["heat"], lines[-1]["optimizer"]["newton_steps"],
                          rows=2 * len(last["primal"]),
                          expected_work=[1 + a + b for a, b in zip(before["primal"], before["adjoint"])])
    plan = Plan(plan_program, {"config": config}, [ranks], [groups], iteration)
    systems = plan.systems(ranks)
    return model_counts(count_iteration(plan, *systems, groups), *systems)


def compare(options, name, groups, ranks, library):
    """Prints counts of the last iteration of a run beside the model's; whether they differ."""
    with tempfile.TemporaryDirectory() as directory:
        options.config = os.path.join(directory, "case.json")
        program_run.write_json(options.config, CASES[name])
        counts, log = os.path.join(directory, "counts"), os.path.join(directory, "log.txt")
        os.mkdir(counts)
        options.launcher = f"mpirun -np {{ranks}} -x LD_PRELOAD={library} -x MESSAGE_COUNT_DIRECTORY={counts}"
        options.iterations = ITERATIONS
        lines = program_run.iterate(options, groups * ranks, os.path.join(directory, "output"),
                                    ["-layer_groups", groups, "-log_view", ":" + log])
        by_phase, whole = read_counts(counts, ITERATIONS)
        model = model_of(options.plan, options.config, lines, groups, ranks)
        return print_comparison(f"{name}, {groups}x{ranks}", by_phase, model, compare_log(whole, read_log(log)))


def compare_log(whole, logged, phases=("heat", "primal", "adjoint")):
    """Largest relative differences of messages, of their bytes, and of reductions, over the phases of the
    whole run. PETSc counts neither MPI_Reduce nor barriers, and half the bytes of gathers, scatters and
    MPI_Alltoallv with those of messages; gathers and scatters also where a rank is alone."""
    worst = Counter()
    for phase in phases:
        ours = {"messages": whole[phase, "messages"],
                "message_bytes": whole[phase, "message_bytes"] + 0.5 * whole[phase, "gathered_bytes"],
                "reductions": whole[phase, "collectives"] - whole[phase, "reduce"] - whole[phase, "barrier"]}
        for key, value in ours.items():
            if max(value, logged[phase][key]) > 0 and not (key == "message_bytes" and whole[phase, "messages"] == 0):
                worst[key] = max(worst[key], abs(value - logged[phase][key]) / max(value, logged[phase][key]))
    return dict(worst)


def print_comparison(title, counted, model, log):
    """Prints a table; whether messages differ at all, or collectives by more than how parts are rounded. The
    optimizer leaves out rows that cannot bind, so that the bytes of its sums are at most the model's; and a
    cut step takes a sum more."""
    print(f"\n{title}: -log_view and the library differ by at most "
          + ", ".join(f"{100 * value:.2f} % ({key.replace('_', ' ')})" for key, value in log.items()))
    print(f"{'phase':>10s}" + program_run.heads((figure.replace("_", " ") for figure in FIGURES), 28))
    print(f"{'':>10s}" + f"{'counted':>14s}{'model':>14s}" * len(FIGURES))
    agree = max(log.values()) <= 0.002
    for phase in PHASES:
        here, there = counted[phase], model[phase]
        print(f"{phase:>10s}" + "".join(f"{here[figure]:14.1f}{there[figure]:14.1f}" for figure in FIGURES))
        if phase == "optimizer":
            agree &= here["collectives"] > there["collectives"] - 1e-6
            agree &= here["collective_bytes"] < there["collective_bytes"] + 1e-6
            continue
        for figure in FIGURES:
            tolerance = 1e-3 * there[figure] if figure == "collective_bytes" else 1e-6
            agree &= abs(here[figure] - there[figure]) <= tolerance
    print("as the model says" if agree else "NOT as the model says")
    return not agree
