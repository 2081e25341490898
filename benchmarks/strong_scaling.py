#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Strong scaling: seconds of a design iteration by phase, over groups x domain ranks, against one baseline:

    benchmarks/strong_scaling.py benchmarks/v_shape.json --ranks 1 2 4 --csv v.csv --plot v.png [-- OPTIONS]
    benchmarks/strong_scaling.py benchmarks/v_shape.json --splits 1x1 2x1 1x2 4x16 --baseline 1x1

A split GxD is G layer groups of D domain ranks each, on G D ranks. --ranks takes all splits of each number of
ranks, with no more groups than layers. Figures are medians over the iterations after the warm-up, of all
repetitions; these run by turns.

Against the baseline, of P0 ranks and T0 seconds (the first split unless --baseline names one), with s = P /
P0:
    speed-up          S = T0 / T
    efficiency        S / s
    serial fraction   (1/S - 1/s) / (1 - 1/s), Karp and Flatt 1990: of the baseline's time; what grows with P
                      is no serial part, but overhead or unequal load
P0 and P are both in ranks: a baseline of 4 ranks has an efficiency of 1, and so would 16 ranks in a quarter
of its time.
"""
import os
import sys
import tempfile

import program_run
from program_run import PHASES, parse_split, split_text

COLUMNS = ["seconds", "speed_up", "efficiency", "serial_fraction"]


def splits_of(ranks, layers):
    return [(groups, ranks // groups) for groups in range(1, min(ranks, layers) + 1) if ranks % groups == 0]


def metrics(seconds, split, baseline_seconds, baseline):
    """Speed-up, efficiency and Karp-Flatt serial fraction; None where there is none."""
    more = split[0] * split[1] / (baseline[0] * baseline[1])
    speed_up = baseline_seconds / seconds if seconds > 0 else None
    if speed_up is None or speed_up == 0.0:
        return {"speed_up": speed_up, "efficiency": None, "serial_fraction": None}
    serial = (1.0 / speed_up - 1.0 / more) / (1.0 - 1.0 / more) if more != 1.0 else None
    return {"speed_up": speed_up, "efficiency": speed_up / more, "serial_fraction": serial}


def table(seconds, baseline):
    """A record per split and phase."""
    return [{"groups": split[0], "domain_ranks": split[1], "ranks": split[0] * split[1], "phase": phase,
             "seconds": of_split[phase], **metrics(of_split[phase], split, seconds[baseline][phase], baseline)}
            for split, of_split in seconds.items() for phase in PHASES]


def measure(options, split, directory):
    """Seconds by phase and CG iterations of all layers, of each iteration after the warm-up."""
    lines = program_run.iterate(options, split[0] * split[1], directory, ["-layer_groups", split[0]])[options.warm_up:]
    return [{**line["seconds"], "cg": sum(sum(line["solver_iterations"][kind]) for kind in ("primal", "adjoint"))}
            for line in lines]


def print_table(seconds, rows, baseline):
    phases = [phase for phase in PHASES if phase != "output"]
    print(f"{'split':>7s}{'ranks':>7s}" + "".join(f"{phase:>11s}" for phase in phases) + f"{'CG its':>9s}")
    for split, of_split in seconds.items():
        print(f"{split_text(split):>7s}{split[0] * split[1]:7d}" + "".join(f"{of_split[phase]:11.4f}" for phase in phases)
              + f"{of_split['cg']:9.0f}")
    for column in COLUMNS[1:]:
        print(f"\n{column.replace('_', ' ')}, baseline {split_text(baseline)}")
        for split in seconds:
            of_split = {row["phase"]: row[column] for row in rows if (row["groups"], row["domain_ranks"]) == split}
            print(f"{split_text(split):>7s}{split[0] * split[1]:7d}"
                  + "".join(f"{of_split[phase]:11.3f}" if of_split[phase] is not None else f"{'-':>11s}" for phase in phases))


def plot(path, title, rows, baseline):
    ranks = sorted({row["ranks"] for row in rows})
    total = [row for row in rows if row["phase"] == "total"]
    fastest = [min((row for row in total if row["ranks"] == count), key=lambda row: row["seconds"]) for count in ranks]
    start = baseline[0] * baseline[1]
    with program_run.figure(path, title, 2, figsize=(11, 4.5)) as (left, right):
        for phase in PHASES:
            of_phase = {(row["groups"], row["domain_ranks"]): row["seconds"] for row in rows if row["phase"] == phase}
            best = [of_phase[row["groups"], row["domain_ranks"]] for row in fastest]
            if max(best) > 0:
                left.loglog(ranks, best, "k-o" if phase == "total" else "-o", label=phase, markersize=4)
        for groups in sorted({row["groups"] for row in total}):
            points = sorted((row["ranks"], row["speed_up"]) for row in total if row["groups"] == groups)
            right.loglog(*zip(*points), "-o", label=f"{groups} group{'s' if groups > 1 else ''}", markersize=4)
        right.loglog(ranks, [count / start for count in ranks], "k:", label="ideal")
        for axes, label in ((left, "seconds per iteration, fastest split"), (right, f"speed-up over {split_text(baseline)}")):
            axes.set(xlabel="ranks", ylabel=label)
            axes.set_xticks(ranks, [str(count) for count in ranks])
            axes.minorticks_off()
        right.set_yticks([count / start for count in ranks], [f"{count / start:g}" for count in ranks])


def parse_arguments():
    parser = program_run.common_parser(__doc__)
    which = parser.add_mutually_exclusive_group()
    which.add_argument("--splits", nargs="+", type=parse_split, metavar="GxD", help="groups x domain ranks")
    which.add_argument("--ranks", nargs="+", type=int, default=[1, 2],
                       metavar="P", help="all splits of these numbers (default: 1 2)")
    parser.add_argument("--baseline", type=parse_split, metavar="GxD", help="one of the splits (default: the first)")
    options = program_run.parse_iterations(parser, "", "split and phase")
    if min(options.ranks) < 1:
        parser.error("--ranks: at least 1")
    if options.splits and options.baseline and options.baseline not in options.splits:
        parser.error("--baseline: one of --splits")
    return options


def main():
    options = parse_arguments()
    with tempfile.TemporaryDirectory() as directory:
        layers = program_run.problem_size(options, directory)["layer_count"]
        splits = options.splits or [split for ranks in options.ranks for split in splits_of(ranks, layers)]
        baseline = options.baseline or splits[0]
        if baseline not in splits:
            sys.exit(f"--baseline {split_text(baseline)} is not among the splits: {' '.join(map(split_text, splits))}")
        samples, triad = program_run.by_turns(options, splits,
                                              lambda split: measure(options, split, os.path.join(directory, "optimize")))
    seconds = {split: program_run.medians(of_split) for split, of_split in samples.items()}
    rows = table(seconds, baseline)
    title = f"{os.path.basename(options.config)}, {layers} layers, baseline {split_text(baseline)}"
    print(f"{title}, medians of {len(samples[baseline])} iterations, {program_run.machine_text(triad)}")
    print_table(seconds, rows, baseline)
    record = {"layers": layers, "baseline": baseline, "triad": triad, "table": rows,
              "samples": [{"groups": split[0], "domain_ranks": split[1], "iterations": of_split}
                          for split, of_split in samples.items()]}
    program_run.write_results(options, record, rows, lambda path: plot(path, title, rows, baseline))


if __name__ == "__main__":
    main()
