# SPDX-License-Identifier: MIT
"""A small optimization to which things happen: run, run again without them, compare."""

import dataclasses
import json
import os
import re
import shutil
import threading
import unittest

from compare_runs import assert_same_run
from run_fabseq import DONE, OUTPUT_FAILURE, PROGRAM, Process, Result
from small_parts import plate_2d

PATIENCE = 120  # seconds; a run takes less than ten


@dataclasses.dataclass
class Outcome:
    """What became of a run with a fault. `lost`: iterations that had to be done again."""

    fault: str
    reported: bool
    lost: int = 0
    wrong: str = ""  # "" if the run came to its result in the end


class FaultRuns:
    """Runs of one part with one set of options, each in a folder of its own below `directory`."""

    RANKS = 2

    def __init__(self, directory, library, *options, checkpoint_every=2):
        self.directory, self.library, self.checkpoint_every = directory, library, checkpoint_every
        self.count, self.lock = 0, threading.Lock()
        os.makedirs(directory)
        config = os.path.join(directory, "plate.json")
        with open(config, "w", encoding="utf-8") as file:
            json.dump(plate_2d(), file)
        self.command = [PROGRAM, "-config", config, "-checkpoint_every", str(checkpoint_every), *map(str, options)]
        self.expected = self.run(self.new_folder())
        if self.expected.status != DONE:
            raise SystemExit(f"the run without faults fails\n{self.expected}")

    def new_folder(self):
        """Path of a folder that is not there."""
        with self.lock:
            self.count += 1
            return os.path.join(self.directory, f"run_{self.count}")

    def start(self, output, environment=None):
        """The run under way; `environment` names variables of failing_calls.cc, if calls are to fail."""
        launcher = ["mpirun", "-np", str(self.RANKS)] + (["-x", f"LD_PRELOAD={self.library}"] if environment else [])
        return Process([*launcher, *self.command, "-restart", "auto", "-output", output], self.directory, environment)

    def run(self, output, environment=None):
        with self.start(output, environment) as process:
            try:
                return Result(process.command, *process.wait(PATIENCE), output)
            except AssertionError as hang:
                return Result(process.command, None, "", str(hang), output)

    def completed(self, output):
        """Lines of the history that are whole."""
        try:
            with open(os.path.join(output, "history.jsonl"), encoding="utf-8") as file:
                return file.read().count("\n")
        except OSError:
            return 0

    def outcome(self, fault, run, file=None):
        """Continues without the fault that `run` met. `file`: what the message has to name; none for a run
        that had no chance to say anything: the next one may."""
        done = self.completed(run.output)
        outcome = Outcome(fault, run.status != DONE)
        try:
            if file is not None and outcome.reported:
                self.check_message(run, file)
            resumed = self.run(run.output)
            if file is None:
                outcome.reported = "warning" in resumed.stderr
            continued = re.search("continues after iteration ([0-9]+)", resumed.stdout)
            outcome.lost = max(done - (int(continued.group(1)) if continued else 0), 0)
            if resumed.status != DONE:
                raise AssertionError(f"does not continue\n{resumed}")
            assert_same_run(unittest.TestCase(), resumed, self.expected, self.RANKS)
            if outcome.lost > self.checkpoint_every:
                raise AssertionError(f"{outcome.lost} iterations lost\n{resumed}")
        except (AssertionError, OSError) as error:
            outcome.wrong = f"{error}\nthe run with the fault: {run}"
        shutil.rmtree(run.output, ignore_errors=True)
        return outcome

    @staticmethod
    def check_message(run, file):
        """One line, which names the file or its folder, and the status for it."""
        messages = [line for line in run.messages() if not line.startswith(("warning: ", "mca_"))]  # Open MPI's own
        name = re.sub(r"\.partial(\.locktest.*)?$", "", file)
        named = os.path.basename(run.output) + name in messages[0] if len(messages) == 1 else False
        if run.status != OUTPUT_FAILURE or not named:
            raise AssertionError(f"status {run.status} and not one line that names '{name}': {messages}")
