"""Runs fabseq with one solver or another, for the scripts of this folder."""

import json
import os
import statistics
import subprocess
import sys
import time

import numpy as np

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
LANES = "lanes"
REFERENCES = ["multigrid", "gamg", "direct"]
METHODS = [LANES, *REFERENCES]


def add_common_options(parser):
    parser.add_argument("config")
    parser.add_argument("--repetitions", type=int, default=3, metavar="R", help="runs of everything, by turns (default: %(default)s)")
    parser.add_argument("--program", default=os.path.join(ROOT, "build/release/fabseq"), help="default: build/release/fabseq")
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
    command = ["mpirun", "-np", str(ranks), options.program, "-config", options.config, "-output", directory, "-overwrite",
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


def write_json(path, record):
    with open(path, "w", encoding="utf-8") as file:
        json.dump(record, file, indent=1)
        file.write("\n")


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
