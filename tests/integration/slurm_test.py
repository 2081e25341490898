#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""The batch script scripts/slurm/run.sh in a real Slurm (slurm_case.py): jobs that are warned, requeued,
cancelled or out of time go on from their checkpoint; and a cluster that leaves nothing behind."""

import os
import re
import signal
import subprocess
import sys
import time

import slurm_case
from compare_runs import assert_same_run
from run_fabseq import BAD_INPUT, DONE, ROOT, STOPPED, Result
from slurm_case import PATIENCE, RANKS, SMALL, SRUN, SlurmTest, processes_with
from small_parts import plate_2d


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


if __name__ == "__main__":
    slurm_case.main()
