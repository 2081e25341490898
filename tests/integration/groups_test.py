# SPDX-License-Identifier: MIT
"""Layer groups: the same optimization, simulation and gradients however ranks are split into groups x domain
ranks."""

import os

import run_fabseq
from read_outputs import assert_close, read_dump, read_result
from run_fabseq import BAD_INPUT, NUMERICAL_FAILURE, FabseqTest, SANITIZED, largest_relative_difference
from small_parts import hook_3d, plate_2d, post_on_substrate

LIMIT = 1e-6
COMPARED = ("objective", "objective_scaled", "constraints", "change", "beta", "interior_minima")
# Ranks and groups: 1x4, 2x2, 4x1 and 3x1.
SPLITS = ((4, 2),) if SANITIZED else ((4, 2), (4, 4))


def hook_of_many_layers():
    """On a grid with several levels of multigrid, more layers than are solved side by side."""
    config = hook_3d()
    if not SANITIZED:
        config["domain"]["elements"] = [16, 8, 16]
    config["layers"]["count"] = 11
    return config


class GroupsTest(FabseqTest):
    def optimize(self, config, ranks, groups, *arguments):
        iterations = 2 if SANITIZED else 4
        run = self.run_config(ranks, config, "-layer_groups", groups, "-max_iterations", iterations, "-tolerance",
                              "1e-11", "-output_every", iterations, "-checkpoint_every", iterations, *arguments)
        self.assert_done(run)
        self.assertEqual(len(run.history()), iterations)
        return run

    def assert_same(self, run, expected):
        for line, correct in zip(run.history(), expected.history(), strict=True):
            for key in COMPARED:
                error = largest_relative_difference(line[key], correct[key])
                self.assertLess(error, LIMIT, f"{key} of iteration {line['iteration']}")
            for kind, counts in correct["solver_iterations"].items():
                # Adjoints of layers with a negligible load are not solved for: in no group, or in all.
                solved = [count > 0 for count in counts]
                self.assertEqual([count > 0 for count in line["solver_iterations"][kind]], solved, kind)
                self.assertTrue(any(solved) if kind == "adjoint" else all(solved), kind)
        last = len(expected.history())
        for fields, correct in ((read_dump(run, last), read_dump(expected, last)),
                                (read_result(run), read_result(expected))):
            self.assertEqual(set(fields), set(correct))
            for name, values in correct.items():
                assert_close(fields[name], values, LIMIT, name)
        self.assertEqual(sorted(os.listdir(run.path("checkpoint"))), sorted(os.listdir(expected.path("checkpoint"))))

    def compare(self, config, *arguments):
        expected = self.optimize(config, 1, 1, *arguments)
        for ranks, groups in SPLITS:
            with self.subTest(ranks=ranks, groups=groups):
                run = self.optimize(config, ranks, groups, *arguments)
                self.assertIn(f"layer groups: {groups} x {ranks // groups} ranks\n", run.stdout)
                summary = run.json("summary.json")
                self.assertEqual((summary["ranks"], summary["layer_groups"]), (ranks, groups))
                self.assert_same(run, expected)

    def test_solid(self):
        self.compare(hook_of_many_layers())

    @run_fabseq.only_release
    def test_solid_in_a_quiet_void(self):
        self.compare(hook_of_many_layers(), "-void", "quiet", "-filter_radius", 0.45)

    def test_released_from_clamps(self):
        self.compare(post_on_substrate())

    def test_plane(self):
        """Four layers, and a planar baseline of three: fewer than groups."""
        self.compare(plate_2d(), "-baseline_layers", 3)

    def test_fewer_lanes(self):
        """Solvers that give their memory back between the phases, and blocks that are not full."""
        expected = self.optimize(hook_of_many_layers(), 1, 1)
        for ranks, groups, lanes in ((1, 1, 3),) if SANITIZED else ((1, 1, 4), (2, 1, 2), (2, 2, 3), (3, 1, 1)):
            with self.subTest(ranks=ranks, groups=groups, lanes=lanes):
                run = self.optimize(hook_of_many_layers(), ranks, groups, "-lanes", lanes)
                self.assertIn(f"up to {lanes} layer{'s' if lanes > 1 else ''} at once, to save memory", run.stdout)
                self.assert_same(run, expected)
        run = self.run_config(1, plate_2d(), "-lanes", 9)
        self.assertEqual(run.status, BAD_INPUT, str(run))
        self.assertIn("/solver/lanes: found 9", run.stderr)

    @run_fabseq.only_release
    def test_reference_path(self):
        self.compare(hook_3d(), "-solver_path", "reference", "-layers", 5)
        self.compare(plate_2d(), "-solver_path", "reference")

    def compare_task(self, task, file, *arguments):
        expected = self.run_config(1, hook_3d(), "-task", task, "-layers", 9, "-tolerance", "1e-11", *arguments)
        self.assert_done(expected)
        for ranks, groups in SPLITS:
            with self.subTest(task=task, ranks=ranks, groups=groups):
                run = self.run_config(ranks, hook_3d(), "-task", task, "-layers", 9, "-tolerance", "1e-11",
                                      "-layer_groups", groups, *arguments)
                self.assert_done(run)
                fields, correct = read_result(run, file), read_result(expected, file)
                self.assertEqual(set(fields), set(correct))
                for name, values in correct.items():
                    assert_close(fields[name], values, LIMIT, name)

    def test_simulate(self):
        self.compare_task("simulate", "result.h5", "-stages")

    def test_evaluate(self):
        self.compare_task("evaluate", "gradients.h5")

    def test_check_gradients(self):
        run = self.run_config(2, plate_2d(), "-task", "check_gradients", "-layer_groups", 2)
        self.assert_done(run)
        self.assertLess(run.json("gradient_check.json")["worst"], 1e-5)

    def test_automatic(self):
        """More groups than layers, or than memory allows, would not be chosen; the choice stands in the
        log."""
        for task in ("optimize", "check"):
            run = self.run_config(2, plate_2d(), "-task", task, "-max_iterations", 1)
            self.assert_done(run)
            lines = [line for line in run.stdout.splitlines() if line.startswith("layer groups: ")]
            self.assertEqual(len(lines), 1, str(run))
            self.assertRegex(lines[0], r"(1 x 2|2 x 1) ranks \(auto\).* memory estimate .* GB available; halo saved ")
        alone = self.run_config(1, plate_2d(), "-task", "check")
        self.assertNotIn("layer groups", alone.stdout)
        one_layer = self.run_config(2, plate_2d(), "-task", "check", "-layers", 1, "-layer_groups", "auto")
        self.assertIn("layer groups: 1 x 2 ranks (auto)", one_layer.stdout)

    def test_groups_that_do_not_divide_the_ranks(self):
        before = self.tree()
        config = self.write_config(plate_2d())
        for ranks, groups, allowed in ((3, 2, "(1, 3)"), (2, 3, "(1, 2)"), (1, 2, "(1)")):
            run = self.run_program(ranks, "-config", config, "-layer_groups", groups)
            self.assertEqual(run.status, BAD_INPUT, str(run))
            self.assertEqual(len(run.messages()), 1, str(run))
            for word in ("/solver/layer_groups", f"{groups} on {ranks} rank", '"auto"', allowed):
                self.assertIn(word, run.messages()[0])
            self.assertFalse(os.path.exists(run.output))
        self.assertEqual(set(self.tree()) - set(before), {config})

    def test_solver_that_fails_in_one_group_only(self):
        """The error names the layer; no group is left waiting."""
        arguments = ("-task", "evaluate", "-solver_path", "reference", "-reference_method", "gamg")
        for layers in (2, 3):
            free = self.run_config(1, hook_3d(), *arguments, "-layers", layers)
            self.assert_done(free)
            iterations = free.json("evaluation.json")["solver_iterations"]["primal"]
            slowest = iterations.index(max(iterations))
            run = self.run_config(layers, hook_3d(), *arguments, "-layers", layers, "-layer_groups", layers,
                                  "-elasticity_ksp_max_it", max(iterations) - 1)
            self.assertEqual(run.status, NUMERICAL_FAILURE, str(run))
            self.assertEqual(len(run.messages()), 1, str(run))
            self.assertIn(f"layer {slowest + 1}: the elastic forward solve", run.messages()[0])


if __name__ == "__main__":
    run_fabseq.main()
