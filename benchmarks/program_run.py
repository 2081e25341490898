# SPDX-License-Identifier: MIT
"""Runs fabseq with one solver or another, and writes tables and pictures, for the scripts of this folder."""

import argparse
import contextlib
import csv
import json
import os
import re
import statistics
import subprocess
import sys
import time

import numpy as np

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
LANES = "lanes"
REFERENCES = ["multigrid", "gamg", "direct"]
METHODS = [LANES, *REFERENCES]
# Of a design iteration, as in history.jsonl.
PHASES = ["heat", "layers", "primal", "adjoint", "responses", "optimizer", "output", "total"]


def built(name):
    return os.path.join(ROOT, "build/release", name)


def add_program_option(parser):
    parser.add_argument("--program", default=built("fabseq"), help="default: build/release/fabseq")


def make_parser(description):
    return argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter,
                                   epilog="Options after -- go to the program as they are.")


def common_parser(description):
    """With the options that the scripts have in common."""
    parser = make_parser(description)
    parser.add_argument("config")
    add_program_option(parser)
    parser.add_argument("--repetitions", type=int, default=3, metavar="R",
                        help="runs of everything, by turns (default: %(default)s)")
    parser.add_argument("--launcher", default="mpirun -np {ranks}", metavar="COMMAND",
                        help="starts the program; {ranks} is replaced (default: %(default)s; in a job of Slurm: srun -n {ranks})")
    parser.add_argument("--json", metavar="FILE", help="write all figures there, those of single runs as well")
    return parser


def parse(parser):
    """The script's options, and as `rest` those of the program."""
    words = sys.argv[1:]
    end = words.index("--") if "--" in words else len(words)
    options = parser.parse_args(words[:end])
    options.rest = words[end + 1:]
    if "repetitions" in options and options.repetitions < 1:
        parser.error("--repetitions: at least 1")
    return options


def parse_split(text):
    try:
        groups, domain = (int(word) for word in text.split("x"))
    except ValueError:
        raise argparse.ArgumentTypeError(f"'{text}' is not GROUPSxRANKS, such as 2x4") from None
    if groups < 1 or domain < 1:
        raise argparse.ArgumentTypeError(f"'{text}': both at least 1")
    return groups, domain


def split_text(split):
    return f"{split[0]}x{split[1]}"


def method_options(method, tolerance):
    if method == LANES:
        return ["-solver_path", "lanes", "-tolerance", tolerance]
    return ["-solver_path", "reference", "-reference_method", method, "-tolerance", tolerance]


def run_command(command, accept=lambda: False, **more):
    """Runs it in the environment of all scripts, where there may be more ranks than cores; ends the script if
    it failed, unless accept() says that what it left is enough."""
    in_environment = 'source "$0"; allow_more_ranks_than_cores; exec "$@"'
    result = subprocess.run(["bash", "-c", in_environment, os.path.join(ROOT, "scripts/environment.sh"), *map(str, command)],
                            capture_output=True, text=True, **more)
    if result.returncode != 0 and not accept():
        sys.exit(f"status {result.returncode}: {' '.join(map(str, command))}\n{result.stderr.strip()}")
    return result


def run(options, ranks, directory, arguments, partial=None):
    """What the program printed; ends the script if the run failed and did not even write the file
    `partial`."""
    command = [*options.launcher.format(ranks=ranks).split(), options.program, "-config", options.config, "-output", directory,
               "-overwrite", *(f"{a:.3g}" if isinstance(a, float) else a for a in arguments), *options.rest]
    return run_command(command, lambda: bool(partial) and os.path.exists(os.path.join(directory, partial))).stdout


def read_json(directory, name):
    with open(os.path.join(directory, name), encoding="utf-8") as file:
        return json.load(file)


def read_lines(directory, name):
    """Of a file with a JSON object per line."""
    with open(os.path.join(directory, name), encoding="utf-8") as file:
        return [json.loads(line) for line in file]


def iterate(options, ranks, directory, arguments):
    """Lines of the history of a short optimization that writes no fields: `options.iterations` design
    iterations."""
    arguments = ["-max_iterations", options.iterations, "-output_every", 0, "-checkpoint_every", 0, *arguments]
    run(options, ranks, directory, arguments)
    return read_lines(directory, "history.jsonl")


def resolved_config(options, directory):
    """The config with the options of the program and all defaults in it, but for a single layer: one is
    simulated for it."""
    run(options, 1, directory, ["-task", "simulate", "-layers", 1])
    return read_json(directory, "config.json")


def problem_size(options, directory, arguments=()):
    """Elements of the part and of the box, unknowns of a layer and number of layers, as `-task check` prints
    them."""
    printed = run(options, 1, directory, ["-task", "check", *arguments])
    part, box = re.search(r"part: (\d+) elements of (\d+)", printed).groups()
    return {"part_elements": int(part), "elements": int(box),
            "unknowns": int(re.search(r"one layer: (\d+) unknowns", printed)[1]),
            "layer_count": int(re.search(r"layers: (\d+) curved", printed)[1])}


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


def write_json(path, record):
    with open(path, "w", encoding="utf-8") as file:
        json.dump(record, file, indent=1)
        file.write("\n")


def write_csv(path, rows):
    """Records with the same keys."""
    with open(path, "w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, fieldnames=list(rows[0]))
        writer.writeheader()
        writer.writerows(rows)


def write_results(options, record, rows=(), draw=None):
    """What --csv, --plot and --json ask for."""
    if rows and options.csv:
        write_csv(options.csv, rows)
    if draw and options.plot:
        draw(options.plot)
    if options.json:
        write_json(options.json, {"config": options.config, "arguments": sys.argv[1:], **record})


@contextlib.contextmanager
def figure(path, title, columns=1, **options):
    """Axes of a picture that is written in the end."""
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    whole, axes = plt.subplots(1, columns, **options)
    yield axes
    for each in np.atleast_1d(axes):
        each.grid(alpha=0.3, which="both")
        each.legend(fontsize=8)
    whole.suptitle(title, fontsize=10)
    whole.tight_layout()
    whole.savefig(path, dpi=100)


def by_turns(options, keys, measure):
    """Samples of each key, measure(key) being a list of some, over the repetitions, which run by turns; and
    the triad's GB/s before and after."""
    samples, before = {key: [] for key in keys}, triad_bandwidth()
    for _ in range(options.repetitions):
        for key in keys:
            samples[key] += measure(key)
    return samples, [before, triad_bandwidth()]


def machine_text(triad):
    return f"{os.cpu_count()} cores, triad {triad[0]:.1f} and {triad[1]:.1f} GB/s per core before and after"


def medians(samples):
    """Median of every figure of a list of records."""
    return {key: statistics.median(sample[key] for sample in samples) for key in samples[0]}


def triad_bandwidth():
    """GB/s of a = b + s c on one core, best of five; numpy does it in two steps of five words in all."""
    b, c = np.ones(8_000_000), np.ones(8_000_000)
    a = np.empty_like(b)
    best = 0.0
    for _ in range(5):
        start = time.perf_counter()
        np.multiply(c, 3.0, out=a)
        np.add(a, b, out=a)
        best = max(best, 5 * 8 * a.size / (time.perf_counter() - start) / 1e9)
    return best
