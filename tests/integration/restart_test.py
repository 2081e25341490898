# SPDX-License-Identifier: MIT
"""Runs that continue: from whatever checkpoint, on other ranks, after damage; and what is refused."""

import json
import os
import shutil

import h5py
import numpy as np

import run_fabseq
from compare_runs import assert_same_run, history_text
from read_outputs import read_dump
from run_fabseq import BAD_INPUT, DONE, STOPPED, FabseqTest, distinct, largest_relative_difference
from small_parts import hook_3d, part_density, plate_2d, post_on_substrate, write_voxels


class RestartTest(FabseqTest):
    """Helpers. The runs here are cut and continued by hand."""

    def half_run(self, ranks, config, done, *arguments, output=None):
        """A run that is stopped when `done` iterations are done."""
        output = output or os.path.join(self.directory, f"half_{self.runs}")
        os.makedirs(output, exist_ok=True)
        with open(os.path.join(output, "stop"), "w", encoding="utf-8") as file:
            file.write(str(done))
        run = self.run_config(ranks, config, *arguments, output=output)
        self.assertEqual(run.status, STOPPED, str(run))
        self.assertFalse(os.path.exists(run.path("stop")), "a request that was fulfilled is still there")
        self.assertEqual(len(run.history()), done)
        return run

    def slots(self, run):
        """Path of the newest slot, and of the other one."""
        with open(run.path("checkpoint/newest"), encoding="utf-8") as file:
            newest = file.read().strip()
        other = "slot_1.h5" if newest == "slot_0.h5" else "slot_0.h5"
        return run.path("checkpoint/" + newest), run.path("checkpoint/" + other)

    def assert_refused(self, run, *words):
        self.assertEqual(run.status, BAD_INPUT, str(run))
        messages = [line for line in run.messages() if not line.startswith("warning: ")]
        self.assertEqual(len(messages), 1, str(run))
        for word in words:
            self.assertIn(word, messages[0])


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
        self.assertEqual(tolerances[-1], 1e-6)

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


