# SPDX-License-Identifier: MIT
"""What a run continues from: in which directory, of which problem, after damage; and what is refused."""

import os

import h5py

import run_fabseq
from compare_runs import assert_same_run, history_text
from restart_case import RestartTest
from run_fabseq import DONE, STOPPED, distinct
from small_parts import part_density, plate_2d, write_voxels


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


if __name__ == "__main__":
    run_fabseq.main()
