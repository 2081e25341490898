# SPDX-License-Identifier: MIT
"""scripts/use/run.sh: signals to it alone; launch_test.py types Ctrl-C at a terminal."""

import json
import os
import signal
import subprocess
import tempfile
import time
import unittest

from run_fabseq import DONE, ENVIRONMENT, PROGRAM, STOPPED
from small_parts import plate_2d

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))

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

    def test_term(self):
        """Twice within a moment, as `timeout` sends it: to the process, and to its group."""
        process = self.start("-elements", "60,36", "-max_iterations", "100000")
        self.wait_for_history()
        process.terminate()
        os.killpg(process.pid, signal.SIGTERM)
        begin = time.monotonic()
        self.wait_until(lambda: "stopping after the solve in hand" in self.errors())
        self.assertLess(time.monotonic() - begin, 20)
        self.assertEqual(process.wait(PATIENCE), STOPPED, self.errors())
        self.assertLess(time.monotonic() - begin, 20)
        self.assertNotIn("ending at once", self.errors())
        self.assertIn("-restart auto continues", self.errors())
        with open(self.path("out/summary.json"), encoding="utf-8") as file:
            self.assertEqual(json.load(file)["status"], "stopped")
        self.assertTrue(os.path.exists(self.path("out/checkpoint/newest")))

    def test_hung_ranks(self):
        """A third signal ends even what cannot answer."""
        process = self.start("-elements", "60,36", "-max_iterations", "100000")
        self.wait_for_history()
        ranks = subprocess.run(["pgrep", "-f", self.path("out")], capture_output=True, text=True, check=True).stdout.split()
        ranks = [int(rank) for rank in ranks if os.path.realpath(f"/proc/{rank}/exe") == os.path.realpath(PROGRAM)]
        self.assertEqual(len(ranks), 2)
        for rank in ranks:
            os.kill(rank, signal.SIGSTOP)
        self.addCleanup(subprocess.run, ["kill", "-KILL", *map(str, ranks)], stderr=subprocess.DEVNULL, check=False)
        for message in ("stopping after the solve in hand", "ending at once"):
            process.terminate()
            self.wait_until(lambda expected=message: expected in self.errors())
            time.sleep(0.2)  # sooner, it is the same signal
        process.terminate()
        self.assertEqual(process.wait(PATIENCE), 128 + signal.SIGKILL, self.errors())

    def test_input_is_left_alone(self):
        """In a loop that reads lines, they are the loop's."""
        loop = f"while read -r word; do {SCRIPT} -np 1 -help >/dev/null && echo $word; done"
        done = subprocess.run(["bash", "-c", loop], input="first\nsecond\n", capture_output=True, text=True, timeout=PATIENCE,
                              env={**ENVIRONMENT, **os.environ, "FABSEQ_PROGRAM": PROGRAM}, check=False)
        self.assertEqual(done.stdout, "first\nsecond\n", done.stderr)

    def test_usage(self):
        done = subprocess.run([SCRIPT], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 2)
        self.assertIn("usage: scripts/use/run.sh", done.stderr)


if __name__ == "__main__":
    unittest.main()
