# SPDX-License-Identifier: MIT
"""scripts/use/study.sh: the runs of a table one after the other, again from where it was."""

import json
import os
import subprocess
import tempfile
import unittest

from run_fabseq import ENVIRONMENT, PROGRAM
from small_parts import plate_2d

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))

SCRIPT = os.path.join(ROOT, "scripts", "use", "study.sh")


class StudyScriptTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory(prefix="fabseq_study_")
        self.addCleanup(self.folder.cleanup)
        with open(self.path("plate.json"), "w", encoding="utf-8") as file:
            json.dump(plate_2d(), file)

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def study(self, table, *arguments):
        with open(self.path("table.csv"), "w", encoding="utf-8") as file:
            file.write(table)
        command = [SCRIPT, "-np", "1", self.path("plate.json"), self.path("table.csv"), self.path("out"), *arguments]
        return subprocess.run(command, capture_output=True, text=True, timeout=120, check=False,
                              env={**ENVIRONMENT, **os.environ, "FABSEQ_PROGRAM": PROGRAM})

    def test_every_line_is_a_run(self):
        table = "name,layers.count\nthree,3\nfour,4\n"
        done = self.study(table, "-max_iterations", "1")
        self.assertEqual(done.returncode, 0, done.stderr)
        for name, count in (("three", 3), ("four", 4)):
            with open(self.path(f"out/{name}/config.json"), encoding="utf-8") as file:
                self.assertEqual(json.load(file)["layers"]["count"], count)
        again = self.study(table, "-max_iterations", "1")
        self.assertEqual(again.returncode, 0, again.stderr)
        self.assertEqual(again.stdout.count("continues after iteration 1"), 2, again.stdout)

    def test_runs_that_fail(self):
        done = self.study("name,layers.count\nnone,0\nthree,3\n", "-max_iterations", "1")
        self.assertEqual(done.returncode, 1)
        self.assertIn("not done, with their exit status: none (2)", done.stderr)
        self.assertTrue(os.path.exists(self.path("out/three/summary.json")))

    def test_a_table_that_is_none(self):
        done = self.study("layers.count\n3\n")
        self.assertEqual(done.returncode, 2)
        self.assertIn("the first line must name all columns", done.stderr)


if __name__ == "__main__":
    unittest.main()
