# SPDX-License-Identifier: MIT
"""What the tests of scripts/slurm share: jobs in a real Slurm of one node, started here and ended afterwards.

All tests of a file run side by side: most of the time they wait for Slurm. Exit status 77, with the reason,
where Slurm cannot start: not root, or its packages missing; an error if Slurm must not be missing
(run_fabseq.must_run)."""

import os
import re
import sys
import time
import unittest
from concurrent.futures import ThreadPoolExecutor

import h5py

import run_fabseq
from run_fabseq import ENVIRONMENT, PROGRAM, ROOT, FabseqTest, Result
from slurm_cluster import Cluster, Unavailable
from small_parts import plate_2d

SKIPPED = 77
PATIENCE = 900  # seconds for a job to get to the point that a test waits for
RANKS = 2
SCRIPTS = os.path.join(ROOT, "scripts", "slurm")
MPIRUN, SRUN = "mpirun", "srun --mpi=pmix"
# Some hundredths of a second per iteration: long enough for what happens here to happen on the way.
SMALL = ("-elements", "60,36")
ENDED = ("COMPLETED", "FAILED", "CANCELLED", "TIMEOUT", "NODE_FAIL")


class Job:
    """A job that was submitted."""

    def __init__(self, test, number, log, output):
        self.test, self.number, self.log_path, self.output = test, number, log, output

    def field(self, name):
        """Of scontrol's description."""
        text = self.test.slurm("scontrol", "show", "job", self.number).stdout
        return re.search(rf"\b{name}=(\S*)", text).group(1)

    def log(self):
        if not os.path.exists(self.log_path):
            return ""
        with open(self.log_path, encoding="utf-8") as file:
            return file.read()

    def result(self):
        return Result([f"job {self.number}"], None, self.log(), "", self.output)

    def iterations(self):
        try:
            with open(os.path.join(self.output, "history.jsonl"), encoding="utf-8") as file:
                return len(file.readlines())
        except FileNotFoundError:
            return 0

    def wait_until(self, condition, what):
        end = time.monotonic() + PATIENCE
        while not condition():
            state = self.field("JobState")
            if (state in ENDED or time.monotonic() > end) and not condition():
                self.test.fail(f"job {self.number} is {state}, not {what}\n{self.log()}")
            time.sleep(0.2)

    def wait_for_iterations(self, count):
        self.wait_until(lambda: self.iterations() >= count, f"at iteration {count}")

    def wait_for_end(self, state, exit_code="0:0"):
        self.wait_until(lambda: self.field("JobState") in ENDED, "at its end")
        self.test.assertEqual((self.field("JobState"), self.field("ExitCode")), (state, exit_code), self.log())

    def ranks(self):
        """Processes of the program that run for the job; other clusters have jobs of the same number."""
        return [process for process in processes_with(f"\0{self.output}\0")
                if os.path.realpath(f"/proc/{process}/exe") == os.path.realpath(PROGRAM)]


class SlurmTest(FabseqTest):
    cluster = None
    form = MPIRUN

    def setUp(self):
        super().setUp()
        self.submitted = []
        self.addCleanup(self.cancel_all)
        self.environment = {**ENVIRONMENT, **self.cluster.environment, "FABSEQ_ROOT": ROOT, "FABSEQ_PROGRAM": PROGRAM,
                            "OMPI_MCA_odls_base_sigkill_timeout": "5"}

    def cancel_all(self):
        if not self.submitted:
            return
        self.slurm("scancel", *self.submitted)
        end = time.monotonic() + PATIENCE
        while self.slurm("squeue", "--noheader", "--jobs=" + ",".join(self.submitted)).stdout.strip() and time.monotonic() < end:
            time.sleep(0.2)

    def slurm(self, *words, **environment):
        return self.cluster.command(*words, cwd=self.directory, env={**self.environment, **environment})

    def submit(self, script, *arguments, options=(), **environment):
        """Number of the job; `options` are sbatch's."""
        done = self.slurm("sbatch", "--parsable", f"--ntasks={RANKS}", *options, os.path.join(SCRIPTS, script),
                          *(str(argument) for argument in arguments), **environment)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.submitted.append(done.stdout.strip())
        return self.submitted[-1]

    def submit_run(self, *arguments, config=None, time_limit="10", options=()):
        self.runs += 1
        name = f"job_{self.runs}"
        log, output = (os.path.join(self.directory, name + end) for end in (".log", ""))
        path = self.write_config(config or plate_2d())
        number = self.submit("run.sh", path, output, *arguments, FABSEQ_LAUNCH=self.form,
                             options=(f"--time={time_limit}", f"--output={log}", *options))
        return Job(self, number, log, output)

    def newest_checkpoint(self, output):
        with open(os.path.join(output, "checkpoint", "newest"), encoding="utf-8") as file:
            slot = file.read().strip()
        with h5py.File(os.path.join(output, "checkpoint", slot), "r") as file:
            return file.attrs["iteration"]


def processes_with(word):
    """Numbers of the processes that have it in their environment or command line, but for those that have
    ended."""
    found = []
    for number in filter(str.isdigit, os.listdir("/proc")):
        try:
            with open(f"/proc/{number}/environ", "rb") as environment, open(f"/proc/{number}/cmdline", "rb") as command:
                if word.encode() in environment.read() + command.read():
                    found.append(int(number))
        except OSError:
            pass
    return found


class SideBySide(unittest.TestSuite):
    """A suite whose tests all run at once. Says at once why one failed, with what Slurm has last written."""

    def run(self, result, debug=False):
        tests = list(self)
        with ThreadPoolExecutor(len(tests) or 1) as pool:
            list(pool.map(lambda test: self.run_one(test, result), tests))
        return result

    @staticmethod
    def run_one(test, result):
        test.run(result)
        for failed, reason in result.failures + result.errors:
            if failed is test:
                words = [f"{name}: {line}" for name in ("slurmctld", "slurmd")
                         for line in test.cluster.log(name).splitlines()[-12:]]
                print(f"--- {test.id()}", reason, *words, sep="\n", flush=True)


def main():
    unittest.defaultTestLoader.suiteClass = SideBySide
    try:
        with Cluster(cpus=16) as cluster:  # for all jobs at once
            SlurmTest.cluster = cluster
            run_fabseq.main()
    except Unavailable as reason:
        text = f"Slurm cannot start here: {reason}"
        print(f"skipped: {text}")
        sys.exit(1 if run_fabseq.must_run(text) else SKIPPED)
