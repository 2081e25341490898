# SPDX-License-Identifier: MIT
"""Runs fabseq with one solver or another, and writes tables and pictures, for the scripts of this folder."""

import argparse
import contextlib
import os
import re
import statistics
import sys
import threading
import time

import numpy as np


from fabseq_tools.run import command_line
# Also for the scripts.
from fabseq_tools.run.command_line import RunError, parser_of, run_command, run_script, write_json, write_rows  # noqa: F401
from fabseq_tools.run.places import PROGRAM, ROOT  # noqa: F401
from fabseq_tools.run.read_run import read_fields, read_history, read_json  # noqa: F401

# Exit status of a run that was asked to stop.
STOPPED = 4
LANES = "lanes"
REFERENCES = ["multigrid", "gamg", "direct"]
METHODS = [LANES, *REFERENCES]
# Of a design iteration, as in history.jsonl.
PHASES = ["heat", "layers", "primal", "adjoint", "responses", "optimizer", "output", "total"]


def add_program_option(parser):
    parser.add_argument("--program", default=PROGRAM, help="default: build/release/fabseq")


def common_parser(description):
    """With the options that the scripts have in common."""
    parser = parser_of(description, epilog="Options after -- go to the program as they are.")
    parser.add_argument("config")
    add_program_option(parser)
    parser.add_argument("--repetitions", type=int, default=3, metavar="R",
                        help="runs of everything, by turns (default: %(default)s)")
    parser.add_argument("--launcher", default="mpirun -np {ranks}", metavar="COMMAND",
                        help="starts the program; {ranks} is replaced (default: %(default)s; in a job of Slurm: srun -n {ranks})")
    parser.add_argument("--json", metavar="FILE", help="write all figures there, those of single runs as well")
    return parser


def parse(parser):
    options = command_line.parse(parser)
    if options.repetitions < 1:
        parser.error("--repetitions: at least 1")
    options.title = os.path.basename(options.config)
    return options


def parse_iterations(parser, what, rows, iterations=5):
    """As parse(), for scripts that time the iterations of an optimization and leave a table and a picture;
    `what` says of what (with a colon, or ""), `rows` what a line stands for."""
    parser.add_argument("--iterations", type=int, default=iterations, metavar="I",
                        help="design iterations of a run (default: %(default)s)")
    parser.add_argument("--warm-up", type=int, default=1, metavar="W",
                        help="the first W of them do not count (default: %(default)s)")
    parser.add_argument("--csv", metavar="FILE", help=f"{what}a line per {rows}")
    parser.add_argument("--plot", metavar="FILE", help=f"{what}a picture")
    options = parse(parser)
    if not 0 <= options.warm_up < options.iterations:
        parser.error("--warm-up: fewer than --iterations")
    return options


def parse_split(text):
    found = re.fullmatch(r"([1-9]\d*)x([1-9]\d*)", text)
    if not found:
        raise argparse.ArgumentTypeError(f"'{text}' is not GROUPSxRANKS, such as 2x4")
    return int(found[1]), int(found[2])


def split_text(split):
    return f"{split[0]}x{split[1]}"


def method_options(method, tolerance):
    path = ["lanes"] if method == LANES else ["reference", "-reference_method", method]
    return ["-solver_path", *path, "-tolerance", tolerance]


def run(options, ranks, directory, arguments, **more):
    """What the program printed. The options behind -- come first, so that the script's own win, such as a
    single layer where nothing is timed."""
    command = [*options.launcher.format(ranks=ranks).split(), options.program, "-config", options.config, "-output", directory,
               "-overwrite", *options.rest, *(f"{a:.3g}" if isinstance(a, float) else a for a in arguments)]
    return run_command(command, **more).stdout


def iterate(options, ranks, directory, arguments, planned=None, **more):
    """The history of a short optimization that writes no fields: of `options.iterations` design iterations,
    or as many as are `planned`."""
    run(options, ranks, directory,
        ["-max_iterations", planned or options.iterations, "-output_every", 0, "-checkpoint_every", 0, *arguments], **more)
    return read_history(directory)


def iterate_only(options, ranks, directory, arguments):
    """As iterate(), of a run that is stopped before the reports at its end: on the reference path they take
    longer than an iteration. One iteration more is planned, so that the run does not come to its end, unless
    that is over in milliseconds, before it can be asked."""
    with stop_after(directory, options.iterations):
        lines = iterate(options, ranks, directory, arguments, options.iterations + 1, statuses=(0, STOPPED))
    return lines[:options.iterations]


@contextlib.contextmanager
def stop_after(directory, iterations):
    """Asks the run that begins in this directory meanwhile to stop after so many iterations."""
    config = os.path.join(directory, "config.json")
    before = os.path.getmtime(config) if os.path.exists(config) else None
    ended = threading.Event()

    def ask():
        while not ended.wait(0.02):
            if os.path.exists(config) and os.path.getmtime(config) != before:
                stop = os.path.join(directory, "stop")
                with open(stop + ".partial", "w", encoding="utf-8") as file:
                    file.write(str(iterations))
                os.replace(stop + ".partial", stop)  # an empty file would stop the run at once
                return

    asking = threading.Thread(target=ask)
    asking.start()
    try:
        yield
    finally:
        ended.set()
        asking.join()


def time_iterations(options, ranks, directory, arguments):
    """Of each iteration after the warm-up: seconds by phase, CG iterations of all layers, memory's peak."""
    return [{**line["seconds"], "gigabytes": line["peak_memory_bytes"] / 1e9,
             "cg": sum(sum(line["solver_iterations"][kind]) for kind in ("primal", "adjoint"))}
            for line in iterate_only(options, ranks, directory, arguments)[options.warm_up:]]


