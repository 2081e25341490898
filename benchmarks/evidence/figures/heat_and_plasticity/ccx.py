# SPDX-License-Identifier: MIT
"""Runs CalculiX (ccx, of Debian's calculix-ccx), and reads the tables that it prints."""

import os
import subprocess

import numpy as np

from fabseq_tools.run.command_line import RunError


def run_ccx(folder, name, lines):
    """Writes NAME.inp, runs it on one core unless it was run before, and returns the path of NAME.dat."""
    os.makedirs(folder, exist_ok=True)
    text, base = "\n".join(lines) + "\n", os.path.join(folder, name)
    if os.path.exists(base + ".done") and os.path.exists(base + ".inp"):
        with open(base + ".inp", encoding="ascii") as file:
            if file.read() == text:
                return base + ".dat"
    with open(base + ".inp", "w", encoding="ascii") as file:
        file.write(text)
    with open(base + ".log", "w", encoding="ascii") as log:
        status = subprocess.run(["ccx", "-i", name], cwd=folder, stdout=log, stderr=log, check=False,
                                env={**os.environ, "OMP_NUM_THREADS": "1"}).returncode
    with open(base + ".log", encoding="ascii", errors="replace") as log:
        if status != 0 or "Job finished" not in log.read():
            raise RunError(f"ccx has not finished {base}.inp; see {base}.log")
    with open(base + ".done", "w", encoding="ascii"):
        pass
    return base + ".dat"


def tables_of(path, count, width):
    """The tables of a .dat, each (count, width), NaN for nodes that are not in it."""
    tables = []
    with open(path, encoding="ascii", errors="replace") as file:
        for line in file:
            words = line.split()
            if "for set" in line:
                tables.append(np.full((count, width), np.nan))
            elif len(words) == 1 + width and words[0].isdigit() and int(words[0]) <= count:
                tables[-1][int(words[0]) - 1] = [float(word) for word in words[1:]]
    return tables
