#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""The batch scripts of scripts/slurm in a real Slurm of one node, started here and ended afterwards.

All tests run side by side: most of the time they wait for Slurm. Exit status 77, with the reason, where
Slurm cannot start: not root, or its packages missing; an error if Slurm must not be missing
(run_fabseq.must_run)."""

import csv
import os
import re
import signal
import subprocess
import sys
import time
import unittest
from concurrent.futures import ThreadPoolExecutor

import h5py

import run_fabseq
from compare_runs import assert_same_run
from run_fabseq import BAD_INPUT, DONE, ENVIRONMENT, PROGRAM, ROOT, STOPPED, FabseqTest, Result
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


class RunTest(SlurmTest):
    def check_same_as_uninterrupted(self, job, *arguments):
        expected = self.run_config(RANKS, plate_2d(), *arguments, timeout=PATIENCE)
        self.assertEqual(expected.status, DONE, str(expected))
        self.assertEqual(job.result().json("config.json")["run"]["ranks"], RANKS)
        assert_same_run(self, job.result(), expected, RANKS)


class MpirunTest(RunTest):
    def test_warned_then_requeued(self):
        """First as at the end of the job's time, only when it suits; then as by an administrator, without a
        warning."""
        arguments = (*SMALL, "-max_iterations", 150)
        job = self.submit_run(*arguments)
        job.wait_for_iterations(25)
        self.slurm("scancel", "--batch", "--signal=USR1", job.number)
        # Slurm counts the restart before the script gets to say so.
        job.wait_until(lambda: "queued again after iteration" in job.log(), "queued again")
        self.assertEqual(job.field("Restarts"), "1")
        done = self.newest_checkpoint(job.output)
        self.assertEqual(done, job.iterations(), job.log())
        self.assertIn(f"queued again after iteration {done}", job.log())
        job.wait_for_iterations(done + 25)
        requeued = self.slurm("scontrol", "requeue", job.number)
        self.assertEqual(requeued.returncode, 0, requeued.stderr)
        job.wait_until(lambda: job.field("JobState") == "PENDING", "waiting")
        second = self.newest_checkpoint(job.output)
        self.assertEqual(second, job.iterations(), "TERM left no time for a checkpoint\n" + job.log())
        job.wait_for_end("COMPLETED")
        print_transcript(job)
        self.assertEqual(job.field("Restarts"), "2")
        for iteration in (done, second):
            self.assertIn(f"continues after iteration {iteration} of", job.log())
        self.check_same_as_uninterrupted(job, *arguments)

    def test_cancelled(self):
        """It stays so, and can be continued by hand."""
        job = self.submit_run(*SMALL, "-max_iterations", 100000)
        job.wait_for_iterations(5)
        self.slurm("scancel", job.number)
        job.wait_until(lambda: job.field("JobState") == "CANCELLED", "cancelled")
        self.assertEqual(job.field("Restarts"), "0")
        self.assertNotIn("queued again", job.log())
        self.assertEqual(self.newest_checkpoint(job.output), job.iterations())

    def test_statuses_arrive(self):
        self.submit_run("-layers", 0).wait_for_end("FAILED", f"{BAD_INPUT}:0")
        job = self.submit_run("-max_iterations", 100000)
        job.wait_for_iterations(1)
        with open(os.path.join(job.output, "stop"), "w", encoding="utf-8"):
            pass
        job.wait_for_end("FAILED", f"{STOPPED}:0")
        self.assertEqual(job.field("Restarts"), "0")
        self.assertNotIn("queued again", job.log())


class SrunTest(MpirunTest):
    form = SRUN


class TimeTest(RunTest):
    def test_time_limit(self):
        """The least that Slurm has, one minute; it looks every 30 seconds whether the time is near. The run,
        stopped on its way, is not done by then; it goes on when the warning has come, and the job comes
        back."""
        arguments = (*SMALL, "-max_iterations", 100)
        job = self.submit_run(*arguments, time_limit="1", options=["--signal=B:USR1@5"])
        job.wait_for_iterations(10)
        ranks = job.ranks()
        self.assertEqual(len(ranks), RANKS, job.log())
        for process in ranks:
            os.kill(process, signal.SIGSTOP)
        job.wait_until(lambda: all(is_pending(signal.SIGUSR1, process) for process in ranks), "warned")
        for process in ranks:
            os.kill(process, signal.SIGCONT)
        job.wait_for_end("COMPLETED")
        print_transcript(job)
        self.assertEqual(job.field("Restarts"), "1")
        self.assertEqual(job.log().count("queued again after iteration"), 1, job.log())
        self.assertIn("continues after iteration", job.log())
        self.check_same_as_uninterrupted(job, *arguments)

    def test_no_endless_loop(self):
        """A job that has no time for an iteration gives up."""
        config = os.path.join(ROOT, "configs", "v_shape_coarse.json")
        with open(config, encoding="utf-8") as file:
            job = self.submit_run("-max_iterations", 2, config=file.read())
        job.wait_until(lambda: os.path.exists(os.path.join(job.output, "config.json")), "started")
        self.slurm("scancel", "--batch", "--signal=USR1", job.number)
        job.wait_for_end("FAILED", f"{STOPPED}:0")
        self.assertIn("no iteration was completed", job.log())
        self.assertEqual(job.field("Restarts"), "0")


class StudyTest(SlurmTest):
    TABLE = """\
