#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""A model of what a design iteration computes and sends: checked by counting, and used to predict strong scaling.

    benchmarks/scaling_model.sh check --splits 1x4 2x4 1x16           counts of small runs beside the model's
    benchmarks/scaling_model.sh predict --plot docs/scaling.png       time over cores, by the model
    benchmarks/scaling_model.sh parts --case v_shape --splits 1x1 4x16    what an iteration's time is made of

`check` runs the program with a library preloaded that counts MPI calls (benchmarks/scaling/message_count.cc), on two small boxes,
one all of material and one with a void, oversubscribed if need be: counts do not depend on that. It compares the last design
iteration with the model, given its numbers of CG iterations, and the whole run with PETSc's -log_view.

`predict` times the counts on a stated machine (benchmarks/scaling/machine.py): --latency, --network and so on change it. For each
number of cores it takes the fastest split into groups x domain ranks on no more cores that fits the memory. --measured adds the
figures of a CSV of strong_scaling.sh.
"""
import argparse
import csv
import dataclasses
import functools
import math
import os
import sys
import tempfile

import numpy as np

import program_run
from scaling import check, counts, machine
from strong_scaling import parse_split, split_text

# Cores and seconds of an iteration of the V-shape (Di Girolamo 2024, table 2).
PUBLISHED = [(4, 568.36), (8, 317.19), (16, 131.73), (24, 92.54), (32, 75.99),
             (40, 67.68), (48, 63.87), (56, 66.47), (64, 65.84), (72, 55.49)]
CORES = [64 * 2**k for k in range(11)]
DOMAIN_RANKS = sorted({factor * 2**k for factor in (1, 3) for k in range(17)})
MOST_SPREAD = 4096  # domain ranks of a box whose voxels are known


@dataclasses.dataclass
class Case:
    """A part and what its solvers take (CG iterations of a layer: those of the V-shape's optimization, halfway)."""
    title: str
    box: tuple
    part: object   # voxels, or the filled share of the box
    layers: int
    first_cores: int
    primal: int = 12
    adjoint: int = 8
    heat: int = 10
    newton_steps: int = 10

    def part_elements(self):
        return self.part.sum() if not np.isscalar(self.part) else self.part * math.prod(self.box)

    def iteration(self):
        return counts.Iteration([self.primal] * self.layers, [self.adjoint] * self.layers, [self.heat] * (self.layers + 2),
                                self.newton_steps, 2 * self.layers, self.part_elements())

    @functools.lru_cache(maxsize=None)
    def hierarchies(self, ranks, staged):
        return counts.hierarchies(self.box, self.part, ranks, staged)

    __hash__ = object.__hash__


def v_shape_voxels():
    """benchmarks/v_shape.json, by element centres."""
    x, _, z = np.meshgrid((np.arange(80) + 0.5) / 40, (np.arange(40) + 0.5) / 40, (np.arange(80) + 0.5) / 40, indexing="ij")
    return ((z < 0.6) | (x > 1.2)) & (z > x - 1.0)


def cases():
    return {"v_shape": Case("V-shape, 80 x 40 x 80, N = 25", (80, 40, 80), v_shape_voxels(), 25, 1),
            "billion": Case("1280 x 640 x 1280 = 1.05e9 elements, fill 0.2, N = 100", (1280, 640, 1280), 0.2, 100, 64)}


def time_split(case, on, groups, ranks, staged):
    """Seconds by phase and part; None if the box cannot be dealt out so, or does not fit."""
    hierarchies = case.hierarchies(ranks, staged)
    if hierarchies is None:
        return None
    elastic, heat = hierarchies
    nodes = math.ceil(groups * ranks / on.cores_a_node)
    if machine.memory_bytes(elastic, groups, case.layers, case.part_elements()) > nodes * on.memory:
        return None
    iteration = case.iteration()
    clock = machine.Clock(on, elastic, heat, groups, case.part_elements())
    return clock.seconds(counts.count_iteration(elastic, heat, groups, iteration), iteration)


def total(seconds):
    return sum(sum(parts.values()) for parts in seconds.values())


def group_counts(layers):
    """Numbers of groups worth a try: the batches of 8, 4, 2 and 1 layers dealt out evenly, and powers of two."""
    whole = {math.ceil(layers / (lanes * k)) for lanes in (8, 4, 2, 1) for k in (1, 2)} | {2**k for k in range(10)}
    return sorted(groups for groups in whole if groups <= layers)


def predict(case, on, cores, staged):
    """(cores, groups, ranks, seconds) of the fastest split on at most each number of cores."""
    most = max(cores)
    tried = []
    for groups in group_counts(case.layers):
        for ranks in DOMAIN_RANKS:
            if groups * ranks > most or (not np.isscalar(case.part) and ranks > MOST_SPREAD):
                break
            seconds = time_split(case, on, groups, ranks, staged)
            if seconds is not None:
                tried.append((groups, ranks, seconds))
    result = []
    for count in cores:
        fitting = [entry for entry in tried if entry[0] * entry[1] <= count]
        if fitting:
            result.append((count, *min(fitting, key=lambda entry: total(entry[2]))))
    return result


def print_parts(seconds):
    kinds = ["compute", "serial", "messages", "collectives"]
    print(f"{'':>12s}" + "".join(f"{kind:>13s}" for kind in kinds) + f"{'seconds':>13s}")
    for phase, parts in seconds.items():
        print(f"{phase:>12s}" + "".join(f"{parts[kind]:13.5f}" for kind in kinds) + f"{sum(parts.values()):13.5f}")
    print(f"{'total':>12s}"
          + "".join(f"{sum(parts[kind] for parts in seconds.values()):13.5f}" for kind in kinds) + f"{total(seconds):13.5f}")


def print_prediction(case, rows, staged):
    print(f"\n{case.title}" + ("; if coarse levels were held by ever fewer ranks" if staged else "; as the program is"))
    print(f"{'cores':>7s}{'split':>10s}{'seconds':>10s}{'speed-up':>10s}{'efficiency':>11s}   share of compute, serial, messages, collectives")
    for count, groups, ranks, seconds in rows:
        speed_up = total(rows[0][3]) / total(seconds)
        shares = [sum(parts[kind] for parts in seconds.values()) / total(seconds)
                  for kind in ("compute", "serial", "messages", "collectives")]
        print(f"{count:7d}{split_text((groups, ranks)):>10s}{total(seconds):10.4f}{speed_up:10.1f}{speed_up * rows[0][0] / count:11.3f}   "
              + " ".join(f"{100 * share:4.0f} %" for share in shares))


def read_measured(path):
    """Cores and seconds of the fastest split of each number of ranks."""
    best = {}
    with open(path, encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):
            if row["phase"] == "total":
                ranks = int(row["ranks"])
                best[ranks] = min(best.get(ranks, math.inf), float(row["seconds"]))
    return sorted(best.items())


def plot(path, predictions, measured):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, all_axes = plt.subplots(1, 2, figsize=(12, 5))
    for axes, (case, curves) in zip(all_axes, predictions):
        for staged, rows in curves.items():
            axes.loglog([row[0] for row in rows], [total(row[3]) for row in rows], "o--" if staged else "o-", markersize=4,
                        color="tab:gray" if staged else "tab:blue", label="model, coarse levels on ever fewer ranks (not built)" if staged else "model")
        rows = curves[False]
        axes.loglog([row[0] for row in rows], [total(rows[0][3]) * rows[0][0] / row[0]
                    for row in rows], ":", color="tab:blue", label="ideal")
        if case.box == (80, 40, 80):
            axes.loglog(*zip(*PUBLISHED), "k^-", markersize=4, label="Di Girolamo 2024, table 2")
            if measured:
                axes.loglog(*zip(*measured), "s", color="tab:red", markersize=5, label="measured")
        axes.set_title(case.title, fontsize=10)
        axes.set_xlabel("cores")
        axes.set_ylabel("seconds a design iteration")
        axes.grid(alpha=0.3, which="both")
        axes.legend(fontsize=8)
    figure.tight_layout()
    figure.savefig(path, dpi=100)


def run_predict(options, on):
    predictions, record = [], []
    for case in cases().values():
        cores = [count for count in [1, 2, 4, 8, 16, 32, *CORES] if count >= case.first_cores]
        curves = {staged: predict(case, on, cores, staged) for staged in (False, True)}
        for staged, rows in curves.items():
            print_prediction(case, rows, staged)
            record += [{"case": case.title, "staged": staged, "cores": row[0], "groups": row[1], "domain_ranks": row[2], "seconds": total(row[3])}
                       for row in rows]
        predictions.append((case, curves))
    if options.csv:
        program_run.write_csv(options.csv, record)
    if options.plot:
        plot(options.plot, predictions, read_measured(options.measured) if options.measured else [])


def run_parts(options, on):
    case = cases()[options.case]
    for groups, ranks in options.splits:
        seconds = time_split(case, on, groups, ranks, False)
        print(f"{case.title}, {split_text((groups, ranks))}")
        print_parts(seconds) if seconds else print("does not fit")


def run_check(options):
    """0 if all messages are as many and as large as the model says."""
    failed = False
    with tempfile.TemporaryDirectory() as directory:
        library = check.build_library(directory)
        for name in options.cases:
            for groups, ranks in options.splits:
                counted, whole, logged, model = check.run_counted(options, check.CASES[name], groups, ranks, library)
                failed = check.print_comparison(f"{name}, {split_text((groups, ranks))}", counted,
                                                model, check.compare_log(whole, logged)) or failed
    return 1 if failed else 0


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    checks = commands.add_parser("check", help="counts of small runs beside the model's")
    checks.add_argument("--program", default=os.path.join(program_run.ROOT,
                        "build/release/fabseq"), help="default: build/release/fabseq")
    checks.add_argument("--cases", nargs="+", default=list(check.CASES), choices=list(check.CASES), help="default: both")
    checks.add_argument("--splits", nargs="+", type=parse_split,
                        default=[(1, 4), (2, 4), (1, 16)], metavar="GxD", help="default: 1x4 2x4 1x16")
    checks.set_defaults(rest=[])
    predicts = commands.add_parser("predict", help="time over cores")
    predicts.add_argument("--plot", metavar="FILE")
    predicts.add_argument("--csv", metavar="FILE")
    predicts.add_argument("--measured", metavar="FILE", help="a CSV of strong_scaling.sh, of the V-shape")
    parts = commands.add_parser("parts", help="what the time of splits is made of")
    parts.add_argument("--case", default="v_shape", choices=list(cases()))
    parts.add_argument("--splits", nargs="+", type=parse_split, default=[(1, 1)], metavar="GxD")
    for command in (predicts, parts):
        for field in dataclasses.fields(machine.Machine):
            command.add_argument("--" + field.name.replace("_", "-"), type=field.type,
                                 default=field.default, help="default: %(default)g")
    return parser.parse_args()


def main():
    options = parse_arguments()
    if options.command == "check":
        sys.exit(run_check(options))
    on = machine.Machine(**{field.name: getattr(options, field.name) for field in dataclasses.fields(machine.Machine)})
    (run_predict if options.command == "predict" else run_parts)(options, on)


if __name__ == "__main__":
    main()
