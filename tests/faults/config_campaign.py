#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Configs and command lines with something wrong in them, or extreme: each run must end as docs/reference.md
says.

    tests/faults/config_campaign.py                        1000 cases on one rank: ten minutes on two cores
    tests/faults/config_campaign.py --ranks 3 --cases 60   the same cases on three ranks and on one, compared
    tests/faults/config_campaign.py --short                a sample, as ctest runs it
    tests/faults/config_campaign.py --seed 1 --only 137    one case, with all that it says

A case is one of the configs of configs/ and configs/published/ with few elements and two iterations
(shrunken_configs.py), in which one to three things are changed at random (config_mutations.py), and a command
line (option_mutations.py). It depends on the seed and its own number only.

Right is: status 0, all files of the task, finite numbers in them, a config.json that can be read again;
status 2, one line that names key, option or file, nothing written; 3, 4 and 5 as the reference describes
them. A run that takes longer than 10 s is told to end, and must end with status 4 within 50 s. Everything
else is a finding and makes the status 1.
Prints a table of classes (Markdown), and each finding with the command that repeats it.
"""

import argparse
import collections
import copy
import json
import os
import random
import shutil
import signal
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor

from config_mutations import LEGAL, TEXT, TREE, dumps
from config_schema import read_keys
from option_mutations import FILE, FOLDER, OPTIONS, RUN, TASKS, of_a_run
from run_fabseq import DONE, PROGRAM, ROOT, Process, Result
from run_outcome import ENDED_BY_US, Judge, difference, value_of
from shrunken_configs import shrunken_configs

SHORT_SEED, SHORT_CASES = 1, 40
PATIENCE, LAST_PATIENCE = 10, 50  # seconds
REREAD_EVERY = 4  # cases: of these config.json is read again
MOST_MEMORY = 6 << 30  # bytes of address space: no case may bring the machine down


class Case:
    """The `number`-th case of a seed: `content` of its config, `arguments`, and in words what is wrong with
    them."""

    KINDS = ("config", "legal", "text", "options", "both", "again")

    def __init__(self, seed, number, configs, keys, kind=None):
        self.number = number
        chance = random.Random(f"{seed}/{number}")
        self.name = chance.choice(sorted(configs))
        config, told = copy.deepcopy(configs[self.name]), []
        kind = kind or chance.choices(self.KINDS, [25, 35, 8, 15, 7, 10])[0]
        self.arguments = self.task(chance, config)
        if kind in ("config", "legal", "both"):
            for _ in range(chance.choices([1, 2, 3], [70, 20, 10])[0]):
                told.append(self.change(chance, config, keys, LEGAL if kind == "legal" else TREE))
        if kind == "again":
            if chance.random() < 0.5:
                told.append(self.change(chance, config, keys, (*LEGAL, *TREE)))
            self.arguments += of_a_run(chance)
            told.append(" ".join(self.arguments))
        self.unchanged = dumps(configs[self.name]).encode()
        self.content = dumps(config).encode("utf-8", "surrogatepass")
        if kind == "text":
            self.content, text = chance.choice(TEXT)(chance, json.dumps(config, indent=1).encode())
            told.append(text)
        if kind in ("options", "both"):
            for _ in range(chance.choices([1, 2, 3], [70, 20, 10])[0]):
                words = [word.replace("\0", "") for word in chance.choice(OPTIONS)(chance, configs[self.name], keys)]
                self.arguments += words
                told.append(" ".join(words)[:100])
        self.told = f"{self.name}: " + "; ".join(told)

    @staticmethod
    def change(chance, config, keys, changes):
        change = chance.choice(changes)
        try:
            return change(chance, config, keys)
        except (AttributeError, KeyError, TypeError) as error:  # an earlier change left nothing of that kind
            return f"not {change.__name__} ({error!r})"

    @staticmethod
    def task(chance, config):
        if config["sequence"]["type"] == "planar":
            return ["-task", chance.choice(["simulate", "simulate", "check"])]
        return [] if chance.random() < 0.7 else ["-task", chance.choice(TASKS)]


def all_files(folder):
    """Paths below the folder with size and time of change; those of devices are no matter."""
    entries = {}
    for parent, folders, files in os.walk(folder):
        for name in folders + files:
            path = os.path.join(parent, name)
            status = os.lstat(path)
            entries[os.path.relpath(path, folder)] = (status.st_size, status.st_mtime_ns)
    return entries


class Campaign:
    def __init__(self, directory, options):
        self.directory, self.options = directory, options
        self.inputs = os.path.join(directory, "inputs")
        os.mkdir(self.inputs)
        self.configs = shrunken_configs(os.path.join(ROOT, "configs"), self.inputs)
        self.keys = read_keys(PROGRAM)

    def case(self, number):
        return Case(self.options.seed, number, self.configs, self.keys, self.options.kind)

    def folder_for(self, case, ranks):
        """A working directory for the case: its config, the voxels, a file and a folder that options may
        name."""
        folder = os.path.join(self.directory, f"case_{case.number}_{ranks}", "here")
        shutil.copytree(self.inputs, folder)
        with open(os.path.join(folder, "case.json"), "wb") as file:
            file.write(case.content)
        with open(os.path.join(folder, FILE), "w", encoding="utf-8") as file:
            file.write("what was there\n")
        os.mkdir(os.path.join(folder, FOLDER))
        if any(word.startswith(RUN) for word in case.arguments):
            self.run_before(case, folder)
        return folder

    def run_before(self, case, folder):
        """Leaves a run of the config without the changes."""
        with open(os.path.join(folder, "before.json"), "wb") as file:
            file.write(case.unchanged)
        task = ["-task", "simulate"] if self.configs[case.name]["sequence"]["type"] == "planar" else []
        status, _, stderr = self.wait([PROGRAM, "-config", "before.json", "-output", RUN, *task], folder)
        if status != DONE:
            raise SystemExit(f"{case.name} without a change ends with status {status}: {stderr}")

    def run(self, case, ranks):
        """The result and its outcome."""
        folder = self.folder_for(case, ranks)
        top = os.path.dirname(folder)  # outputs of "../x" count
        before = all_files(top)
        arguments = ["-config", "case.json", *case.arguments]
        output = value_of(arguments, "-output")
        if output is None:
            in_place = value_of(arguments, "-restart") not in (None, "auto")
            output = value_of(arguments, "-restart") if in_place else "out"
            arguments += [] if in_place else ["-output", output]
        command = ["prlimit", f"--as={MOST_MEMORY}", PROGRAM, *arguments]
        if ranks > 1:
            command = ["mpirun", "-np", str(ranks), *command]
        status, stdout, stderr = self.wait(command, folder)
        run = Result(command, status, stdout, stderr, os.path.join(folder, output))
        outcome = Judge(run, arguments, before, all_files(top)).outcome()
        if not outcome.wrong and case.number % REREAD_EVERY == 0 and os.path.exists(run.path("config.json")):
            outcome.wrong = self.reread(run.path("config.json"), folder)
        return run, outcome

    def reread(self, config, folder):
        """Why the config.json that a run has left is refused; "" if it is not."""
        status, _, stderr = self.wait([PROGRAM, "-config", config, "-task", "check"], folder)
        return f"its config.json ends with status {status}: {stderr}" if status else ""

    @staticmethod
    def wait(command, folder):
        with Process(command, folder) as process:
            end = time.monotonic() + PATIENCE
            while process.process.poll() is None and time.monotonic() < end:
                time.sleep(0.01)
            late = process.process.poll() is None
            if late:
                os.killpg(process.process.pid, signal.SIGTERM)
            try:
                status, stdout, stderr = process.wait(LAST_PATIENCE)
            except AssertionError as hang:
                return None, "", str(hang)
            return status, stdout, stderr + (f"\n{ENDED_BY_US}\n" if late else "")

    def judge(self, number):
        """The case, its outcome, and what it said; its folders are removed."""
        case = self.case(number)
        run, outcome = self.run(case, self.options.ranks)
        if self.options.ranks > 1 and not outcome.wrong:
            outcome.wrong = difference(self.run(case, 1)[0], run)
        if self.options.only is None:
            for ranks in {1, self.options.ranks}:
                shutil.rmtree(os.path.join(self.directory, f"case_{number}_{ranks}"), ignore_errors=True)
        return case, run, outcome

    def print_case(self, case, run, outcome):
        ranks = f" --ranks {self.options.ranks}" if self.options.ranks > 1 else ""
        ranks += f" --kind {self.options.kind}" if self.options.kind else ""
        print(f"*** {outcome.kind}: {outcome.wrong or 'as promised'}\n    {case.told}\n    {outcome.message[:300]}\n"
              f"    tests/faults/config_campaign.py --seed {self.options.seed}{ranks} --only {case.number}", flush=True)
        if self.options.only is not None:
            print(run)


def print_table(outcomes):
    counts = collections.Counter((outcome.kind, bool(outcome.wrong)) for outcome in outcomes)
    print("| class | runs | findings |\n| --- | --- | --- |")
    for kind in sorted({kind for kind, _ in counts}):
        print(f"| {kind} | {counts[kind, False] + counts[kind, True]} | {counts[kind, True]} |")
    print(f"| all | {len(outcomes)} | {sum(bool(outcome.wrong) for outcome in outcomes)} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--short", action="store_true", help=f"the first {SHORT_CASES} cases of seed {SHORT_SEED}")
    parser.add_argument("--cases", type=int, default=1000)
    parser.add_argument("--first", type=int, default=0, help="number of the first case")
    parser.add_argument("--seed", type=int, default=SHORT_SEED)
    parser.add_argument("--ranks", type=int, default=1)
    parser.add_argument("--kind", choices=Case.KINDS, help="cases of this kind only; others than without")
    parser.add_argument("--jobs", type=int, default=None, help="runs at a time")
    parser.add_argument("--only", type=int, default=None, metavar="NUMBER", help="this case alone, with all that it says")
    parser.add_argument("--log", help="file that gets a line of JSON per case")
    parser.add_argument("--keep", help="folder that keeps the files of the case of --only")
    options = parser.parse_args()
    if options.short:
        options.cases, options.seed, options.jobs = SHORT_CASES, SHORT_SEED, 2  # they mostly wait for MPI to start
    numbers = [options.only] if options.only is not None else range(options.first, options.first + options.cases)
    jobs = options.jobs or max(1, (os.cpu_count() or 1) // options.ranks)
    with tempfile.TemporaryDirectory(prefix="fabseq_configs_") as directory:
        if options.keep:
            directory = options.keep
            os.makedirs(directory)
        campaign = Campaign(directory, options)
        outcomes = []
        with ThreadPoolExecutor(jobs) as pool, open(options.log or os.devnull, "w", encoding="utf-8") as log:
            for case, run, outcome in pool.map(campaign.judge, numbers):
                outcomes.append(outcome)
                record = [case.number, outcome.kind, outcome.wrong, case.told, case.arguments, outcome.message]
                log.write(json.dumps(record) + "\n")
                log.flush()
                if outcome.wrong or options.only is not None:
                    campaign.print_case(case, run, outcome)
    print_table(outcomes)
    sys.exit(1 if any(outcome.wrong for outcome in outcomes) else 0)


if __name__ == "__main__":
    main()
