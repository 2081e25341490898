# SPDX-License-Identifier: MIT
"""Optimizations that begin with several designs (optimizer.starts)."""

import os

import run_fabseq
from compare_runs import assert_same_run
from run_fabseq import BAD_INPUT, DONE, STOPPED, FabseqTest, Result, largest_relative_difference
from small_parts import direct_2d, hook_3d, plate_2d

STARTS = ["distance", 0.05, 0.8]


def with_starts(config, starts, **more):
    return config | {"optimizer": {"starts": starts, "start_iterations": 2, "max_iterations": 3} | more,
                     "projection": {"interval": 2}, "output": {"checkpoint_every": 1}}


def guided():
    config = plate_2d() | {"sequence": {"type": "guided"}}
    config["objective"] = config["objective"][:1]
    return config


class StartsTest(FabseqTest):
    def optimize(self, config, ranks, *arguments, output=None):
        run = self.run_config(ranks, config, "-tolerance", "1e-11", *arguments, output=output)
        self.assert_done(run)
        return run

    def of(self, run, folder):
        return Result([], 0, "", "", run.path(folder))

    def test_the_best_goes_on(self):
        run = self.optimize(with_starts(plate_2d(), STARTS), 2)
        table = run.json("summary.json")["starts"]
        self.assertEqual([record["initial"] for record in table], STARTS)
        self.assertEqual(table, run.json("starts.json"))
        for number, record in enumerate(table, start=1):
            own = self.of(run, f"starts/{number}")
            summary = own.json("summary.json")
            self.assertEqual(len(own.history()), 2)
            for key in ("feasible", "worst_constraint", "merit"):
                self.assertEqual(record[key], summary[key])
            best = next(line for line in own.history() if line["iteration"] == summary["best_iteration"])
            self.assertEqual(record["merit"], best["merit"])
            # All are scaled as from the config's own initial design, which is the first of them.
            first, line = self.of(run, "starts/1").history()[0], own.history()[0]
            self.assertAlmostEqual(line["objective_scaled"][1] / line["objective"][1] * first["objective"][1], 100.0, places=4)
        chosen = [number for number, record in enumerate(table) if record["chosen"]]
        best = min(range(3), key=lambda k: (not table[k]["feasible"], 0 if table[k]["feasible"] else table[k]["worst_constraint"],
                                            table[k]["merit"]))
        self.assertEqual(chosen, [best])
        self.assertIn(f"start {best + 1}, initial ", run.stdout)
        # The schedules count the iterations of one start.
        whole = self.run_config(1, plate_2d() | {"projection": {"interval": 2}}, "-max_iterations", 5)
        betas = [line["beta"] for line in self.of(run, "starts/1").history() + run.history()]
        self.assertEqual(betas, [line["beta"] for line in whole.history()])

    def test_a_single_start_changes_nothing_but_the_asymptotes(self):
        """Its first design is that of sequence.initial."""
        run, plain = self.optimize(with_starts(plate_2d(), [0.3]), 1), plate_2d()
        plain["sequence"]["initial"] = 0.3
        plain = self.run_config(1, plain, "-max_iterations", 1, "-tolerance", "1e-11")
        self.assertLess(largest_relative_difference(self.of(run, "starts/1").history()[0]["objective"],
                                                    plain.history()[0]["objective"]), 1e-8)

    def test_ranks_and_directions(self):
        config = with_starts(guided(), ["planar", "distance", [0.3, 1.0]])
        reference = self.optimize(config, 1)
        run = self.optimize(config, 2)
        for key in ("objective", "merit", "worst_constraint"):
            for record, expected in zip(run.json("starts.json"), reference.json("starts.json"), strict=True):
                self.assertLess(largest_relative_difference(record[key], expected[key]), 1e-5)
        for line, expected in zip(run.history(), reference.history(), strict=True):
            self.assertLess(largest_relative_difference(line["objective"], expected["objective"]), 1e-5)

    def test_on_the_coarse_grid(self):
        run = self.optimize(with_starts(hook_3d(), ["distance", 1], coarse_iterations=2), 2)
        self.assertFalse(os.path.exists(run.path("starts")))
        self.assertEqual(self.of(run, "coarse/starts/2").json("config.json")["domain"]["elements"], [4, 2, 4])
        self.assertEqual(run.json("summary.json")["starts"], self.of(run, "coarse").json("starts.json"))

    def test_restart_in_any_of_the_runs(self):
        config = with_starts(plate_2d(), STARTS[:2])
        expected = self.optimize(config, 2)
        for folder in ("starts/1", "starts/2", ""):
            with self.subTest(folder=folder):
                output = os.path.join(self.directory, "cut_" + folder.replace("/", "_"))
                os.makedirs(os.path.join(output, folder))
                with open(os.path.join(output, folder, "stop"), "w", encoding="utf-8") as file:
                    file.write("1")
                cut = self.run_config(2, config, "-tolerance", "1e-11", output=output)
                self.assertEqual(cut.status, STOPPED, str(cut))
                run = self.optimize(config, 2, "-restart", "auto", output=output)
                assert_same_run(self, run, expected, 2)
                self.assertEqual(run.json("summary.json")["starts"], expected.json("summary.json")["starts"])

    def test_restart_in_another_directory(self):
        config = with_starts(plate_2d(), STARTS[:2])
        expected = self.optimize(config, 1)
        for folder in ("starts/2", ""):
            first = os.path.join(self.directory, "first_" + folder[:6])
            os.makedirs(os.path.join(first, folder))
            with open(os.path.join(first, folder, "stop"), "w", encoding="utf-8") as file:
                file.write("1")
            self.assertEqual(self.run_config(1, config, "-tolerance", "1e-11", output=first).status, STOPPED)
            run = self.optimize(config, 1, "-restart", first)
            self.assertEqual(run.json("summary.json")["starts"], expected.json("summary.json")["starts"])
            self.assertEqual(run.history()[-1]["objective"], expected.history()[-1]["objective"])

    def test_overwrite_removes_them(self):
        run = self.optimize(with_starts(plate_2d(), STARTS[:2]), 1)
        self.assert_done(self.run_config(1, plate_2d(), "-max_iterations", 1, "-overwrite", output=run.output))
        self.assertFalse(os.path.exists(run.path("starts")) or os.path.exists(run.path("starts.json")))
        self.assertNotIn("starts", run.json("summary.json"))

    def test_refusals(self):
        design = self.optimize(plate_2d(), 1, "-max_iterations", 1).path("result.h5")
        for config, words, reason in (
                (with_starts(plate_2d(), ["planar"]), (), "/optimizer/starts/0: found \"planar\"; allowed: "),
                (with_starts(plate_2d(), ["distance", 1e9]), (), "/optimizer/starts/1: found 1000000000.0; allowed: "),
                (with_starts(guided(), [[0, 0]]), (), "/optimizer/starts/0: found [0,0]; allowed: "),
                (with_starts(guided(), ["planar", [1, 0.01]]), (), "/optimizer/starts/1: found "),
                (with_starts(guided(), [[1, 0.01]], coarse_iterations=1), (), "/optimizer/starts/0: found "),
                (with_starts(direct_2d(), ["distance"]), (), "has no key initial"),
                (with_starts(plate_2d(), "distance"), (), "/optimizer/starts: found \"distance\"; allowed: a list of values of"),
                (with_starts(plate_2d(), ["distance"]), ("-design", design), "-design names the design to start from")):
            with self.subTest(reason=reason):
                run = self.run_config(2, config, *words)
                self.assertEqual(run.status, BAD_INPUT, str(run))
                self.assertEqual(len(run.messages()), 1, str(run))
                self.assertIn(reason, run.messages()[0])
                self.assertFalse(os.path.exists(run.output))

    def test_check_says_so(self):
        run = self.run_config(1, with_starts(plate_2d(), STARTS), "-task", "check")
        self.assertEqual(run.status, DONE, str(run))
        self.assertIn("from each of 3 starts: 2 iterations", run.stdout)


if __name__ == "__main__":
    run_fabseq.main()
