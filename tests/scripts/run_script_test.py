# SPDX-License-Identifier: MIT
"""scripts/use/run.sh: Ctrl-C says at once what happens, and leaves a checkpoint; a second one ends all."""

import json
import os
import signal
import subprocess
import sys
import tempfile
import time
import unittest

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path.insert(0, os.path.join(ROOT, "tests", "integration"))
from run_fabseq import DONE, ENVIRONMENT, PROGRAM, STOPPED  # noqa: E402
from small_parts import plate_2d  # noqa: E402

SCRIPT = os.path.join(ROOT, "scripts", "use", "run.sh")
PATIENCE = 60


class RunScriptTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory(prefix="fabseq_run_")
        self.addCleanup(self.folder.cleanup)
        with open(self.path("plate.json"), "w", encoding="utf-8") as file:
            json.dump(plate_2d(), file)

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def start(self, *arguments):
        """The script as a terminal starts it: in a group of its own, to which Ctrl-C goes."""
        errors = open(self.path("errors"), "w+", encoding="utf-8")
        self.addCleanup(errors.close)
        command = [SCRIPT, "-np", "2", "-config", self.path("plate.json"), "-output", self.path("out"), *arguments]
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=errors, start_new_session=True,
                                   env={**ENVIRONMENT, **os.environ, "FABSEQ_PROGRAM": PROGRAM})
        self.addCleanup(process.kill)
        return process

    def errors(self):
        with open(self.path("errors"), encoding="utf-8") as file:
            return file.read()

    def wait_until(self, condition):
        end = time.monotonic() + PATIENCE
        while not condition():
            self.assertLess(time.monotonic(), end, self.errors())
            time.sleep(0.02)

    def wait_for_history(self):
        history = self.path("out/history.jsonl")
        self.wait_until(lambda: os.path.exists(history) and os.path.getsize(history) > 0)

    def test_a_whole_run(self):
        self.assertEqual(self.start("-max_iterations", "2").wait(PATIENCE), DONE, self.errors())
        self.assertEqual(self.errors(), "")

    def test_control_c(self):
        process = self.start("-elements", "60,36", "-max_iterations", "100000")
        self.wait_for_history()
        os.killpg(process.pid, signal.SIGINT)
        begin = time.monotonic()
        self.wait_until(lambda: "stopping after the solve in hand" in self.errors())
        self.assertLess(time.monotonic() - begin, 2)
        self.assertEqual(process.wait(PATIENCE), STOPPED, self.errors())
        self.assertLess(time.monotonic() - begin, 20)
        self.assertIn("-restart auto continues", self.errors())
        with open(self.path("out/summary.json"), encoding="utf-8") as file:
            self.assertEqual(json.load(file)["status"], "stopped")
        self.assertTrue(os.path.exists(self.path("out/checkpoint/newest")))

    def test_a_second_one(self):
        process = self.start("-elements", "400,240", "-layers", "40", "-max_iterations", "100000")
        self.wait_until(lambda: os.path.exists(self.path("out/lock")))
        os.killpg(process.pid, signal.SIGINT)
        self.wait_until(lambda: "stopping after the solve in hand" in self.errors())
        os.killpg(process.pid, signal.SIGINT)
        self.assertEqual(process.wait(10), 137, self.errors())
        self.wait_until(lambda: subprocess.run(["pgrep", "-f", self.path("out")], capture_output=True, check=False).returncode)

    def test_usage(self):
        done = subprocess.run([SCRIPT], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 2)
        self.assertIn("usage: scripts/use/run.sh", done.stderr)


if __name__ == "__main__":
    unittest.main()
