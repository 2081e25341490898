#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""A model of what a design iteration computes and sends: checked by counting, and used to predict strong
scaling.

    benchmarks/scaling_model.py check --splits 1x4 2x4 1x16           counts of small runs beside the model's
    benchmarks/scaling_model.py predict --before benchmarks/scaling/before.csv --plot docs/scaling.png
                                                                      time over cores, by the model
    benchmarks/scaling_model.py parts --case v_shape --splits 1x1 4x16    what an iteration's time is made of

`check` runs the program with a library preloaded that counts MPI calls (benchmarks/scaling/message_count.cc),
on two small boxes, one all of material and one with a void, oversubscribed if need be: counts do not depend
on that. It compares the last design iteration with the model, given its numbers of CG iterations, and the
whole run with PETSc's -log_view.

`predict` times the counts on a stated machine (benchmarks/scaling/machine.py): --latency, --network and so on
change it. For each number of cores it takes the fastest split into groups x domain ranks on no more cores
that fits the memory. --measured adds the figures of a CSV of strong_scaling.py, --before those of another
prediction's --csv: scaling/before.csv is that of the last version in which small levels were whole on every
rank.

How box, layers and rows are dealt out is asked of the program (benchmarks/scaling/plan.cc, built with the
tests and with FABSEQ_BENCHMARKS).
"""
import csv
import dataclasses
import math
import os
import sys
import tempfile

import program_run
from program_run import parse_split, split_text
from scaling import check
from scaling.counts import Iteration, count_iteration
from scaling.machine import KINDS, Clock, Machine, memory_bytes
from scaling.plan import Plan

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


def run_predict(options, on):
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
    for groups, ranks in options.splits:
        seconds = case.time_split(on, groups, case.plan.systems(ranks))
        print(f"{case.title}, {split_text((groups, ranks))}")
        print_parts(seconds) if seconds else print("does not fit")


def parse_arguments():
    parser = program_run.parser_of(__doc__)
    commands = parser.add_subparsers(dest="command", required=True)
    checks = commands.add_parser("check", help="counts of small runs beside the model's")
    program_run.add_program_option(checks)
    checks.add_argument("--cases", nargs="+", default=list(check.CASES), choices=list(check.CASES),
                        help="default: both")
    checks.add_argument("--splits", nargs="+", type=parse_split,
                        default=[(1, 4), (2, 4), (1, 16)], metavar="GxD", help="default: 1x4 2x4 1x16")
    checks.set_defaults(rest=[])
    predicts = commands.add_parser("predict", help="time over cores")
    predicts.add_argument("--plot", metavar="FILE")
    predicts.add_argument("--csv", metavar="FILE")
    predicts.add_argument("--before", metavar="FILE", help="a CSV of another prediction")
    predicts.add_argument("--measured", metavar="FILE", help="a CSV of strong_scaling.py, of the V-shape")
    parts = commands.add_parser("parts", help="what the time of splits is made of")
    parts.add_argument("--case", default="v_shape", choices=list(CASES))
    parts.add_argument("--splits", nargs="+", type=parse_split, default=[(1, 1)], metavar="GxD")
    for command in (checks, predicts, parts):
        command.add_argument("--plan", metavar="PROGRAM", help="default: build/release/benchmarks/scaling_plan",
                             default=os.path.join(os.path.dirname(program_run.PROGRAM), "benchmarks", "scaling_plan"))
    for command in (predicts, parts):
        for field in dataclasses.fields(Machine):
            command.add_argument("--" + field.name.replace("_", "-"), type=field.type,
                                 default=field.default, help="default: %(default)g")
    return parser.parse_args()


def main():
    options = parse_arguments()
    if options.command == "check":  # status 1 if not all messages are as many and as large as the model says
        with tempfile.TemporaryDirectory() as directory:
            library = check.build_library(directory)
            sys.exit(any([check.compare(options, case, *split, library)
                          for case in options.cases for split in options.splits]))
    on = Machine(**{field.name: getattr(options, field.name) for field in dataclasses.fields(Machine)})
    (run_predict if options.command == "predict" else run_parts)(options, on)


if __name__ == "__main__":
    program_run.run_script(main)