def median_iteration(options, ranks, directory, arguments):
    """Median of every figure of time_iterations(), over all repetitions."""
    return medians([line for _ in range(options.repetitions)
                    for line in time_iterations(options, ranks, directory, arguments)])


def resolved_config(options, directory):
    """The config with all defaults and the program's options in it, but a single layer, which is run."""
    run(options, 1, directory, ["-task", "simulate", "-layers", 1])
    return read_json(directory, "config.json")


def problem_size(options, directory, arguments=()):
    """Elements of part and box, unknowns of a layer, number of layers, as `-task check` prints them."""
    printed = run(options, 1, directory, ["-task", "check", *arguments])
    part, box = re.search(r"part: (\d+) elements of (\d+)", printed).groups()
    return {"part_elements": int(part), "elements": int(box),
            "unknowns": int(re.search(r"one layer: (\d+) unknowns", printed)[1]),
            "layer_count": int(re.search(r"layers: (\d+) curved", printed)[1])}


def cells(record, keys, form):
    """Figures of a line of a table; - where there is none."""
    width = re.match(r"\d+", form)[0]
    return "".join(f"{'-':>{width}}" if record.get(key) is None else format(record[key], form) for key in keys)


def heads(names, width):
    return "".join(f"{name:>{width}}" for name in names)


def write_results(options, record, rows=(), draw=None):
    """What --csv, --plot and --json ask for."""
    if rows and options.csv:
        write_rows(options.csv, rows)
    if draw and options.plot:
        draw(options.plot)
    if options.json:
        write_json(options.json, {"config": options.config, "arguments": sys.argv[1:], **record})


@contextlib.contextmanager
def figure(path, title, columns=1, **options):
    """Axes of a picture that is written in the end."""
    import matplotlib.pyplot as plt

    whole, axes = plt.subplots(1, columns, **options)
    yield axes
    for each in np.atleast_1d(axes):
        each.grid(alpha=0.3, which="both")
        each.legend(fontsize=8)
    whole.suptitle(title, fontsize=10)
    whole.tight_layout()
    whole.savefig(path, dpi=100)


def draw_phases(axes, abscissa, records):
    """Curves of the phases that take time, the total in black."""
    for phase in PHASES:
        values = [record[phase] for record in records]
        if min(values) > 0:
            axes.loglog(abscissa, values, "k-o" if phase == "total" else "-o", label=phase, markersize=4)


def by_turns(options, keys, measure):
    """Samples of each key, lists made by measure(key) in turn, and the machine before and after, as by
    machine_after()."""
    samples, machine = {key: [] for key in keys}, machine_before()
    for _ in range(options.repetitions):
        for key in keys:
            samples[key] += measure(key)
    return samples, machine_after(machine)


def machine_before():
    """Before a measurement: the cores that this process may use, the share of their time that they are busy
    with other work (None if the system does not tell), and the triad's GB/s."""
    return {**cores(), "busy": busy_share(), "triad": [triad_bandwidth()]}


def machine_after(before):
    """With the triad after the measurement, too."""
    return {**before, "triad": [*before["triad"], triad_bandwidth()]}


def machine_text(machine):
    busy = "unknown" if machine["busy"] is None else f"{100 * machine['busy']:.0f} %"
    first, last = machine["triad"]
    return (f"{machine['cores']} cores ({machine['threads']} threads), {busy} busy before, "
            f"triad {first:.1f} and {last:.1f} GB/s per core before and after")


def cores():
    """Physical cores and hardware threads that this process may use; a thread whose core is not known counts
    as one."""
    threads = os.sched_getaffinity(0)

    def core_of(thread):
        try:
            with open(f"/sys/devices/system/cpu/cpu{thread}/topology/thread_siblings_list", encoding="ascii") as file:
                return file.read()
        except OSError:
            return thread

    return {"cores": len({core_of(thread) for thread in threads}), "threads": len(threads)}


def busy_share(seconds=0.5):
    """Share of that time for which the threads that this process may use are busy, while it sleeps."""
    def times():
        """Ticks by thread: busy, and idle or waiting for a disk."""
        found = {}
        with open("/proc/stat", encoding="ascii") as file:
            for name, *ticks in map(str.split, file):
                if re.fullmatch(r"cpu\d+", name) and int(name[3:]) in os.sched_getaffinity(0):
                    ticks = [int(word) for word in ticks[:8]]
                    found[name] = np.array([sum(ticks) - sum(ticks[3:5]), sum(ticks[3:5])])
        return found

    try:
        before = times()
        time.sleep(seconds)
        busy, idle = sum(now - before[name] for name, now in times().items())
    except (OSError, KeyError, TypeError, ValueError):
        return None
    return float(busy / (busy + idle)) if busy + idle else None


def medians(samples):
    """Median of every figure of a list of records."""
    return {key: statistics.median(sample[key] for sample in samples) for key in samples[0]}


def triad_bandwidth():
    """GB/s of a = b + s c on one core, best of five; numpy does it in two steps of five words in all."""
    b, c = np.ones(8_000_000), np.ones(8_000_000)
    a = np.empty_like(b)
    seconds = []
    for _ in range(5):
        start = time.perf_counter()
        np.multiply(c, 3.0, out=a)
        np.add(a, b, out=a)
        seconds.append(time.perf_counter() - start)
    return 5 * 8 * a.size / min(seconds) / 1e9
