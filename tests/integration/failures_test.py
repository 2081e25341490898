# SPDX-License-Identifier: MIT
"""Solvers that do not converge (exit status 3) and disks that are full (5): one line that names the place, no
hang."""

import os
import subprocess

import h5py
import numpy as np

import run_fabseq
from compare_runs import history_text
from read_outputs import read_dump
from run_fabseq import FabseqTest, NUMERICAL_FAILURE, OUTPUT_FAILURE, distinct
from small_parts import hook_3d, plate_2d


class FailureTest(FabseqTest):

    def assert_fails(self, result, status, *patterns):
        self.assertEqual(result.status, status, str(result))
        messages = [line for line in result.messages() if not line.startswith("warning: ")]
        self.assertEqual(len(messages), 1, str(result))
        self.assertTrue(messages[0].startswith("fabseq: "), str(result))
        for pattern in patterns:
            self.assertRegex(messages[0], pattern)
        return messages[0]


class SolverTest(FailureTest):
    never_converges = ("-solver_path", "reference", "-reference_method", "gamg", "-elasticity_ksp_max_it", 1)
    message = (r"layer 1\b", r"\b1 iterations", r"residual \d")

    def test_optimize_leaves_a_checkpoint_and_a_summary(self):
        for ranks in distinct(3, 1):
            with self.subTest(ranks=ranks):
                run = self.run_config(ranks, hook_3d(), *self.never_converges)
                message = self.assert_fails(run, NUMERICAL_FAILURE, *self.message)
                summary = run.json("summary.json")
                self.assertEqual((summary["status"], summary["iterations"]), ("failed", 0))
                self.assertEqual(message, "fabseq: " + summary["reason"])
                with open(run.path("checkpoint/newest"), encoding="utf-8") as file:
                    slot = file.read().strip()
                with h5py.File(run.path("checkpoint/" + slot), "r") as file:
                    self.assertEqual(file.attrs["iteration"], 0)
                    design = file["design"][()]
                self.assertEqual(design.shape, (8, 4, 8))
                self.assertEqual(np.count_nonzero(design), 8 * 4 * 8 - 4 * 4 * 5)
                fields = read_dump(run, "0001_failed")
                np.testing.assert_array_equal(fields["design"].ravel(), design.ravel())
                self.assertEqual(set(fields), {"density", "design"})  # it was the planar baseline that failed
                # With a solver that converges the run goes on from there.
                resumed = self.run_config(ranks, hook_3d(), "-restart", run.output, "-max_iterations", 2,
                                          output=run.output)
                self.assert_done(resumed)
                self.assertEqual(len(resumed.history()), 2)

    def test_failure_in_an_iteration(self):
        """GAMG needs more steps once layers are sharper. The state before that iteration is in the
        checkpoint, its fields are in a dump, and with steps enough the run goes on as if nothing had
        happened."""
        arguments = ("-max_iterations", 5, "-solver_path", "reference", "-reference_method", "gamg", "-set",
                     "projection.interval=2")
        run = self.run_config(1, hook_3d(), *arguments, "-elasticity_ksp_max_it", 19)
        message = self.assert_fails(run, NUMERICAL_FAILURE, r"layer \d\b", r"\b19 iterations")
        self.assertEqual(run.json("summary.json")["reason"], message[len("fabseq: "):])
        done = len(run.history())
        self.assertGreater(done, 0)
        fields = read_dump(run, f"{done + 1:04d}_failed")
        self.assertEqual(set(fields), {"density", "design", "time", "layer", "temperature"})
        self.assertEqual(fields["layer"].max(), 3)
        expected = self.run_config(1, hook_3d(), *arguments, "-checkpoint_every", done)
        resumed = self.run_config(1, hook_3d(), *arguments, "-checkpoint_every", done, "-restart", "auto",
                                  output=run.output)
        self.assert_done(resumed)
        self.assertEqual(history_text(resumed), history_text(expected))

    def test_other_tasks(self):
        for task in ("simulate", "evaluate", "check_gradients"):
            for ranks in distinct(3, 1):
                with self.subTest(task=task, ranks=ranks):
                    run = self.run_config(ranks, hook_3d(), "-task", task, *self.never_converges)
                    self.assert_fails(run, NUMERICAL_FAILURE, *self.message)

    def test_release(self):
        """The simulation is done when the release fails: all its results are there."""
        for ranks in distinct(3, 1):
            with self.subTest(ranks=ranks):
                run = self.run_config(ranks, hook_3d(), "-task", "simulate", "-solver_path", "reference",
                                      "-reference_method", "gamg", "-release_ksp_max_it", 1)
                message = self.assert_fails(run, NUMERICAL_FAILURE, "release", r"\b1 iterations", r"residual \d")
                summary = run.json("summary.json")
                self.assertEqual(summary["status"], "failed")
                self.assertEqual(message, "fabseq: " + summary["reason"])
                self.assertEqual(len(summary["layers"]), 3)
                with h5py.File(run.path("result.h5"), "r") as file:
                    self.assertGreater(np.abs(file["displacement"][()]).max(), 0.0)
                    self.assertIn("residual_stress", file)
                    self.assertNotIn("release_displacement", file)
                    self.assertNotIn("released_displacement", file)

    def test_heat(self):
        for ranks in distinct(3, 1):
            with self.subTest(ranks=ranks):
                run = self.run_config(ranks, plate_2d(), "-solver_path", "reference", "-heat_ksp_type", "richardson",
                                      "-heat_pc_type", "none", "-heat_ksp_max_it", 2)
                self.assert_fails(run, NUMERICAL_FAILURE, "heat", r"\b2 iterations", "residual")
                self.assertEqual(run.json("summary.json")["status"], "failed")


