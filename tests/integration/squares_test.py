# SPDX-License-Identifier: MIT
"""Distortion as least-squares residuals, and when a run is done: small runs with and without."""

import run_fabseq
from run_fabseq import FabseqTest
from small_parts import hook_3d, plate_2d, post_on_substrate, v_2d


def with_squares(config, value):
    for term in config["objective"]:
        if term["type"] == "distortion" and term.get("measure") != "layerwise":
            term["least_squares"] = value
    return config


class SquaresTest(FabseqTest):
    def distortion(self, run):
        responses = run.json("summary.json")["optimized"]["responses"]
        return responses[0]["value"]

    def test_history_holds_the_functionals(self):
        self.resumes = True
        run = self.run_config(2, with_squares(plate_2d(), True), "-max_iterations", 3)
        self.resumes = False
        self.assert_done(run)
        for line in run.history():
            functionals, of_uniformity = line["functionals"]
            self.assertEqual([len(functionals), of_uniformity], [4, []])  # constant and linear in x, of two components
            squares = sum(value**2 for value in functionals)
            self.assertGreater(squares, 0)
            self.assertLessEqual(squares, line["objective"][0] * (1 + 1e-12))
        default = plate_2d()
        del default["objective"][0]["least_squares"]
        run = self.run_config(1, default, "-max_iterations", 2)
        self.assertEqual(len(run.history()[0]["functionals"][0]), 4)
        run = self.run_config(1, with_squares(plate_2d(), False), "-max_iterations", 2)
        self.assertNotIn("functionals", run.history()[0])

    def test_first_values_do_not_depend_on_it(self):
        lines = [self.run_config(1, with_squares(hook_3d(), value), "-max_iterations", 1).history()[0]
                 for value in (True, False)]
        for key in ("objective", "objective_scaled", "constraints", "merit"):
            self.assertEqual(lines[0][key], lines[1][key], key)

    @run_fabseq.only_release
    def test_lowers_the_distortion(self):
        """As much as without, or more; so few elements leave 1/4 of what planar layers have."""
        arguments = ("-max_iterations", 60, "-beta_interval", 8)
        found = {}
        for value in (True, False):
            run = self.run_config(2, with_squares(v_2d(), value), *arguments, timeout=900)
            self.assert_done(run)
            self.assertTrue(run.json("summary.json")["feasible"])
            found[value] = self.distortion(run)
        planar = run.json("summary.json")["baseline"]["responses"][0]["value"]
        self.assertLess(found[True], planar / 3)
        self.assertLess(found[True], 1.1 * found[False])

    @run_fabseq.only_release
    def test_ranks_and_groups_agree(self):
        """On one rank, decomposed, and in layer groups, on the plate and after the release."""
        for config in (with_squares(plate_2d(), True), with_squares(post_on_substrate(2), True)):
            runs = [self.run_config(ranks, config, "-max_iterations", 3, "-layer_groups", groups)
                    for ranks, groups in ((1, 1), (3, 1), (2, 2))]
            for run in runs[1:]:
                for mine, first in zip(run.history(), runs[0].history(), strict=True):
                    self.assertEqual(len(mine["functionals"]), len(first["functionals"]))
                    for a, b in zip(mine["functionals"], first["functionals"], strict=True):
                        size = max([abs(value) for value in b], default=0)
                        for value, expected in zip(a, b, strict=True):
                            self.assertAlmostEqual(value, expected, delta=2e-4 * size)

    def test_gradients_of_functionals(self):
        run = self.run_config(2, with_squares(plate_2d(), True), "-task", "check_gradients")
        self.assert_done(run)
        components = {entry["name"]: entry for entry in run.json("gradient_check.json")["components"]}
        names = [f"objective_0_functional_{k}" for k in range(4)]
        self.assertEqual([name for name in components if "functional" in name], names)
        for name in names:
            self.assertLess(components[name]["best"], 1e-5, name)

    def test_evaluations_name_what_the_config_lists(self):
        run = self.run_config(1, with_squares(plate_2d(), True), "-task", "evaluate")
        self.assert_done(run)
        names = [entry["name"] for entry in run.json("evaluation.json")["responses"]]
        self.assertEqual(names, ["objective_0", "objective_1"] + [f"constraint_0_{j}" for j in range(4)])


class EndTest(FabseqTest):
    """Why a run stops."""

    def end_of(self, *arguments):
        run = self.run_config(1, plate_2d(), *arguments)
        self.assert_done(run)
        summary = run.json("summary.json")
        self.assertIn(summary["reason"], run.stdout)
        return run, summary

    def test_design_at_rest(self):
        run, summary = self.end_of("-max_iterations", 30, "-beta_interval", 3, "-change_tolerance", 0.5, "-window", 4)
        self.assertEqual(summary["status"], "converged")
        self.assertIn("change_tolerance 0.5", summary["reason"])
        self.assertIn("last 4 iterations", summary["reason"])
        # 16, 24, 36, 54: the last sharpness from iteration 10 on
        self.assertEqual([summary["iterations"], summary["beta"]], [13, 54])
        self.assertEqual(run.history()[-1]["beta"], 54)

    def test_objective_at_rest(self):
        _, summary = self.end_of("-max_iterations", 60, "-beta_interval", 3, "-objective_tolerance", 0.5, "-window", 4)
        self.assertEqual(summary["status"], "converged")
        self.assertIn("objective_tolerance 0.5", summary["reason"])
        self.assertGreaterEqual(summary["iterations"], 13)
        self.assertTrue(summary["feasible"])

    def test_no_iterations_left(self):
        _, summary = self.end_of("-max_iterations", 4, "-beta_interval", 3, "-change_tolerance", 0.5)
        self.assertEqual([summary["status"], summary["reason"]],
                         ["iteration_limit", "max_iterations reached before the sharpness reached its maximum"])
        _, summary = self.end_of("-max_iterations", 12, "-beta_interval", 3)
        self.assertEqual([summary["status"], summary["reason"]], ["iteration_limit", "max_iterations reached"])


if __name__ == "__main__":
    run_fabseq.main()
