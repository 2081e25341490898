# SPDX-License-Identifier: MIT
"""Runs that continue come to what uninterrupted runs come to: cut after any iteration, on other ranks, with
the same history."""

import json
import os
import shutil

import h5py
import numpy as np

import run_fabseq
from compare_runs import assert_same_run, history_text
from read_outputs import read_dump
from restart_case import RestartTest
from run_fabseq import DONE, STOPPED, distinct, largest_relative_difference
from small_parts import hook_3d, plate_2d, post_on_substrate


class SameBytesTest(RestartTest):
    def check(self, ranks, config, *arguments, all_cuts=distinct((2, 5), (3,))):
        """Cut after these of 6 iterations."""
        arguments = ("-max_iterations", 6, "-set", "projection.interval=2", "-output_every", 2, "-checkpoint_every", 3,
                     *arguments)
        expected = self.run_config(ranks, config, *arguments)
        self.assert_done(expected)
        for cuts in all_cuts:
            with self.subTest(ranks=ranks, cuts=cuts):
                output = os.path.join(self.directory, f"cut_{ranks}_{cuts[0]}")
                for cut in cuts:
                    os.makedirs(output, exist_ok=True)
                    with open(os.path.join(output, "stop"), "w", encoding="utf-8") as file:
                        file.write(str(cut))
                    run = self.run_config(ranks, config, *arguments, "-restart", "auto", output=output)
                    # The end of the last iteration is the end: the file is too late.
                    self.assertEqual(run.status, DONE if cut == 6 else STOPPED, str(run))
                if os.path.exists(os.path.join(output, "stop")):
                    os.remove(os.path.join(output, "stop"))
                run = self.run_config(ranks, config, *arguments, "-restart", "auto", output=output)
                self.assert_done(run)
                assert_same_run(self, run, expected, ranks)

    def test_plane(self):
        """Also before the first iteration and after the last."""
        for ranks in distinct(3, 1):
            self.check(ranks, plate_2d(), all_cuts=distinct((2, 5), (0,), (1,), (3,), (6,)))

    def test_layer_groups(self):
        """By what work layers are dealt out to groups lasts from one iteration to the next."""
        self.check(2, plate_2d(), "-layer_groups", 2, "-layers", 9)
        self.check(4, hook_3d(), "-layer_groups", 2, "-layers", 11)

    def test_solid(self):
        self.check(2, hook_3d(), "-void", "quiet", "-filter_radius", 0.45)

    def test_tolerance_that_follows_the_design(self):
        """Whatever decides how closely the next iteration is solved is in the checkpoint."""
        tolerances = [line["tolerance"] for line in self.run_config(
            1, plate_2d(), "-tolerance", "auto", "-max_iterations", 10).history()]
        self.assertLessEqual(tolerances[0], 1e-2)
        self.assertGreater(tolerances[0], 1e-3)
        self.assertLess(tolerances[-1], tolerances[-2])
        self.assertLessEqual(tolerances[-1], 1e-3)  # as closely as binary layers are judged

    def test_released_from_clamps(self):
        self.resumes = True
        self.assert_done(self.run_config(2, post_on_substrate(2), "-max_iterations", 4))

    def check_cold_start(self, config, *options):
        """A run that wrote its checkpoint where another one was stopped gives the same bytes."""
        expected = self.run_config(2, config, *options, "-checkpoint_every", 3)
        self.assert_done(expected)
        half = self.half_run(2, config, 3, *options)
        run = self.run_config(2, config, *options, "-restart", half.output, output=half.output)
        self.assert_done(run)
        self.assertEqual(history_text(run), history_text(expected))

    def test_reference_path_starts_cold_after_a_checkpoint(self):
        """Its systems last from one iteration to the next, those of a relaxed preconditioner too."""
        for method in ("direct", "gamg", "multigrid"):
            with self.subTest(method=method):
                self.check_cold_start(plate_2d(), "-max_iterations", 5, "-solver_path", "reference", "-elements", "40,24",
                                      "-reference_method", method)

    def test_warm_solves_start_cold_after_a_checkpoint(self):
        """They begin with the last design's solutions, but behind a checkpoint."""
        self.check_cold_start(plate_2d(), "-max_iterations", 6, "-tolerance", "auto")
        for groups in distinct(1, 2):
            with self.subTest(groups=groups):
                self.check_cold_start(hook_3d(), "-max_iterations", 6, "-layers", 10,
                                      "-layer_groups", groups, "-tolerance", "auto")

    def test_plastic_flow_starts_cold_after_a_checkpoint(self):
        """Its sweeps begin from the last design's state, but behind a checkpoint."""
        config = hook_3d()
        config["process"] = {"model": "elastoplastic", "deposition": "nominal"}
        config["material"] = {"yield_stress": 0.002, "hardening": 0.02}
        for groups in distinct(1, 2):
            with self.subTest(groups=groups):
                self.check_cold_start(config, "-max_iterations", 6, "-layers", 10, "-layer_groups", groups)

    def test_kept_scales_and_best_iterate(self):
        """The checkpoint is the same, whether the run was cut before or not."""
        arguments = ("-max_iterations", 5, "-checkpoint_every", 5)
        expected = self.run_config(1, plate_2d(), *arguments)
        half = self.half_run(1, plate_2d(), 2, *arguments)
        run = self.run_config(1, plate_2d(), *arguments, "-restart", "auto", output=half.output)
        self.assert_done(run)
        with h5py.File(self.slots(run)[0], "r") as file, h5py.File(self.slots(expected)[0], "r") as wanted:
            names = [name for name in wanted.attrs if not name.startswith(("seconds/", "checksum", "history/"))]
            self.assertEqual({name: file.attrs[name] for name in names}, {name: wanted.attrs[name] for name in names})
            for name in ("design", "best/design", "problem/first_values", "optimizer/low", "optimizer/upp",
                         "optimizer/previous", "optimizer/before_previous"):
                np.testing.assert_array_equal(file[name][()], wanted[name][()], err_msg=name)


