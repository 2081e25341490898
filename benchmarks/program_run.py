# SPDX-License-Identifier: MIT
"""Runs fabseq with one solver or another, for the scripts of this folder."""

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


def add_common_options(parser):
    parser.add_argument("config")
    parser.add_argument("--repetitions", type=int, default=3, metavar="R",
                        help="runs of everything, by turns (default: %(default)s)")
    parser.add_argument("--program", default=os.path.join(ROOT, "build/release/fabseq"), help="default: build/release/fabseq")
    parser.add_argument("--launcher", default="mpirun -np {ranks}", metavar="COMMAND",
                        help="starts the program; {ranks} is replaced (default: %(default)s; in a job of Slurm: srun -n {ranks})")
    parser.add_argument("--json", metavar="FILE", help="write all figures there, those of single runs as well")
    parser.epilog = "Options after -- go to the program as they are."


def parse(parser):
    """The script's options, and as `rest` those of the program."""
    words = sys.argv[1:]
    end = words.index("--") if "--" in words else len(words)
    options = parser.parse_args(words[:end])
    options.rest = words[end + 1:]
    if options.repetitions < 1:
        parser.error("--repetitions: at least 1")
    return options


def method_options(method, tolerance):
    if method == LANES:
        return ["-solver_path", "lanes", "-tolerance", tolerance]
    return ["-solver_path", "reference", "-reference_method", method, "-tolerance", tolerance]


def run(options, ranks, directory, arguments, partial=None):
    """Seconds of the run and what it printed; ends the script if the run failed and did not even write the file `partial`."""
    command = [*options.launcher.format(ranks=ranks).split(), options.program, "-config", options.config, "-output", directory, "-overwrite",
               *(f"{a:.3g}" if isinstance(a, float) else str(a) for a in arguments), *options.rest]
    start = time.perf_counter()
    result = subprocess.run(command, capture_output=True, text=True)
    if result.returncode != 0 and not (partial and os.path.exists(os.path.join(directory, partial))):
        sys.exit(f"status {result.returncode}: {' '.join(command)}\n{result.stderr.strip()}")
    return time.perf_counter() - start, result.stdout


def read_json(directory, name):
    with open(os.path.join(directory, name), encoding="utf-8") as file:
        return json.load(file)


def read_lines(directory, name):
    """Of a file with a JSON object a line."""
    with open(os.path.join(directory, name), encoding="utf-8") as file:
        return [json.loads(line) for line in file]


def iterate(options, ranks, directory, arguments):
    """Lines of the history of a short optimization that writes no fields: `options.iterations` design iterations."""
    run(options, ranks, directory, ["-max_iterations", options.iterations,
        "-output_every", 0, "-checkpoint_every", 0, *arguments])
    return read_lines(directory, "history.jsonl")


def resolved_config(options, directory):
    """The config with the options of the program and all defaults in it, but for a single layer, which is what is simulated for it."""
    run(options, 1, directory, ["-task", "simulate", "-layers", 1])
    return read_json(directory, "config.json")


def problem_size(options, directory, arguments=()):
    """Elements of the part and of the box, unknowns of a layer and number of layers, as `-task check` prints them."""
    _, printed = run(options, 1, directory, ["-task", "check", *arguments])
    part, box = re.search(r"part: (\d+) elements of (\d+)", printed).groups()
    return {"part_elements": int(part), "elements": int(box), "unknowns": int(re.search(r"one layer: (\d+) unknowns", printed)[1]),
            "layer_count": int(re.search(r"layers: (\d+) curved", printed)[1])}


def parse_iterations(parser, what, rows, iterations=5):
    """As parse(), for scripts that time the iterations of an optimization and leave a table and a picture; `what` says of what
    (with a colon, or ""), `rows` what a line stands for."""
    parser.add_argument("--iterations", type=int, default=iterations, metavar="I",
                        help="design iterations of a run (default: %(default)s)")
    parser.add_argument("--warm-up", type=int, default=1, metavar="W",
                        help="the first W of them do not count (default: %(default)s)")
    parser.add_argument("--csv", metavar="FILE", help=f"{what}a line a {rows}")
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
