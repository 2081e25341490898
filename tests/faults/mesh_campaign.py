#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Mesh files with something wrong in them: each ends with status 0, or with 2 and one line that names it.

    tests/faults/mesh_campaign.py             2000 files, each with -task check: ten minutes on two cores
    tests/faults/mesh_campaign.py --short     a sample, as ctest runs it
    tests/faults/mesh_campaign.py --seed 1 --only 137 --keep DIR    one file, with all that is said of it

A file is a small part in one of the formats, in which up to three things are changed at random
(mesh_mutations.py). It depends on the seed and its own number only. A signal, more than 20 s, more than 1 GB,
several lines or a line that does not name the file are findings, and make the status 1.
Prints a table of formats (Markdown), and each finding with the command that repeats it.
"""

import argparse
import collections
import json
import os
import random
import sys
import tempfile
import threading
from concurrent.futures import ThreadPoolExecutor
from subprocess import DEVNULL, PIPE, Popen

from mesh_mutations import changed_mesh
from run_fabseq import BAD_INPUT, DONE, ENVIRONMENT, PROGRAM, SANITIZED

SHORT_CASES = 60
PATIENCE = 20 * (10 if SANITIZED else 1)  # seconds
MOST_MEMORY = 1 << 20  # kB
KEYS = {"/part/mesh", "/domain", "/build_plate", "/part", "/node_sets", "/layers"}


def config(name, box):
    """Of a mesh file. `box`: the grid does not follow from the mesh, which may be large or far away then."""
    domain = {"origin": [0, 0, 0], "size": [60, 20, 20], "elements": [24, 8, 8]} if box else {"element": 2.5, "unit": "mm"}
    return {"name": "mesh", "domain": domain, "part": {"mesh": {"file": name, "least_elements": 0}, "keep": "connected"},
            "node_sets": {"all": {"all": True}}, "sequence": {"type": "heat"}, "layers": {"count": 4},
            "objective": [{"type": "distortion", "nodes": "all"}]}


def judged(status, memory, late, stderr):
    """What is not as promised; "" if all is."""
    errors = [line for line in stderr.splitlines() if not line.startswith("warning: ")]
    if late:
        return f"not done after {PATIENCE} s"
    if status not in (DONE, BAD_INPUT):
        return f"status {status}"
    if memory > MOST_MEMORY and not SANITIZED:
        return f"{memory / 1e6:.2f} GB"
    if status == DONE:
        return f"says {errors[:2]}" if errors else ""
    if len(errors) != 1 or not errors[0].startswith("fabseq: "):
        return f"{len(errors)} lines: {errors[:2]}"
    return "" if any(errors[0].startswith(f"fabseq: {key}") for key in KEYS) else "names no key"


def run_case(seed, number, keep):
    chance = random.Random(f"{seed}/{number}")
    name, content, told = changed_mesh(chance)
    with tempfile.TemporaryDirectory(prefix="fabseq_mesh_") as folder:
        folder = keep or folder
        os.makedirs(folder, exist_ok=True)
        with open(os.path.join(folder, name), "wb") as file:
            file.write(content)
        with open(os.path.join(folder, "case.json"), "w", encoding="utf-8") as file:
            json.dump(config(name, chance.random() < 0.5), file)
        process = Popen([PROGRAM, "-config", "case.json", "-task", "check"], cwd=folder, stdout=DEVNULL, stderr=PIPE, text=True,
                        errors="replace", env={**os.environ, **ENVIRONMENT, "OMPI_MCA_orte_tmpdir_base": folder})
        late = threading.Event()
        timer = threading.Timer(PATIENCE, lambda: (late.set(), process.kill()))
        timer.start()
        stderr = process.stderr.read()
        _, status, usage = os.wait4(process.pid, 0)
        timer.cancel()
        process.returncode = os.waitstatus_to_exitcode(status)
        process.stderr.close()
        wrong = judged(process.returncode, usage.ru_maxrss, late.is_set(), stderr)
        return number, told, process.returncode, wrong, stderr


def print_table(results):
    counts = collections.Counter((told.partition(":")[0], status if not wrong else "finding")
                                 for _, told, status, wrong, _ in results)
    print("| format | read | refused | findings |\n| --- | --- | --- | --- |")
    for form in sorted({form for form, _ in counts}):
        print(f"| {form} | {counts[form, DONE]} | {counts[form, BAD_INPUT]} | {counts[form, 'finding']} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--short", action="store_true", help=f"the first {SHORT_CASES} files of seed 1")
    parser.add_argument("--cases", type=int, default=2000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--only", type=int, metavar="NUMBER", help="this file alone, with all that is said of it")
    parser.add_argument("--keep", help="folder that keeps the file of --only")
    options = parser.parse_args()
    if options.short:
        options.cases, options.seed, options.jobs = SHORT_CASES, 1, 2
    numbers = [options.only] if options.only is not None else range(options.cases)
    results = []
    with ThreadPoolExecutor(options.jobs) as pool:
        for result in pool.map(lambda number: run_case(options.seed, number, options.keep), numbers):
            results.append(result)
            number, told, status, wrong, stderr = result
            if wrong or options.only is not None:
                print(f"*** {wrong or 'as promised'}, status {status}: {told}\n    {stderr[:2000].strip()}\n"
                      f"    tests/faults/mesh_campaign.py --seed {options.seed} --only {number}", flush=True)
    print_table(results)
    sys.exit(1 if any(wrong for _, _, _, wrong, _ in results) else 0)


if __name__ == "__main__":
    main()
