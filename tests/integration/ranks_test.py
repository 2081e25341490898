# SPDX-License-Identifier: MIT
"""The same optimization on any number of ranks and with any preconditioner, without layer groups
(groups_test.py)."""

import run_fabseq
from run_fabseq import FabseqTest, SANITIZED, largest_relative_difference
from small_parts import hook_3d, plate_2d, post_on_substrate

LIMIT = 1e-6
COMPARED = ("objective", "objective_scaled", "constraints", "change", "beta", "interior_minima")


class RanksTest(FabseqTest):
    def history(self, config, ranks, *arguments, iterations=2 if SANITIZED else 4):
        run = self.run_config(ranks, config, "-max_iterations", iterations, "-tolerance", "1e-11",
                              "-layer_groups", 1, *arguments)
        self.assert_done(run)
        return run.history()

    def assert_same(self, history, expected):
        self.assertEqual(len(history), len(expected))
        for line, correct in zip(history, expected, strict=True):
            for key in COMPARED:
                error = largest_relative_difference(line[key], correct[key])
                self.assertLess(error, LIMIT, f"{key} of iteration {line['iteration']}")

    def compare_ranks(self, config, *arguments):
        if SANITIZED:  # which do not look at digits
            self.history(config, 3, *arguments)
            return
        expected = self.history(config, 1, *arguments)
        for ranks in (2, 4):
            with self.subTest(ranks=ranks):
                self.assert_same(self.history(config, ranks, *arguments), expected)

    def test_void_absent(self):
        self.compare_ranks(hook_3d(), "-void", "absent")

    def test_void_quiet(self):
        self.compare_ranks(hook_3d(), "-void", "quiet")

    def test_filter(self):
        """The filter reaches two elements into other ranks' blocks."""
        self.compare_ranks(hook_3d(), "-filter_radius", 0.45)

    def test_plane(self):
        self.compare_ranks(plate_2d())

    def test_released_from_clamps(self):
        self.compare_ranks(post_on_substrate(2))
        self.compare_ranks(post_on_substrate(3), "-void", "quiet")

    def test_more_ranks_than_elements_along_an_axis(self):
        config = plate_2d()
        config["domain"] = {"size": [0.3, 1.2], "elements": [3, 12]}
        config["node_sets"]["top"] = {"box": {"min": [0, 1.2], "max": [2, 1.2]}}
        expected = self.history(config, 1)
        self.assert_same(self.history(config, 4), expected)

    def test_ranks_without_part_elements(self):
        config = plate_2d()
        config["part"] = {"box": {"min": [1.5, 0], "max": [1.6, 0.3]}}  # 3 elements for 4 ranks
        config["node_sets"]["top"] = {"box": {"min": [0, 0.3], "max": [2, 0.3]}}
        config["layers"]["count"], config["constraints"][0]["target"] = 2, 0.15
        for method in ("direct", "gamg", "multigrid"):
            with self.subTest(method=method):
                arguments = ("-solver_path", "reference", "-reference_method", method)
                self.assert_same(self.history(config, 4, *arguments), self.history(config, 1, *arguments))

    def test_methods_agree(self):
        """On a grid large enough for two levels of geometric multigrid."""
        arguments = ("-solver_path", "reference", "-elements", "12,4,12")
        for void, rank_counts in (("absent", (2,)), ("quiet", (1, 2))):
            expected = self.history(hook_3d(), 1, *arguments, "-reference_method", "direct", "-void", void, iterations=2)
            for method in ("gamg", "multigrid"):
                for ranks in (2,) if SANITIZED else rank_counts:
                    with self.subTest(method=method, ranks=ranks, void=void):
                        history = self.history(hook_3d(), ranks, *arguments, "-reference_method", method, "-void", void,
                                               iterations=2)
                        self.assert_same(history, expected)

    def test_multigrid_on_an_odd_grid_is_algebraic(self):
        """It says so once, and gives the same."""
        config = plate_2d()
        config["domain"]["elements"] = [41, 24]
        arguments = ("-max_iterations", 2, "-tolerance", "1e-11", "-solver_path", "reference", "-reference_method")
        expected = self.run_config(1, config, *arguments, "gamg")
        self.assertEqual(expected.messages(), [])
        run = self.run_config(2, config, *arguments, "multigrid")
        self.assert_done(run)
        self.assertEqual(len(run.messages()), 1, str(run))
        for word in ("warning: /solver/reference_method", "odd", "41, along x", "gamg"):
            self.assertIn(word, run.messages()[0])
        self.assertIn("GAMG", run.stdout)
        self.assert_same(run.history(), expected.history())
        even = self.run_config(1, plate_2d(), "-elements", "40,24", *arguments, "multigrid")
        self.assertEqual(even.messages(), [])
        self.assertIn("geometric multigrid", even.stdout)


if __name__ == "__main__":
    run_fabseq.main()