class WhereTest(RestartTest):
    def test_into_another_directory(self):
        """The history comes along, and the first checkpoint there is written at once."""
        expected = self.run_config(1, plate_2d(), "-max_iterations", 6)
        half = self.half_run(1, plate_2d(), 3, "-max_iterations", 6)
        before = self.tree_of(half.output)
        run = self.run_config(1, plate_2d(), "-max_iterations", 6, "-restart", half.output)
        self.assert_done(run)
        assert_same_run(self, run, expected, 1)
        self.assertEqual(self.tree_of(half.output), before)
        stopped = os.path.join(self.directory, "stopped")
        os.mkdir(stopped)
        with open(os.path.join(stopped, "stop"), "w", encoding="utf-8"):
            pass
        run = self.run_config(1, plate_2d(), "-max_iterations", 6, "-restart", half.output, output=stopped)
        self.assertEqual(run.status, STOPPED)
        run = self.run_config(1, plate_2d(), "-max_iterations", 6, "-restart", "auto", output=stopped)
        self.assert_done(run)
        assert_same_run(self, run, expected, 1)

    def tree_of(self, output):
        """Of files only: Open MPI probes for locks with a file beside the one it reads, and removes it."""
        return {path: value for path, value in self.tree().items() if path.startswith(output) and os.path.isfile(path)}

    def test_without_output_it_continues_in_place(self):
        half = self.half_run(1, plate_2d(), 2, "-max_iterations", 4)
        run = self.run_config(1, plate_2d(), "-max_iterations", 4, "-restart", half.output, output="")
        self.assert_done(run)
        self.assertEqual(len(half.history()), 4)

    def test_auto_starts_where_there_is_nothing(self):
        run = self.run_config(1, plate_2d(), "-max_iterations", 2, "-restart", "auto")
        self.assert_done(run)
        self.assertIn("a new run begins", run.stdout)

    def test_auto_after_a_run_without_a_checkpoint(self):
        """It is replaced by the same run, but not by another one."""
        first = self.run_config(1, plate_2d(), "-max_iterations", 2, "-checkpoint_every", 0)
        run = self.run_config(1, plate_2d(), "-max_iterations", 3, "-restart", "auto", output=first.output)
        self.assert_done(run)
        self.assertEqual([line["iteration"] for line in run.history()], [1, 2, 3])
        first = self.run_config(1, plate_2d(), "-max_iterations", 2, "-checkpoint_every", 0)
        before = self.tree_of(first.output)
        run = self.run_config(1, plate_2d(), "-beta", 20, "-restart", "auto", output=first.output)
        self.assert_refused(run, "/projection/beta", "20")
        self.assertEqual(self.tree_of(first.output), before)

    def test_another_run_is_not_replaced(self):
        half = self.half_run(1, plate_2d(), 2, "-max_iterations", 4)
        other = self.run_config(1, plate_2d(), "-max_iterations", 1)
        run = self.run_config(1, plate_2d(), "-restart", half.output, output=other.output)
        self.assert_refused(run, "holds a run", "-overwrite")

    def test_no_checkpoint_in_a_named_directory(self):
        for name in ("nothing", "."):
            run = self.run_config(1, plate_2d(), "-restart", name)
            self.assert_refused(run, "-restart", f"'{name}'", "auto")
            self.assertFalse(os.path.exists(run.output))

    def test_only_optimizations_continue(self):
        run = self.run_config(1, plate_2d(), "-restart", "auto", "-task", "simulate")
        self.assert_refused(run, "-restart", "-task optimize")

    def test_a_run_that_is_done_can_be_made_longer(self):
        """It goes on with the move limits it was planned with; the first part is as it was."""
        first = self.run_config(1, plate_2d(), "-max_iterations", 3)
        short = history_text(first)
        run = self.run_config(1, plate_2d(), "-max_iterations", 5, "-restart", "auto", output=first.output)
        self.assert_done(run)
        self.assertEqual(history_text(run)[:3], short)
        self.assertEqual(run.json("summary.json")["iterations"], 5)
        last = [line["change"] for line in run.history()[2:]]
        self.assertLessEqual(max(last), 0.004 * (1 + 1e-9))
        again = self.run_config(1, plate_2d(), "-max_iterations", 5, "-restart", "auto", output=first.output)
        self.assert_done(again)
        self.assertEqual(history_text(again), history_text(run))

    def test_a_converged_run_stays_so(self):
        arguments = ("-max_iterations", 9, "-set", "optimizer.change_tolerance=0.9", "-beta", 16, "-set",
                     "projection.max=16")
        first = self.run_config(1, plate_2d(), *arguments)
        self.assertEqual(first.json("summary.json")["status"], "converged")
        expected = history_text(first)
        self.assertLess(len(expected), 9)
        run = self.run_config(1, plate_2d(), *arguments, "-restart", "auto", output=first.output)
        self.assertEqual(run.json("summary.json")["status"], "converged")
        self.assertEqual(history_text(run), expected)
        run = self.run_config(1, plate_2d(), *arguments, "-set", "optimizer.change_tolerance=0", "-restart", "auto",
                              output=first.output)
        self.assertEqual(len(run.history()), 9)


class OtherProblemTest(RestartTest):
    def test_differences_are_named(self):
        half = self.half_run(2, plate_2d(), 2, "-max_iterations", 4)
        before = self.tree()
        for arguments, words in ((("-layers", 5), ("/layers/count was 4, is 5 now",)),
                                 (("-elements", "20,14"), ("/domain/elements/1 was 12, is 14 now",)),
                                 (("-alpha", 0.5), ("/objective/1/weight was 1", "is 0.5 now")),
                                 (("-set", "part.difference.1.sphere.radius=0.4"),
                                  ("/part/difference/1/sphere/radius was 0.31, is 0.4 now",)),
                                 (("-thickness_tolerance", 0.2), ("/constraints/0/tolerance was 0.1, is 0.2 now",))):
            for ranks in distinct(3, 1):
                with self.subTest(arguments=arguments, ranks=ranks):
                    run = self.run_config(ranks, plate_2d(), *arguments, "-restart", "auto", output=half.output)
                    self.assert_refused(run, "-restart", "another problem", *words)
        before.pop(os.path.join(self.directory, "case.json"))
        after = self.tree()
        after.pop(os.path.join(self.directory, "case.json"))
        self.assertEqual(after, before)

    def test_what_may_change(self):
        half = self.half_run(1, plate_2d(), 2, "-max_iterations", 4)
        run = self.run_config(1, plate_2d(), "-max_iterations", 6, "-tolerance", "1e-9", "-output_every", 1, "-name",
                              "other", "-checkpoint_every", 2, "-solver_path", "reference", "-restart", "auto",
                              output=half.output)
        self.assert_done(run)
        self.assertEqual(len(run.history()), 6)
        self.assertEqual(sorted(os.listdir(run.path("fields")))[0], "iteration_0003.bin")

    def test_another_part_in_the_same_file(self):
        config = plate_2d()
        density = part_density(config)
        write_voxels(os.path.join(self.directory, "part.h5"), density)
        config["part"] = {"voxels": {"file": "part.h5", "threshold": 0.5}}
        half = self.half_run(1, config, 2, "-max_iterations", 4)
        density[11, 3] = 0
        write_voxels(os.path.join(self.directory, "part.h5"), density)
        run = self.run_config(1, config, "-max_iterations", 4, "-restart", "auto", output=half.output)
        self.assert_refused(run, "another problem", "/part")
        density[11, 3] = 1
        config["part"]["voxels"]["file"] = "moved.h5"
        write_voxels(os.path.join(self.directory, "moved.h5"), density)
        run = self.run_config(2, config, "-max_iterations", 4, "-restart", "auto", output=half.output)
        self.assert_done(run)


