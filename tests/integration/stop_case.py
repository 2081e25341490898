# SPDX-License-Identifier: MIT
"""Long runs that are ended from outside, and how they go on, for the tests of that."""

import os
import time

from compare_runs import history_text
from run_fabseq import PROGRAM, SANITIZED, STOPPED, FabseqTest, Process, Result, distinct
from small_parts import plate_2d

PATIENCE = 600 if SANITIZED else 240
# Long enough for what happens here to happen on the way.
LONG = ("-elements", "60,36", "-max_iterations", "100000")


class StopTest(FabseqTest):
    def start(self, ranks, output, *arguments, environment=None):
        path = self.write_config(plate_2d())
        command = ["mpirun", "-np", str(ranks), PROGRAM, "-config", path, "-output", output, *LONG,
                   *map(str, arguments)]
        return Process(command, self.directory, environment)

    def wait_for_lines(self, process, output, count):
        """Until the history has that many lines."""
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end:
            self.assertIsNone(process.process.poll(), "the run has ended by itself")
            try:
                with open(os.path.join(output, "history.jsonl"), encoding="utf-8") as file:
                    if len(file.readlines()) >= count:
                        return
            except FileNotFoundError:
                pass
            time.sleep(0.01)
        self.fail(f"no {count} lines after {PATIENCE} s")

    def finish(self, process, output):
        return Result(process.command, *process.wait(PATIENCE), output)

    def check_goes_on(self, ranks, output, *arguments):
        """Continues for four iterations, and compares with a run that was not interrupted but wrote a
        checkpoint at the same iteration: without sanitizers, which do not look at digits."""
        stopped = Result([], STOPPED, "", "", output)
        done = len(stopped.history())
        self.assertEqual(stopped.json("summary.json")["status"], "stopped")
        self.assertEqual(stopped.json("summary.json")["iterations"], done)
        runs = []
        expected = output + "_expected"
        os.mkdir(expected)
        for folder, options in distinct((output, ("-restart", "auto", "-checkpoint_every", done)),
                                        (expected, ("-checkpoint_every", done))):
            with open(os.path.join(folder, "stop"), "w", encoding="utf-8") as file:
                file.write(str(done + 4))
            with self.start(ranks, folder, *arguments, *options) as process:
                runs.append(self.finish(process, folder))
            self.assertEqual(runs[-1].status, STOPPED, str(runs[-1]))
        self.assertIn(f"continues after iteration {done} of", runs[0].stdout)
        self.assertEqual(history_text(runs[0]), history_text(runs[-1]))
        self.assertEqual(len(runs[0].history()), done + 4)
