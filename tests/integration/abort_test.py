# SPDX-License-Identifier: MIT
"""An exception that is none of fabseq's, on one rank while others wait for it: all ranks end with status
3."""

import os
import time

import run_fabseq
from run_fabseq import DONE, FabseqTest, NUMERICAL_FAILURE, PROGRAM, Process, Result
from small_parts import plate_2d

RANKS, RANK = 3, 1


@run_fabseq.only_release  # whose own allocator cannot be replaced
class AbortTest(FabseqTest):
    resumes = False

    def setUp(self):
        super().setUp()
        self.library = run_fabseq.build_preload(self.directory, "failing_new")

    def run_failing(self, number):
        """A run in which that allocation of one rank throws std::bad_alloc; 0: none does."""
        self.runs += 1
        output = os.path.join(self.directory, f"output_{self.runs}")
        command = ["mpirun", "-np", str(RANKS), "-x", f"LD_PRELOAD={self.library}", PROGRAM, "-config",
                   self.write_config(plate_2d()), "-max_iterations", "2", "-output", output]
        environment = {"FAILING_RANK": str(RANK), "FAILING_NUMBER": str(number), "FAILING_REPORT": self.directory}
        with Process(command, self.directory, environment) as process:
            return Result(command, *process.wait(120), output)

    def test_memory_that_cannot_be_had_aborts_all_ranks(self):
        whole = self.run_failing(0)
        self.assertEqual(whole.status, DONE, str(whole))
        with open(os.path.join(self.directory, str(RANK)), encoding="utf-8") as file:
            calls = int(file.read())
        self.assertGreater(calls, 100)
        for part in (0.2, 0.5, 0.65):
            with self.subTest(part=part):
                start = time.monotonic()
                run = self.run_failing(int(part * calls))
                self.assertEqual(run.status, NUMERICAL_FAILURE, str(run))
                self.assertEqual([line for line in run.stderr.splitlines() if line.startswith("fabseq: ")],
                                 [f"fabseq: rank {RANK}: std::bad_alloc"], str(run))
                self.assertLess(time.monotonic() - start, 60)


if __name__ == "__main__":
    run_fabseq.main()
