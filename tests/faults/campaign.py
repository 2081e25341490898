#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Everything that can go wrong with the files of a run, one thing at a time: nothing may be lost but the work
since the last checkpoint, and nothing may hang.

    tests/faults/campaign.py                  every fault; a quarter of an hour. Prints a table (Markdown)
    tests/faults/campaign.py --short          a sample of each kind, as ctest runs it

Calls        the N-th open, write, sync, rename and close of a file below the output directory fails, for
every N and every rank
             (failing_calls.cc); a write that takes half of its bytes and then fails; all writes from the N-th
             on
Small disks  in memory, with room for so many kB, from too little to enough
Kills        SIGKILL to one rank or to all at random moments
Damage       checkpoints cut off, or with a bit turned over, at random places

After each, the same command without the fault must complete the run, with the same bytes as a run without
faults. Status 1 if one did not; what happened is printed.
"""

import argparse
import errno
import math
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor

from fault_run import FaultRuns
from run_fabseq import STOPPED, NoSmallDisk, Result, build_preload, must_run, small_disk

COLUMNS = ("fault", "injected", "reported", "not noticed", "survived", "iterations lost, at most", "seconds")


def failing_calls(runs, every, most=math.inf):
    """Lists of faults by kind: every `every`-th call of each kind of each rank, or about `most` of them."""
    report = os.path.join(runs.directory, "calls")
    os.mkdir(report)
    runs.run(os.path.join(runs.directory, "counted"), variables(runs, "counted", report))
    counts = {}
    for rank in range(runs.RANKS):
        with open(os.path.join(report, f"{rank}.csv"), encoding="utf-8") as file:
            for line in file:
                kind = line.split(",")[0]
                counts[rank, kind] = counts.get((rank, kind), 0) + 1
    faults = {}
    for (rank, kind), count in counts.items():
        ways = {kind: {}}
        if kind == "write":
            ways = {"write": {}, "short_write": {"reason": errno.ENOSPC},
                    "writes from there on": {"lasting": 1, "reason": errno.ENOSPC}}
        for way, more in ways.items():
            chosen = range(1 + len(faults) % every, count + 1, max(every, math.ceil(count / most)))
            faults.setdefault(way, []).extend((rank, "short_write" if way == "short_write" else kind, number, more)
                                              for number in chosen)
    return {way: [lambda fault=fault: fail_call(runs, *fault) for fault in chosen] for way, chosen in faults.items()}


def variables(runs, folder, report, **more):
    values = {"directory": os.path.join(runs.directory, folder), "report": report, **more}
    return {"FAILING_" + name.upper(): str(value) for name, value in values.items()}


def fail_call(runs, rank, kind, number, more):
    output = runs.new_folder()
    report = output + "_calls"
    os.mkdir(report)
    try:
        run = runs.run(output, variables(runs, os.path.basename(output), report, rank=rank, kind=kind, number=number, **more))
        with open(os.path.join(report, f"{rank}.csv"), encoding="utf-8") as file:
            failed = [line.split(",")[2] for line in file if line.rstrip().endswith(",failed")]
    finally:
        shutil.rmtree(report)
    fault = f"{kind} {number} of rank {rank} {more}: {failed[:1]}"
    outcome = runs.outcome(fault, run, failed[0] if failed else None)
    if not failed:
        outcome.wrong = "the call did not come\n" + str(run)
    return outcome


def small_disks(runs, every):
    """Faults: disks of so many kB, from too little for anything to more than the run needs."""
    used = sum(os.path.getsize(os.path.join(folder, file))
               for folder, _, files in os.walk(runs.expected.output) for file in files)
    return [lambda size=size: fill_disk(runs, size) for size in range(8, used // 1024 + 96, 4 * every)]


def fill_disk(runs, size):
    with small_disk(runs.new_folder(), f"{size}k") as disk:
        run = runs.run(os.path.join(disk, "run"))
        subprocess.run(["mount", "-o", "remount,size=16m", disk], check=True)
        return runs.outcome(f"disk of {size} kB", run, "")


def kills(runs, count, chance):
    start = time.monotonic()
    runs.run(runs.new_folder())
    duration = time.monotonic() - start
    moments = [(chance.uniform(0, duration), chance.choice(["one", "all"])) for _ in range(count)]
    return [lambda moment=moment, who=who: kill(runs, moment, who) for moment, who in moments]


def kill(runs, moment, who):
    output = runs.new_folder()
    with runs.start(output) as process:
        ranks = []
        while len(ranks) < runs.RANKS and process.process.poll() is None:
            ranks = process.ranks()
        time.sleep(moment)
        for rank in ranks if who == "all" else ranks[-1:]:
            try:
                os.kill(rank, signal.SIGKILL)
            except ProcessLookupError:
                pass  # it has ended
        run = Result(process.command, *process.wait(60), output)
    return runs.outcome(f"{who} killed after {moment:.3f} s", run)


def damages(runs, count, chance):
    """Faults by kind; of a run that was stopped in its middle and has both slots."""
    stopped = runs.new_folder()
    os.mkdir(stopped)
    with open(os.path.join(stopped, "stop"), "w", encoding="utf-8") as file:
        file.write(str(2 * runs.checkpoint_every))
    run = runs.run(stopped)
    if run.status != STOPPED:
        raise SystemExit(f"the run does not stop\n{run}")
    with open(os.path.join(stopped, "checkpoint", "newest"), encoding="utf-8") as file:
        newest = file.read().strip()
    faults = {}
    for name in (newest, "newest"):
        size = os.path.getsize(os.path.join(stopped, "checkpoint", name))
        what = "pointer file" if name == "newest" else "newest checkpoint"
        cuts = sorted({0, size // 2, size - 1, *(chance.randrange(size) for _ in range(count))})
        bits = [chance.randrange(8 * size) for _ in range(4 * count)]
        if name == "newest":
            bits = range(0, 8 * size, max(1, 8 * size // (4 * count)))
        faults[what + " cut off"] = [lambda name=name, cut=cut: damage(runs, stopped, name, cut=cut) for cut in cuts]
        faults[what + ", a bit"] = [lambda name=name, bit=bit: damage(runs, stopped, name, bit=bit) for bit in bits]
    return faults


def damage(runs, stopped, name, cut=None, bit=None):
    output = runs.new_folder()
    shutil.copytree(stopped, output)
    path = os.path.join(output, "checkpoint", name)
    with open(path, "r+b") as file:
        content = bytearray(file.read())
        if bit is not None:
            content[bit // 8] ^= 1 << bit % 8
        file.seek(0)
        file.write(content)
        file.truncate(cut)
    run = Result([], STOPPED, "", "", output)
    return runs.outcome(f"{name} cut to {cut} bytes" if bit is None else f"{name}: bit {bit}", run)


class Table:
    def __init__(self, jobs):
        self.jobs, self.rows, self.bad = jobs, [], []

    def add(self, name, faults):
        start = time.monotonic()
        with ThreadPoolExecutor(self.jobs) as pool:
            outcomes = list(pool.map(lambda fault: fault(), faults))
        bad = [outcome for outcome in outcomes if outcome.wrong]
        reported = sum(outcome.reported for outcome in outcomes)
        self.rows.append((name, len(outcomes), reported, len(outcomes) - reported, len(outcomes) - len(bad),
                          max((outcome.lost for outcome in outcomes), default=0), round(time.monotonic() - start)))
        print(", ".join(f"{value} {column}" for column, value in zip(COLUMNS[1:], self.rows[-1][1:])) + f": {name}", flush=True)
        for outcome in bad:
            print(f"*** {outcome.fault}: {outcome.wrong}", flush=True)
        self.bad += bad

    def print(self):
        total = [sum(row[i] for row in self.rows) for i in range(1, 5)]
        last = ("all", *total, max(row[5] for row in self.rows), sum(row[6] for row in self.rows))
        for row in (COLUMNS, ["---"] * len(COLUMNS), *self.rows, last):
            print("| " + " | ".join(str(value) for value in row) + " |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--short", action="store_true", help="a sample of each kind")
    parser.add_argument("--jobs", type=int, default=max(1, (os.cpu_count() or 1) // 2), help="runs at a time, two ranks each")
    parser.add_argument("--seed", type=int, default=None, help="of the random moments and places")
    parser.add_argument("--only", choices=("calls", "disks", "kills", "damage"))
    options = parser.parse_args()
    seed = options.seed if options.seed is not None else random.randrange(10**6)
    print(f"seed {seed}", flush=True)
    chance = random.Random(seed)
    table = Table(options.jobs)
    with tempfile.TemporaryDirectory(prefix="fabseq_faults_") as directory:
        library = build_preload(directory, "failing_calls")
        small = FaultRuns(os.path.join(directory, "small"), library, "-max_iterations", 6, "-output_every", 3)
        long = FaultRuns(os.path.join(directory, "long"), library, "-max_iterations",
                         30, "-elements", "40,24", "-output_every", 10)
        if options.only in (None, "calls"):
            for way, faults in failing_calls(small, *((23, 8) if options.short else (1,))).items():
                table.add(way, faults)
        if options.only in (None, "disks"):
            try:
                with small_disk(os.path.join(directory, "disk"), "1m"):
                    pass
                table.add("disk full", small_disks(small, 8 if options.short else 1))
            except NoSmallDisk as reason:
                print(f"skipped: {reason}")
                if must_run(str(reason)):
                    table.bad.append(reason)
        if options.only in (None, "kills"):
            table.add("SIGKILL", kills(long, 4 if options.short else 50, chance))
        if options.only in (None, "damage"):
            for what, faults in damages(small, 2 if options.short else 25, chance).items():
                table.add(what, faults)
    table.print()
    sys.exit(1 if table.bad else 0)


if __name__ == "__main__":
    main()