class OutputTest(FailureTest):
    def test_full_history(self):
        """A file of the run is a device on which nothing fits."""
        if not os.path.exists("/dev/full"):
            self.skipTest("there is no /dev/full")
        for ranks in distinct(3, 1):
            with self.subTest(ranks=ranks):
                output = os.path.join(self.directory, f"full_{ranks}")
                os.mkdir(output)
                os.symlink("/dev/full", os.path.join(output, "history.jsonl"))
                run = self.run_config(ranks, plate_2d(), "-max_iterations", 2, output=output)
                self.assert_fails(run, OUTPUT_FAILURE, r"history\.jsonl", "No space left on device")

    def test_directory_below_a_file(self):
        with open(os.path.join(self.directory, "file"), "w", encoding="utf-8") as file:
            file.write("mine\n")
        for ranks in distinct(3, 1):
            run = self.run_config(ranks, plate_2d(), output=os.path.join(self.directory, "file", "run"))
            self.assert_fails(run, OUTPUT_FAILURE, "file/run")


class FullDiskTest(FailureTest):
    """Output on a disk of 2 MB in memory, of which a filler leaves too little for one of the run's
    files."""

    def setUp(self):
        super().setUp()
        self.disk = self.small_disk("2048k")

    def run_on_disk(self, ranks, free, *arguments):
        """Runs hook_3d on 12 x 8 x 12 elements: the dump takes about 130 kB, the result 400, the checkpoint
        70."""
        name = f"{ranks}_{free}"
        with open(os.path.join(self.disk, "filler"), "wb") as file:
            file.write(bytes(2048 * 1024 - free))
        return self.run_config(ranks, hook_3d(), "-elements", "12,8,12", "-max_iterations", 1, *arguments,
                               output=os.path.join(self.disk, name))

    def check(self, free, file, *arguments):
        for ranks in distinct(3, 1):
            with self.subTest(ranks=ranks):
                run = self.run_on_disk(ranks, free, *arguments)
                self.assert_fails(run, OUTPUT_FAILURE, file)
                partial = [name for folder in os.walk(run.output) for name in folder[2] if name.endswith(".partial")]
                self.assertEqual(partial, [])
                self.assertFalse(os.path.exists(run.path("summary.json")))
                subprocess.run(["rm", "-rf", run.output], check=True)

    def test_config(self):
        self.check(0, r"disk/[13]_0")

    def test_field_dump(self):
        self.check(48 * 1024, r"fields/iteration_0001\.bin", "-output_every", 1)

    def test_checkpoint(self):
        self.check(16 * 1024, r"checkpoint/slot_[01]\.h5", "-output_every", 0, "-checkpoint_every", 1)

    def test_result(self):
        self.check(48 * 1024, r"result\.h5", "-output_every", 0, "-checkpoint_every", 0)

    def test_results_of_other_tasks(self):
        self.check(48 * 1024, r"result\.h5", "-task", "simulate")
        self.check(48 * 1024, r"gradients\.h5", "-task", "evaluate")

    def test_room_enough(self):
        """The same run with the disk empty, so that the failures above are the disk's."""
        run = self.run_on_disk(3, 2048 * 1024, "-output_every", 1, "-checkpoint_every", 1)
        self.assert_done(run)


if __name__ == "__main__":
    run_fabseq.main()
