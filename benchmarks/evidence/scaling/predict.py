# SPDX-License-Identifier: MIT
"""Seconds of a design iteration over cores, and what they are made of, as tables and a picture."""

import csv
import dataclasses
import math
import os

from ... import program_run
from ...program_run import split_text
from . import __doc__ as documentation
from .counts import Iteration, count_iteration
from .machine import KINDS, Clock, memory_bytes
from .plan import Plan

# Cores and seconds of an iteration of the V-shape (Di Girolamo 2024, table 2).
PUBLISHED = [(4, 568.36), (8, 317.19), (16, 131.73), (24, 92.54), (32, 75.99),
             (40, 67.68), (48, 63.87), (56, 66.47), (64, 65.84), (72, 55.49)]
CORES = [2**k for k in range(17)]
DOMAIN_RANKS = sorted({factor * 2**k for factor in (1, 3) for k in range(17)})
MOST_SPREAD = 4096  # domain ranks of a box whose elements are known


@dataclasses.dataclass
class Case:
    """A part that time is predicted for."""
    title: str
    part: dict  # as the plan is asked
    layers: int
    first_cores: int

    def prepare(self, program, groups, ranks):
        """Asks for the plan on these numbers, for an iteration halfway in the V-shape's optimization."""
        iteration = Iteration([12] * self.layers, [8] * self.layers, [10] * (self.layers + 2), newton_steps=10,
                              rows=2 * self.layers)
        self.plan = Plan(program, self.part, ranks, groups, iteration)

    def time_split(self, on, groups, systems):
        """Seconds by phase and part; None if the box cannot be dealt out so, or does not fit."""
        if systems is None:
            return None
        nodes = math.ceil(groups * systems[0].ranks / on.cores_per_node)
        if memory_bytes(systems[0], groups, self.layers, self.plan.part_elements) > nodes * on.memory:
            return None
        return Clock(on, self.plan, *systems, groups).seconds(count_iteration(self.plan, *systems, groups))


CASES = {"v_shape": Case("V-shape, 80 x 40 x 80, N = 25",
                         {"config": os.path.join(program_run.ROOT, "benchmarks/v_shape.json")}, 25, 1),
         "billion": Case("1280 x 640 x 1280 = 1.05e9 elements, fill 0.2, N = 100",
                         {"box": [1280, 640, 1280], "fill": 0.2}, 100, 64)}


def total(seconds, kinds=KINDS):
    return sum(parts[kind] for parts in seconds.values() for kind in kinds)


def group_counts(layers):
    """Numbers of groups worth a try: batches of 8, 4, 2 and 1 layers dealt out evenly, and powers of two."""
    whole = {math.ceil(layers / (lanes * k)) for lanes in (8, 4, 2, 1) for k in (1, 2)} | {2**k for k in range(10)}
    return sorted(groups for groups in whole if groups <= layers)


def predict(case, on, program):
    """(cores, groups, ranks, seconds) of the fastest split on so many cores."""
    domain_ranks = [ranks for ranks in DOMAIN_RANKS if ranks <= (MOST_SPREAD if "config" in case.part else CORES[-1])]
    groups = group_counts(case.layers)
    case.prepare(program, groups, domain_ranks)
    tried = [(count, ranks, case.time_split(on, count, case.plan.systems(ranks)))
             for count in groups for ranks in domain_ranks if count * ranks <= CORES[-1]]
    rows = []
    for cores in CORES:
        fitting = [entry for entry in tried if entry[2] and cores >= max(entry[0] * entry[1], case.first_cores)]
        if fitting:
            rows.append((cores, *min(fitting, key=lambda entry: total(entry[2]))))
    return rows


def print_parts(seconds):
    print(f"{'':>12s}" + program_run.heads([*KINDS, "seconds"], 13))
    for name, phases in [*((phase, {phase: parts}) for phase, parts in seconds.items()), ("total", seconds)]:
        print(f"{name:>12s}" + "".join(f"{total(phases, [kind]):13.5f}" for kind in KINDS) + f"{total(phases):13.5f}")


def print_prediction(case, rows):
    print(f"\n{case.title}")
    print(f"{'cores':>7s}{'split':>10s}{'seconds':>10s}{'speed-up':>10s}{'efficiency':>11s}"
          f"   share of {', '.join(KINDS)}")
    for count, groups, ranks, seconds in rows:
        speed_up = total(rows[0][3]) / total(seconds)
        print(f"{count:7d}{split_text((groups, ranks)):>10s}{total(seconds):10.4f}{speed_up:10.1f}"
              f"{speed_up * rows[0][0] / count:11.3f}   "
              + " ".join(f"{100 * total(seconds, [kind]) / total(seconds):4.0f} %" for kind in KINDS))


def read_measured(path):
    """Cores and seconds of the fastest split of each number of ranks."""
    with open(path, encoding="utf-8", newline="") as file:
        totals = [(int(row["ranks"]), float(row["seconds"])) for row in csv.DictReader(file) if row["phase"] == "total"]
    return sorted(dict(sorted(totals, reverse=True)).items())


def read_before(path):
    """Cores and seconds of another prediction, by the titles of the cases."""
    curves = {}
    with open(path, encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):
            curves.setdefault(row["case"], []).append((int(row["cores"]), float(row["seconds"])))
    return curves


def plot(path, predictions, measured, before):
    with program_run.figure(path, "", 2, figsize=(12, 5)) as all_axes:
        for axes, (case, rows) in zip(all_axes, predictions):
            axes.loglog([row[0] for row in rows], [total(row[3]) for row in rows], "o-", color="tab:blue",
                        label="model", ms=4)
            if case.title in before:
                axes.loglog(*zip(*before[case.title]), "o--", color="tab:gray", label="model, before", markersize=4)
            ideal = [total(rows[0][3]) * rows[0][0] / row[0] for row in rows]
            axes.loglog([row[0] for row in rows], ideal, ":", color="tab:blue", label="ideal")
            if case is CASES["v_shape"]:
                axes.loglog(*zip(*PUBLISHED), "k^-", markersize=4, label="Di Girolamo 2024, table 2")
                if measured:
                    axes.loglog(*zip(*measured), "s", color="tab:red", markersize=5, label="measured")
            axes.set(title=case.title, xlabel="cores", ylabel="seconds per design iteration")


def print_origin():
    """What the seconds below rest on."""
    print(documentation.splitlines()[0])


def run_predict(options, on):
    print_origin()
    predictions, record = [], []
    for case in CASES.values():
        rows = predict(case, on, options.plan)
        print_prediction(case, rows)
        record += [{"case": case.title, "cores": cores, "groups": groups, "domain_ranks": ranks, "seconds": total(seconds)}
                   for cores, groups, ranks, seconds in rows]
        predictions.append((case, rows))
    if options.csv:
        program_run.write_rows(options.csv, record)
    if options.plot:
        plot(options.plot, predictions, read_measured(options.measured) if options.measured else [],
             read_before(options.before) if options.before else {})


def run_parts(options, on):
    case = CASES[options.case]
    all_groups, all_ranks = map(list, zip(*options.splits))
    case.prepare(options.plan, all_groups, all_ranks)
    print_origin()
    for groups, ranks in options.splits:
        seconds = case.time_split(on, groups, case.plan.systems(ranks))
        print(f"{case.title}, {split_text((groups, ranks))}")
        print_parts(seconds) if seconds else print("does not fit")