class DamageTest(RestartTest):
    def run_with_two_slots(self):
        """Checkpoints after iterations 2 and 4."""
        self.expected = self.run_config(1, plate_2d(), "-max_iterations", 6, "-checkpoint_every", 2)
        half = self.half_run(1, plate_2d(), 4, "-max_iterations", 6, "-checkpoint_every", 2)
        return half

    def damage(self, path, kind):
        with open(path, "rb") as file:
            content = bytearray(file.read())
        if kind == "bit":
            content[len(content) // 2] ^= 1
        elif kind == "header":
            content[9] ^= 0xff
        else:
            content = content[:len(content) // 3] if kind == "short" else b""
        with open(path, "wb") as file:
            file.write(content)

    def test_the_older_slot(self):
        for kind in ("bit", "header", "short", "empty"):
            with self.subTest(kind=kind):
                half = self.run_with_two_slots()
                newest, older = self.slots(half)
                self.damage(newest, kind)
                run = self.run_config(2 if kind == "bit" else 1, plate_2d(), "-max_iterations", 6, "-checkpoint_every", 2,
                                      "-restart", "auto", output=half.output)
                self.assertEqual(run.status, DONE, str(run))
                warnings = [line for line in run.messages() if line.startswith("warning: ")]
                self.assertEqual(len(warnings), 1, str(run))
                for word in (newest, "damaged", older, "older"):
                    self.assertIn(word, warnings[0])
                self.assertIn("continues after iteration 2", run.stdout)
                if kind != "bit":
                    assert_same_run(self, run, self.expected, 1)

    def test_the_good_slot_is_not_overwritten_first(self):
        """Stopped again right away, the run still has the older slot; the next checkpoint takes the damaged
        one's place."""
        half = self.run_with_two_slots()
        newest, older = self.slots(half)
        self.damage(newest, "bit")
        with open(older, "rb") as file:
            good = file.read()
        with open(half.path("stop"), "w", encoding="utf-8") as file:
            file.write("3")
        run = self.run_config(1, plate_2d(), "-max_iterations", 6, "-checkpoint_every", 0, "-restart", "auto",
                              output=half.output)
        self.assertEqual(run.status, STOPPED, str(run))
        with open(older, "rb") as file:
            self.assertEqual(file.read(), good)
        self.assertEqual(self.slots(run)[0], newest)
        with h5py.File(newest, "r") as file:
            self.assertEqual(file.attrs["iteration"], 3)

    def test_both_slots(self):
        half = self.run_with_two_slots()
        for path in self.slots(half):
            self.damage(path, "bit")
        for ranks in distinct(2, 1):
            for restart in ("auto", half.output):
                run = self.run_config(ranks, plate_2d(), "-max_iterations", 6, "-restart", restart, output=half.output)
                self.assert_refused(run, "-restart", "slot_0.h5", "slot_1.h5", "damaged")
        self.assertEqual(len(half.history()), 4)

    def test_a_history_that_was_lost(self):
        half = self.half_run(1, plate_2d(), 3, "-max_iterations", 5)
        os.remove(half.path("history.jsonl"))
        run = self.run_config(1, plate_2d(), "-max_iterations", 5, "-restart", "auto", output=half.output)
        self.assertEqual(run.status, DONE, str(run))
        self.assertIn("warning: history.jsonl has lost lines", run.stderr)
        self.assertEqual([line["iteration"] for line in run.history()], [4, 5])


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
