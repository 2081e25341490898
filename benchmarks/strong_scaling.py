#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Strong scaling: seconds of a design iteration by phase, over groups x domain ranks, against one baseline:

    benchmarks/strong_scaling.py benchmarks/v_shape.json --ranks 1 2 4 --csv v.csv --plot v.png [-- OPTIONS]
    benchmarks/strong_scaling.py benchmarks/v_shape.json --splits 1x1 2x1 1x2 4x16 --baseline 1x1

A split GxD is G layer groups of D domain ranks each, on G D ranks. --ranks takes all splits of each number of
ranks, with no more groups than layers. Figures are medians over the iterations after the warm-up, of all
repetitions; these run by turns. docs/developer/measuring.md defines speed-up, efficiency and serial fraction
(Karp and Flatt 1990); P0 and P are both in ranks there, so that a baseline of 4 ranks has an efficiency of 1.
"""
import math
import os
import tempfile

import program_run
from program_run import PHASES, RunError, parse_split, split_text


def splits_of(ranks, layers):
    return [(groups, ranks // groups) for groups in range(1, min(ranks, layers) + 1) if ranks % groups == 0]


def row_of(split, phase, seconds, baseline_seconds, more):
    """Seconds, speed-up, efficiency and Karp-Flatt serial fraction; None where there is none."""
    row = {"groups": split[0], "domain_ranks": split[1], "ranks": math.prod(split), "phase": phase, "seconds": seconds,
           "speed_up": baseline_seconds / seconds if seconds > 0 else None, "efficiency": None, "serial_fraction": None}
    if row["speed_up"]:
        row["efficiency"] = row["speed_up"] / more
        row["serial_fraction"] = (1.0 / row["speed_up"] - 1.0 / more) / (1.0 - 1.0 / more) if more != 1.0 else None
    return row


def table(seconds, baseline):
    """A record per split and phase."""
    return [row_of(split, phase, of_split[phase], seconds[baseline][phase], math.prod(split) / math.prod(baseline))
            for split, of_split in seconds.items() for phase in PHASES]


def print_table(seconds, rows, baseline):
    phases = [phase for phase in PHASES if phase != "output"]
    print(f"{'split':>7s}{'ranks':>7s}" + program_run.heads(phases, 11) + f"{'CG its':>9s}")
    for split, of_split in seconds.items():
        print(f"{split_text(split):>7s}{math.prod(split):7d}" + program_run.cells(of_split, phases, "11.4f")
              + f"{of_split['cg']:9.0f}")
    for column in ("speed_up", "efficiency", "serial_fraction"):
        print(f"\n{column.replace('_', ' ')}, baseline {split_text(baseline)}")
        for split in seconds:
            of_split = {row["phase"]: row[column] for row in rows if (row["groups"], row["domain_ranks"]) == split}
            print(f"{split_text(split):>7s}{math.prod(split):7d}" + program_run.cells(of_split, phases, "11.3f"))


def plot(path, title, seconds, baseline):
    ranks, start = sorted({math.prod(split) for split in seconds}), math.prod(baseline)
    fastest = [min((of_split for split, of_split in seconds.items() if math.prod(split) == count),
                   key=lambda of_split: of_split["total"]) for count in ranks]
    with program_run.figure(path, title, 2, figsize=(11, 4.5)) as (left, right):
        program_run.draw_phases(left, ranks, fastest)
        for groups in sorted({split[0] for split in seconds}):
            points = sorted((math.prod(split), seconds[baseline]["total"] / of_split["total"])
                            for split, of_split in seconds.items() if split[0] == groups)
            right.loglog(*zip(*points), "-o", label=f"{groups} group{'s' * (groups > 1)}", markersize=4)
        right.loglog(ranks, [count / start for count in ranks], "k:", label="ideal")
        for axes, label in ((left, "seconds per iteration, fastest split"),
                            (right, f"speed-up over {split_text(baseline)}")):
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
    return options


def main():
    options = parse_arguments()
    with tempfile.TemporaryDirectory() as directory:
        layers = program_run.problem_size(options, directory)["layer_count"]
        splits = options.splits or [split for ranks in options.ranks for split in splits_of(ranks, layers)]
        baseline = options.baseline or splits[0]
        if baseline not in splits:
            among = " ".join(map(split_text, splits))
            raise RunError(f"--baseline {split_text(baseline)} is not among the splits: {among}")
        samples, machine = program_run.by_turns(options, splits, lambda split: program_run.time_iterations(
            options, math.prod(split), os.path.join(directory, "optimize"), ["-layer_groups", split[0]]))
    seconds = {split: program_run.medians(of_split) for split, of_split in samples.items()}
    rows = table(seconds, baseline)
    title = f"{options.title}, {layers} layers, baseline {split_text(baseline)}"
    print(f"{title}, medians of {len(samples[baseline])} iterations, {program_run.machine_text(machine)}")
    print_table(seconds, rows, baseline)
    record = {"layers": layers, "baseline": baseline, "machine": machine, "table": rows,
              "samples": [{"groups": split[0], "domain_ranks": split[1], "iterations": of_split}
                          for split, of_split in samples.items()]}
    program_run.write_results(options, record, rows, lambda path: plot(path, title, seconds, baseline))


if __name__ == "__main__":
    program_run.run_script(main)