class OtherRanksTest(RestartTest):
    def check(self, groups, splits):
        """Half of the run on two ranks as so many groups, the rest on ranks and groups of each of
        `splits`."""
        arguments = ("-max_iterations", 8, "-tolerance", "1e-11")
        for config in distinct(hook_3d(), plate_2d()):
            expected = self.run_config(1, config, *arguments)
            half = self.half_run(2, config, 3, *arguments, "-layer_groups", groups)
            self.assertEqual(half.json("summary.json")["layer_groups"], groups)
            for ranks, other_groups in splits:
                with self.subTest(config=config["name"], ranks=ranks, groups=other_groups):
                    output = os.path.join(self.directory, f"{config['name']}_{ranks}_{other_groups}")
                    shutil.copytree(half.output, output)
                    run = self.run_config(ranks, config, *arguments, "-layer_groups", other_groups, "-restart", output,
                                          output=output)
                    self.assert_done(run)
                    self.assertEqual(run.json("summary.json")["layer_groups"], other_groups)
                    self.assertEqual(len(run.history()), 8)
                    for line, wanted in zip(run.history(), expected.history(), strict=True):
                        for key in ("objective", "objective_scaled", "constraints", "change", "beta"):
                            self.assertLess(largest_relative_difference(line[key], wanted[key]), 1e-6,
                                            f"{key} of iteration {line['iteration']}")

    def test_any_number_of_ranks(self):
        self.check(1, distinct((3, 1), (1, 1), (4, 1)))

    def test_any_number_of_layer_groups(self):
        self.check(2, distinct((3, 3), (1, 1), (2, 1), (4, 2)))


class HistoryTest(RestartTest):
    def test_lines_after_the_checkpoint_go(self):
        """As after a kill: the history is ahead of the last checkpoint, its last line cut in the middle."""
        expected = self.run_config(1, plate_2d(), "-max_iterations", 6)
        half = self.half_run(1, plate_2d(), 3, "-max_iterations", 6)
        with open(expected.path("history.jsonl"), encoding="utf-8") as file:
            lines = file.readlines()
        with open(half.path("history.jsonl"), "a", encoding="utf-8") as file:
            file.write(lines[3] + lines[4][:70])
        run = self.run_config(1, plate_2d(), "-max_iterations", 6, "-restart", "auto", output=half.output)
        self.assert_done(run)
        assert_same_run(self, run, expected, 1)

    def test_config_and_summary_are_the_last_runs(self):
        half = self.half_run(2, plate_2d(), 3, "-max_iterations", 5)
        self.assertEqual(half.json("summary.json")["iterations"], 3)
        self.assertIn("baseline", half.json("summary.json"))
        run = self.run_config(1, plate_2d(), "-max_iterations", 5, "-restart", "auto", output=half.output)
        self.assert_done(run)
        self.assertEqual(run.json("config.json")["run"]["ranks"], 1)
        summary = run.json("summary.json")
        self.assertEqual((summary["status"], summary["iterations"]), ("iteration_limit", 5))
        self.assertGreater(summary["seconds"]["total"], half.json("summary.json")["seconds"]["total"] * 0.5)
        json.dumps(summary)


class OutputNowTest(RestartTest):
    def test_fields_and_a_checkpoint(self):
        output = os.path.join(self.directory, "asked")
        os.mkdir(output)
        with open(os.path.join(output, "output_now"), "w", encoding="utf-8"):
            pass
        run = self.run_config(2, plate_2d(), "-max_iterations", 3, "-output_every", 0, "-checkpoint_every", 0,
                              output=output)
        self.assert_done(run)
        self.assertFalse(os.path.exists(run.path("output_now")))
        self.assertEqual(sorted(os.listdir(run.path("fields"))), ["iteration_0001.bin", "iteration_0001.xdmf"])
        newest, other = self.slots(run)
        self.assertFalse(os.path.exists(other))
        with h5py.File(newest, "r") as file:
            self.assertEqual(file.attrs["iteration"], 1)
        self.assertIn("displacement", read_dump(run, 1))
        expected = history_text(run)
        again = self.run_config(2, plate_2d(), "-max_iterations", 3, "-output_every", 0, "-checkpoint_every", 0,
                                "-restart", "auto", output=output)
        self.assert_done(again)
        self.assertIn("continues after iteration 1", again.stdout)
        self.assertEqual(history_text(again), expected)


if __name__ == "__main__":
    run_fabseq.main()
