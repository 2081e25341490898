#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""The batch scripts study.sh and scaling.sh of scripts/slurm in a real Slurm (slurm_case.py): an array of
runs, and runs on several rank counts."""

import csv
import os
import re
import subprocess

import slurm_case
from compare_runs import assert_same_run
from run_fabseq import BAD_INPUT, ROOT
from slurm_case import RANKS, SCRIPTS, SMALL, Job, SlurmTest
from slurm_cluster import Cluster
from small_parts import plate_2d


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


if __name__ == "__main__":
    slurm_case.main()
