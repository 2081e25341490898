# SPDX-License-Identifier: MIT
"""Runs in place of others: the effective config runs again to the same result, and -overwrite replaces a
run."""

import os

import numpy as np

import run_fabseq
from read_outputs import read_result
from run_fabseq import FabseqTest, largest_relative_difference
from small_parts import part_density, plate_2d, write_voxels

ITERATIONS = 5


def scalar_history(run):
    """Of every iteration the numbers that do not depend on clock and memory."""
    lines = run.history()
    for line in lines:
        del line["seconds"], line["peak_memory_bytes"]
    return lines


class RerunTest(FabseqTest):
    def first_run(self, ranks):
        """A part from a voxel file beside the config: its path must still be right from elsewhere."""
        folder = os.path.join(self.directory, "elsewhere")
        os.mkdir(folder)
        config = plate_2d()
        write_voxels(os.path.join(folder, "part.h5"), part_density(config))
        config["part"] = {"voxels": {"file": "part.h5", "threshold": 0.5}}
        path = self.write_config(config, os.path.join("elsewhere", "case.json"))
        run = self.run_program(ranks, "-config", path, "-max_iterations", ITERATIONS, "-alpha", 0.3,
                               "-set", "projection.interval=2")
        self.assert_done(run)
        return run

    def rerun(self, ranks, first):
        run = self.run_program(ranks, "-config", first.path("config.json"))
        self.assert_done(run)
        effective, again = first.json("config.json"), run.json("config.json")
        self.assertIn("-alpha 0.3", effective["run"]["command_line"])
        self.assertEqual(effective["run"]["ranks"], ranks)
        del effective["run"], again["run"]
        self.assertEqual(effective, again)
        self.assertEqual(effective["objective"][1]["weight"], 0.3)
        self.assertEqual(effective["optimizer"]["max_iterations"], ITERATIONS)
        self.assertTrue(os.path.isabs(effective["part"]["voxels"]["file"]))
        return run

    def test_config_runs_again_to_the_same_result(self):
        first = self.first_run(1)
        again = self.rerun(1, first)
        self.assertEqual(scalar_history(again), scalar_history(first))
        expected = read_result(first)
        for name, values in read_result(again).items():
            np.testing.assert_array_equal(values, expected[name], err_msg=name)
        self.assertEqual(again.json("summary.json")["optimized"], first.json("summary.json")["optimized"])

    def test_config_runs_again_on_two_ranks(self):
        first = self.first_run(2)
        again = self.rerun(2, first)
        for line, expected in zip(scalar_history(again), scalar_history(first), strict=True):
            for key in ("objective", "objective_scaled", "constraints", "change", "beta"):
                self.assertLess(largest_relative_difference(line[key], expected[key]), 1e-8, key)

    def test_overwrite_leaves_nothing_of_the_old_run(self):
        output = os.path.join(self.directory, "kept")
        first = self.run_config(2, plate_2d(), "-max_iterations", 3, "-output_every", 1, "-checkpoint_every", 1,
                                output=output)
        self.assert_done(first)
        with open(os.path.join(output, "notes.txt"), "w", encoding="utf-8") as file:
            file.write("mine\n")
        second = self.run_config(2, plate_2d(), "-max_iterations", 2, "-output_every", 2, "-checkpoint_every", 0,
                                 "-overwrite", output=output)
        self.assert_done(second)
        self.assertEqual(len(second.history()), 2)
        self.assertEqual(sorted(os.listdir(second.path("fields"))), ["iteration_0002.bin", "iteration_0002.xdmf"])
        self.assertFalse(os.path.exists(second.path("checkpoint")))
        self.assertTrue(os.path.exists(second.path("notes.txt")), "-overwrite has removed a file that is not fabseq's")

    def test_overwrite_by_another_task(self):
        output = os.path.join(self.directory, "kept")
        expected = {"check_gradients": {"gradient_check.csv", "gradient_check.json"},
                    "evaluate": {"evaluation.json", "gradients.h5"},
                    "simulate": {"result.h5", "result.xdmf", "summary.json"}}
        for task, names in expected.items():
            run = self.run_config(2, plate_2d(), "-elements", "8,5", "-task", task, "-overwrite", output=output)
            self.assert_done(run)
            self.assertEqual(set(os.listdir(output)), names | {"config.json"}, task)
            for name in ("gradient_check.svg", "sensitivity.svg"):  # as tools draw them
                with open(run.path(name), "w", encoding="utf-8") as file:
                    file.write("drawn\n")

    def test_default_output_directory(self):
        run = self.run_config(1, plate_2d(), "-max_iterations", 1, output="")
        self.assert_done(run)
        self.assertTrue(os.path.exists(os.path.join(self.directory, "output", "plate", "summary.json")))


if __name__ == "__main__":
    run_fabseq.main()
