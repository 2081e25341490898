# SPDX-License-Identifier: MIT
"""Draws strong scaling: seconds of an iteration over the number of ranks.

    fabseq-tools scaling OUTPUT_DIRECTORY... [--table scaling.csv] [--picture scaling.png] [--warm_up 2]

The runs are those of one config. Each is measured by the medians, over its iterations after the first
`warm_up`, of the total and of each phase. The run with the fewest ranks, b, is the baseline of all others:
with t the seconds on p ranks and q = p / b

    speed-up t_b / t,    efficiency t_b / (t q),    serial fraction (Karp-Flatt) (t / t_b - 1/q) / (1 - 1/q)

so that all three are relative to b ranks, not to one.
"""

import statistics

import matplotlib.pyplot as plt
from matplotlib.ticker import FixedLocator, NullLocator, ScalarFormatter

from fabseq_tools.plot.drawing import INK, SOFT_INK, save, tidy
from fabseq_tools.run.command_line import RunError, parser_of, whole_number, write_rows
from fabseq_tools.run.read_run import read_history, read_json
from fabseq_tools.run.settings import NOT_COMPARED

COMMAND = "scaling"

PHASES = {"heat": "#c2452d", "layers": "#d59f3b", "primal": "#1f6f8b", "adjoint": "#7a4fa3", "responses": "#3c7d3c",
          "optimizer": "#8a5a44", "output": "#6b727b"}


def measure(directory, warm_up):
    """What must be the same to be compared; ranks, number of iterations, their median seconds by phase."""
    config, lines = read_json(directory, "config.json"), read_history(directory)[warm_up:]
    if not lines:
        raise RunError(f"{directory}: no iteration after the first {warm_up}")
    problem = {key: value for key, value in config.items() if key not in NOT_COMPARED}
    seconds = {key: statistics.median(line["seconds"][key] for line in lines) for key in ["total", *PHASES]}
    return problem, {"ranks": config["run"]["ranks"], "iterations": len(lines),
                     "seconds": seconds.pop("total"), **seconds}


def compared(run, baseline):
    q, ratio = run["ranks"] / baseline["ranks"], run["seconds"] / baseline["seconds"]
    row = {"ranks": run["ranks"], "baseline_ranks": baseline["ranks"], "iterations": run["iterations"],
           "seconds": run["seconds"], "speed_up": 1 / ratio, "efficiency": 1 / (ratio * q),
           "karp_flatt": (ratio - 1 / q) / (1 - 1 / q) if q > 1 else None}
    for phase in PHASES:
        row |= {phase: run[phase], f"{phase}_speed_up": baseline[phase] / run[phase] if run[phase] > 0 else None}
    return row


def draw(rows):
    figure, (time, speed) = plt.subplots(1, 2, figsize=(11.0, 4.6), constrained_layout=True)
    ranks = [row["ranks"] for row in rows]
    ideal = [rank / ranks[0] for rank in ranks]
    ideal_seconds = [rows[0]["seconds"] / q for q in ideal]
    speed_label = f"speed-up over {ranks[0]} rank" + "s" * (ranks[0] > 1)
    for axis, key, values, label in ((time, "seconds", ideal_seconds, "seconds per iteration, median"),
                                     (speed, "speed_up", ideal, speed_label)):
        axis.plot(ranks, [row[key] for row in rows], "o-", color=INK, lw=2.0, label="iteration")
        axis.plot(ranks, values, "--", color=SOFT_INK, lw=1.0, label="ideal")
        axis.set_ylabel(label)
    for phase, colour in PHASES.items():
        if rows[0][phase] >= 0.01 * rows[0]["seconds"]:
            time.plot(ranks, [row[phase] for row in rows], "o-", ms=3.5, lw=1.2, color=colour, label=phase)
    tidy((time, speed))
    for axis in (time, speed):
        axis.set(xscale="log", yscale="log", xlabel="ranks")
        axis.xaxis.set_major_locator(FixedLocator(ranks))
        axis.xaxis.set_minor_locator(NullLocator())
        axis.xaxis.set_major_formatter(ScalarFormatter())
        axis.yaxis.set_major_formatter("{x:g}")
        axis.legend(frameon=False, fontsize=9)
    return figure


def main(words):
    parser = parser_of(__doc__, COMMAND)
    parser.add_argument("directories", nargs="+", metavar="OUTPUT_DIRECTORY")
    parser.add_argument("--table", default="scaling.csv", help="table to write (default: %(default)s)")
    parser.add_argument("--picture", default="scaling.png", help="picture to write (default: %(default)s)")
    parser.add_argument("--warm_up", type=whole_number(0), default=2, metavar="N",
                        help="iterations left out (default: %(default)s)")
    arguments = parser.parse_args(words)
    runs = [measure(directory, arguments.warm_up) for directory in arguments.directories]
    if any(problem != runs[0][0] for problem, _ in runs):
        raise RunError("the runs have different configs; fabseq-tools compare says in what")
    runs = sorted((run for _, run in runs), key=lambda run: run["ranks"])
    if len({run["ranks"] for run in runs}) < len(runs):
        raise RunError("two runs have the same number of ranks")
    rows = [compared(run, runs[0]) for run in runs]
    write_rows(arguments.table, rows)
    print(f"{'ranks':>6s}{'seconds':>10s}{'speed-up':>10s}{'efficiency':>12s}{'Karp-Flatt':>12s}")
    for row in rows:
        fraction = "" if row["karp_flatt"] is None else f"{row['karp_flatt']:.3f}"
        print(f"{row['ranks']:6d}{row['seconds']:10.3f}{row['speed_up']:10.2f}{row['efficiency']:12.2f}{fraction:>12s}")
    print(arguments.table)
    save(draw(rows), arguments.picture, 120)
