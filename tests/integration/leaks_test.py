# SPDX-License-Identifier: MIT
"""A short run of every task leaves no memory behind (LeakSanitizer; only with sanitizers). What Open MPI
leaves is listed in tests/leak_suppressions.txt. And the memory of a long run does not grow."""

import os
import subprocess

import run_fabseq
from run_fabseq import DONE, OF_THIS_BUILD, ROOT, SANITIZED, FabseqTest, Process, Result
from small_parts import hook_3d, plate_2d

TASKS = ("optimize", "simulate", "evaluate", "check_gradients", "check")
SUPPRESSIONS = os.path.join(ROOT, "tests", "leak_suppressions.txt")
LEAKS = {"ASAN_OPTIONS": "detect_leaks=1:detect_odr_violation=0:fast_unwind_on_malloc=0",
         "LSAN_OPTIONS": f"suppressions={SUPPRESSIONS}:print_suppressions=0"}
MIB = 2**20


class LeaksTest(FabseqTest):
    def setUp(self):
        super().setUp()
        if not SANITIZED:
            self.skipTest(OF_THIS_BUILD + "needs the sanitizers")

    def check(self, ranks, config, *arguments):
        self.runs += 1
        output = os.path.join(self.directory, f"output_{self.runs}")
        command = ["mpirun", "-np", str(ranks), run_fabseq.PROGRAM, "-config",
                   self.write_config(config), "-output", output, *arguments]
        with Process(command, self.directory, LEAKS) as process:
            run = Result(command, *process.wait(600), output)
        self.assertNotIn("LeakSanitizer", run.stderr, str(run))
        self.assertEqual(run.status, DONE, str(run))

    def test_tasks(self):
        for task in TASKS:
            with self.subTest(task=task):
                self.check(2, plate_2d(), "-task", task, "-max_iterations", "2", "-checkpoint_every", "1")

    def test_space(self):
        self.check(2, hook_3d(), "-max_iterations", "2", "-output_every", "1")

    def test_layer_groups(self):
        self.check(2, plate_2d(), "-max_iterations", "2", "-layer_groups", "2")

    def test_reference_path(self):
        self.check(1, plate_2d(), "-max_iterations", "2", "-solver_path", "reference")


class SuppressionsTest(FabseqTest):
    """What libraries leave is not reported, and a handle of theirs that the program forgets is."""
    resumes = False

    def report(self, *arguments):
        program = os.path.join(self.directory, "forgotten_handle")
        if not os.path.exists(program):
            flags = subprocess.run(["pkg-config", "--cflags", "--libs", "PETSc", "ompi-c"],
                                   capture_output=True, text=True, check=True)
            source = os.path.join(ROOT, "tests", "faults", "forgotten_handle.cc")
            subprocess.run(["g++", "-g1", "-fsanitize=address", source, "-o", program, *flags.stdout.split()], check=True)
        with Process(["mpirun", "-np", "2", program, *arguments], self.directory, LEAKS) as process:
            status, _, stderr = process.wait(120)
        return status, stderr

    def test_a_forgotten_handle_is_seen(self):
        status, stderr = self.report()
        self.assertEqual((status, stderr), (DONE, ""))
        status, stderr = self.report("forget")
        self.assertNotEqual(status, DONE)
        self.assertRegex(stderr, "(?s)LeakSanitizer: detected memory leaks.*VecCreate")


class GrowthTest(FabseqTest):
    @run_fabseq.only_release
    def test_five_hundred_iterations(self):
        """Peaks of iteration 100, when what is freed has found its places in the heap, and of iteration 500:
        dumps and checkpoints have been written by both."""
        run = self.run_config(2, plate_2d(), "-max_iterations", 500, "-output_every", 10, "-checkpoint_every", 10)
        self.assert_done(run)
        peaks = [line["peak_memory_bytes"] for line in run.history()]
        self.assertEqual(len(peaks), 500)
        print(f"peak memory after 100 iterations {peaks[99] / MIB:.1f} MiB, after 500 {peaks[-1] / MIB:.1f} MiB")
        # A leak of 2.6 kB per iteration; peaks grow in pieces of the heap, too.
        self.assertLess(peaks[-1] - peaks[99], 1.0 * MIB)


if __name__ == "__main__":
    run_fabseq.main()
