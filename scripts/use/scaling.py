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

import statistics

from command_line import RunError, parser_of, run_script, write_rows
from drawing import INK, SOFT_INK, save, tidy  # before matplotlib

import matplotlib.pyplot as plt
from matplotlib.ticker import FixedLocator, NullLocator, ScalarFormatter

from read_run import read_history, read_json

PHASES = {"heat": "#c2452d", "layers": "#d59f3b", "primal": "#1f6f8b", "adjoint": "#7a4fa3", "responses": "#3c7d3c",
          "optimizer": "#8a5a44", "output": "#6b727b"}


class Measurement:
    """Ranks, number of iterations that were measured, and their median seconds by phase, "total" included."""

    def __init__(self, directory, warm_up):
        config = read_json(directory, "config.json")
        self.ranks = config["run"]["ranks"]
        self.problem = {key: value for key, value in config.items() if key not in ("name", "run", "output")}
        lines = read_history(directory)[warm_up:]
        if not lines:
            raise RunError(f"{directory}: no iteration after the first {warm_up}")
        self.iterations = len(lines)
        self.seconds = {key: statistics.median(line["seconds"][key] for line in lines) for key in lines[0]["seconds"]}


def row_of(measurement, baseline):
    q = measurement.ranks / baseline.ranks
    ratio = measurement.seconds["total"] / baseline.seconds["total"]
    row = {"ranks": measurement.ranks, "baseline_ranks": baseline.ranks, "iterations": measurement.iterations,
           "seconds": measurement.seconds["total"], "speed_up": 1 / ratio, "efficiency": 1 / (ratio * q),
           "karp_flatt": (ratio - 1 / q) / (1 - 1 / q) if q > 1 else None}
    for phase in PHASES:
        seconds = measurement.seconds[phase]
        row |= {phase: seconds, f"{phase}_speed_up": baseline.seconds[phase] / seconds if seconds > 0 else None}
    return row


def draw(rows):
    figure, (time, speed) = plt.subplots(1, 2, figsize=(11.0, 4.6), constrained_layout=True)
    ranks = [row["ranks"] for row in rows]
    ideal = [rank / ranks[0] for rank in ranks]
    for axis, key, values, label in ((time, "seconds", [rows[0]["seconds"] / q for q in ideal], "seconds per iteration, median"),
                                     (speed, "speed_up", ideal, f"speed-up over {ranks[0]} rank" + "s" * (ranks[0] > 1))):
        axis.plot(ranks, [row[key] for row in rows], "o-", color=INK, lw=2.0, label="iteration")
        axis.plot(ranks, values, "--", color=SOFT_INK, lw=1.0, label="ideal")
        axis.set_ylabel(label)
    for phase, colour in PHASES.items():
        if rows[0][phase] >= 0.01 * rows[0]["seconds"]:
            time.plot(ranks, [row[phase] for row in rows], "o-", ms=3.5, lw=1.2, color=colour, label=phase)
    tidy((time, speed))
    for axis in (time, speed):
        axis.set_xscale("log")
        axis.set_yscale("log")
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
    measurements = sorted((Measurement(d, arguments.warm_up) for d in arguments.directories), key=lambda m: m.ranks)
    if any(m.problem != measurements[0].problem for m in measurements):
        raise RunError("the runs have different configs; scripts/use/compare.py says in what")
    if len({m.ranks for m in measurements}) < len(measurements):
        raise RunError("two runs have the same number of ranks")
    rows = [row_of(m, measurements[0]) for m in measurements]
    write_rows(arguments.table, rows)
    print(f"{'ranks':>6s}{'seconds':>10s}{'speed-up':>10s}{'efficiency':>12s}{'Karp-Flatt':>12s}")
    for row in rows:
        fraction = "" if row["karp_flatt"] is None else f"{row['karp_flatt']:.3f}"
        print(f"{row['ranks']:6d}{row['seconds']:10.3f}{row['speed_up']:10.2f}{row['efficiency']:12.2f}{fraction:>12s}")
    print(arguments.table)
    save(draw(rows), arguments.picture, 120)


if __name__ == "__main__":
    run_script(main)