name,objective.layer_uniformity.weight,projection,optimizer.max_iterations
# A remark, an object with a comma, and a key that is left as it is.
uneven,0.1,,40
none,-1,,40
even,1,"{""beta"": 12, ""interval"": 5}",300
"""

    def test_array(self):
        table = os.path.join(self.directory, "table.csv")
        with open(table, "w", encoding="utf-8") as file:
            file.write(self.TABLE)
        output = os.path.join(self.directory, "study")
        number = self.submit("study.sh", self.write_config(plate_2d()), table, output, *SMALL, "-checkpoint_every", 7,
                             options=("--array=1-3", f"--output={self.directory}/study_%a.log"))
        jobs = {name: Job(self, f"{number}_{task}", f"{self.directory}/study_{task}.log", os.path.join(output, name))
                for task, name in enumerate(("uneven", "none", "even"), start=1)}
        # The tasks run side by side, and this one may end before the others.
        jobs["even"].wait_for_iterations(10)
        self.slurm("scancel", "--batch", "--signal=USR1", f"{number}_3")
        jobs["uneven"].wait_for_end("COMPLETED")
        jobs["none"].wait_for_end("FAILED", f"{BAD_INPUT}:0")
        # The last task goes by the number of the whole array.
        self.assertEqual(jobs["even"].field("JobId"), number)
        jobs["even"].wait_for_end("COMPLETED")
        self.assertEqual([jobs[name].field("Restarts") for name in ("uneven", "none", "even")], ["0", "0", "1"])
        self.assertEqual(sorted(os.listdir(output)), ["even", "uneven"])
        expected = {"even": ("-beta", 12, "-set", "projection.interval=5", "-max_iterations", 300),
                    "uneven": ("-alpha", 0.1, "-max_iterations", 40)}
        for name, arguments in expected.items():
            run = self.run_config(RANKS, plate_2d(), *SMALL, "-checkpoint_every", 7, *arguments)
            assert_same_run(self, jobs[name].result(), run, RANKS)
        self.check_compare(output)

    def check_compare(self, output):
        done = subprocess.run(["/usr/bin/python3", os.path.join(ROOT, "scripts", "fabseq-tools"), "compare",
                               os.path.join(output, "even"), os.path.join(output, "uneven")], cwd=self.directory,
                              capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(os.path.join(self.directory, "compare.csv"), encoding="utf-8", newline="") as file:
            rows = {row["run"]: row for row in csv.DictReader(file)}
        self.assertEqual([rows[name]["objective.layer_uniformity.weight"] for name in ("even", "uneven")], ["1", "0.1"])
        self.assertEqual([rows[name]["optimizer.max_iterations"] for name in ("even", "uneven")], ["300", "40"])
        self.assertTrue(os.path.exists(os.path.join(self.directory, "compare.png")))


class ScalingTest(SlurmTest):
    def setUp(self):
        """In a cluster of its own: its jobs want the node for themselves."""
        self.cluster = Cluster(cpus=RANKS)
        self.addCleanup(self.cluster.stop)
        super().setUp()

    def test_two_rank_counts(self):
        output = os.path.join(self.directory, "scaling")
        done = subprocess.run(["bash", os.path.join(SCRIPTS, "scaling.sh"), self.write_config(plate_2d()), output, "2 1", *SMALL],
                              cwd=self.directory, env=self.environment, capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        numbers = re.findall(r"^job (\d+):", done.stdout, re.MULTILINE)
        self.assertEqual(len(numbers), 3, done.stdout)
        job = Job(self, numbers[2], os.path.join(output, "scaling.log"), output)
        job.wait_for_end("COMPLETED")
        with open(os.path.join(output, "scaling.csv"), encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([(row["ranks"], row["iterations"]) for row in rows], [("1", "10"), ("2", "10")])
        self.assertGreater(float(rows[1]["speed_up"]), 0)
        self.assertTrue(os.path.exists(os.path.join(output, "scaling.png")))


class CleanUpTest(SlurmTest):
    def test_nothing_is_left_when_the_owner_is_killed(self):
        """Of a second cluster, with a job under way."""
        here = os.path.dirname(os.path.abspath(__file__))
        command = ("sbatch --wrap='sleep 600'; until squeue --noheader --states=R | grep -q .; do sleep 0.1; done; "
                   "echo $SLURM_CONF; sleep 600")
        owner = subprocess.Popen([sys.executable, os.path.join(here, "slurm_cluster.py"), "bash", "-c", command],
                                 stdout=subprocess.PIPE, text=True)
        with owner:
            folder = None
            for line in owner.stdout:
                if line.endswith("slurm.conf\n"):
                    folder = os.path.dirname(line.strip())
                    break
            self.assertIsNotNone(folder)
            owner.kill()
        end = time.monotonic() + 60
        # The guard removes the folder, whose name is in its command line, and ends.
        while (os.path.exists(folder) or processes_with(folder)) and time.monotonic() < end:
            time.sleep(0.1)
        self.assertFalse(os.path.exists(folder))
        self.assertEqual(processes_with(folder), [])


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


def is_pending(number, process):
    """Whether a signal waits for a process that has been stopped."""
    with open(f"/proc/{process}/status", encoding="utf-8") as file:
        waiting = re.search(r"^ShdPnd:\s*([0-9a-f]+)", file.read(), re.MULTILINE).group(1)
    return bool(int(waiting, 16) >> (number - 1) & 1)


def print_transcript(job):
    """What the job and Slurm said, less the iterations and mpirun's remarks on a status other than 0."""
    print(f"--- {job.log_path}")
    result = Result([], None, "", job.log(), "")
    print(*(line for line in result.messages() if not line.startswith("iteration ")), sep="\n")
    print(f"--- job {job.number}: {job.field('JobState')}, restarts: {job.field('Restarts')}", flush=True)


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


if __name__ == "__main__":
    main()
