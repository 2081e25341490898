#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Strong scaling: seconds of an iteration over the number of ranks, from runs of the same config.

    scripts/use/scaling.py OUTPUT_DIRECTORY... [--table scaling.csv] [--picture scaling.png] [--warm_up 2]

A run is measured by the medians, over its iterations after the first `warm_up`, of the total and of each
phase. The run with the fewest ranks, b, is the baseline of all others: with t the seconds on p ranks and q =
p / b

    speed-up t_b / t,    efficiency t_b / (t q),    serial fraction (Karp-Flatt) (t / t_b - 1/q) / (1 - 1/q)

so that all three are relative to b ranks, not to one.
"""

import json
import statistics
import sys

from drawing import INK, SOFT_INK, parser_of, tidy, write_rows  # before matplotlib

import matplotlib.pyplot as plt
from matplotlib.ticker import FixedLocator, NullLocator, ScalarFormatter

from read_run import RunError, open_text, read_json

PHASES = ["heat", "layers", "primal", "adjoint", "responses", "optimizer", "output"]
COLOURS = ["#c2452d", "#d59f3b", "#1f6f8b", "#7a4fa3", "#3c7d3c", "#8a5a44", "#6b727b"]


class Measurement:
    """Ranks, number of iterations that were measured, and their median seconds: `seconds["total"]` and a
    phase each."""

    def __init__(self, directory, warm_up):
        self.config = read_json(directory, "config.json")
        self.ranks = self.config["run"]["ranks"]
        with open_text(directory, "history.jsonl") as file:
            lines = [json.loads(line) for line in file if line.endswith("\n")][warm_up:]
        if not lines:
            raise RunError(f"{directory}: no iteration after the first {warm_up}")
        self.iterations = len(lines)
        self.seconds = {key: statistics.median(line["seconds"][key] for line in lines) for key in lines[0]["seconds"]}

    def problem(self):
        """What must be the same to be compared."""
        return {key: value for key, value in self.config.items() if key not in ("name", "run", "output")}


def row_of(measurement, baseline):
    q = measurement.ranks / baseline.ranks
    ratio = measurement.seconds["total"] / baseline.seconds["total"]
    row = {"ranks": measurement.ranks, "baseline_ranks": baseline.ranks, "iterations": measurement.iterations,
           "seconds": measurement.seconds["total"], "speed_up": 1 / ratio, "efficiency": 1 / (ratio * q),
           "karp_flatt": (ratio - 1 / q) / (1 - 1 / q) if q > 1 else None}
    for phase in PHASES:
        row[phase] = measurement.seconds[phase]
        seconds = measurement.seconds[phase]
        row[f"{phase}_speed_up"] = baseline.seconds[phase] / seconds if seconds > 0 else None
    return row


def draw(rows):
    figure, (time, speed) = plt.subplots(1, 2, figsize=(11.0, 4.6), constrained_layout=True)
    ranks = [row["ranks"] for row in rows]
    ideal = [rank / ranks[0] for rank in ranks]
    time.plot(ranks, [row["seconds"] for row in rows], "o-", color=INK, lw=2.0, label="iteration")
    time.plot(ranks, [rows[0]["seconds"] / q for q in ideal], "--", color=SOFT_INK, lw=1.0, label="ideal")
    least = 0.01 * rows[0]["seconds"]
    for phase, colour in zip(PHASES, COLOURS):
        if rows[0][phase] >= least:
            time.plot(ranks, [row[phase] for row in rows], "o-", ms=3.5, lw=1.2, color=colour, label=phase)
    time.set_yscale("log")
    time.set_ylabel("seconds per iteration, median")
    speed.plot(ranks, [row["speed_up"] for row in rows], "o-", color=INK, lw=2.0, label="iteration")
    speed.plot(ranks, ideal, "--", color=SOFT_INK, lw=1.0, label="ideal")
    speed.set_yscale("log")
    speed.set_ylabel(f"speed-up over {ranks[0]} rank" + "s" * (ranks[0] > 1))
    tidy((time, speed))
    for axis in (time, speed):
        axis.set_xscale("log")
        axis.set_xlabel("ranks")
        axis.xaxis.set_major_locator(FixedLocator(ranks))
        axis.xaxis.set_minor_locator(NullLocator())
        axis.xaxis.set_major_formatter(ScalarFormatter())
        axis.yaxis.set_major_formatter("{x:g}")
        axis.legend(frameon=False, fontsize=9)
    return figure


def main():
    parser = parser_of(__doc__)
    parser.add_argument("directories", nargs="+", metavar="OUTPUT_DIRECTORY")
    parser.add_argument("--table", default="scaling.csv", help="table to write (default: %(default)s)")
    parser.add_argument("--picture", default="scaling.png", help="picture to write (default: %(default)s)")
    parser.add_argument("--warm_up", type=int, default=2, metavar="N", help="iterations left out (default: %(default)s)")
    arguments = parser.parse_args()
    try:
        measurements = sorted((Measurement(d, arguments.warm_up) for d in arguments.directories), key=lambda m: m.ranks)
    except RunError as error:
        sys.exit(f"scaling.py: {error}")
    if any(m.problem() != measurements[0].problem() for m in measurements):
        sys.exit("scaling.py: the runs have different configs; scripts/use/compare.py says in what")
    if len({m.ranks for m in measurements}) < len(measurements):
        sys.exit("scaling.py: two runs have the same number of ranks")
    rows = [row_of(m, measurements[0]) for m in measurements]
    write_rows(arguments.table, rows, rows[0])
    draw(rows).savefig(arguments.picture, dpi=120)
    print(f"{'ranks':>6s}{'seconds':>10s}{'speed-up':>10s}{'efficiency':>12s}{'Karp-Flatt':>12s}")
    for row in rows:
        fraction = "" if row["karp_flatt"] is None else f"{row['karp_flatt']:.3f}"
        print(f"{row['ranks']:6d}{row['seconds']:10.3f}{row['speed_up']:10.2f}{row['efficiency']:12.2f}{fraction:>12s}")
    print(arguments.table, arguments.picture, sep="\n")


if __name__ == "__main__":
    main()
