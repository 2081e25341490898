# SPDX-License-Identifier: MIT
"""-task check_gradients: adjoint against central differences, every component of every response, both
scales."""

import csv
import os

import run_fabseq
from run_fabseq import FabseqTest, ROOT, SANITIZED
from small_parts import hook_3d, plate_2d, post_on_substrate

LIMIT = 1e-5


class GradientsTest(FabseqTest):
    def check(self, config, components, *arguments, functionals=0, ranks=2):
        """`components` of what the config lists, then `functionals` of terms that are sums of squares: those
        that ask for it."""
        run = self.run_config(ranks, config, "-task", "check_gradients", *arguments, timeout=900)
        self.assert_done(run)
        check = run.json("gradient_check.json")
        self.assertEqual(check["worst"], max(entry["best"] for entry in check["components"]))
        names = [entry["name"] for entry in check["components"]]
        self.assertEqual(len(names), components + functionals)
        self.assertEqual(["_functional_" in name for name in names], [False] * components + [True] * functionals)
        for entry in check["components"]:
            self.assertLess(entry["best"], LIMIT, f"{entry['name']} ({entry['type']})")
            self.assertGreater(abs(entry["adjoint"]), 0, entry["name"])
            central = entry["differences"]
            fourth_order = [(10 * shorter - longer) / 9 for longer, shorter in zip(central, central[1:])]
            errors = [abs(difference - entry["adjoint"]) / abs(entry["adjoint"]) for difference in central + fourth_order]
            self.assertAlmostEqual(min(errors), entry["best"], places=12)
        with open(run.path("gradient_check.csv"), encoding="utf-8") as file:
            self.assertEqual(len(list(csv.DictReader(file))), len(names) * len(check["steps"]))
        self.assertEqual([len(entry["relative_errors"]) for entry in check["components"]], [len(check["steps"])] * len(names))
        self.assertEqual(check["name"], config["name"] if isinstance(config, dict) else "gradient_box")
        self.assertEqual(run.stdout.splitlines()[-1], f"picture: fabseq-tools plot-gradients {run.output}")
        return run

    def box(self, *arguments, **options):
        # 5 objective terms, 4 layers' thickness, 3 components of the deposition speed.
        elements = "3,3,4" if SANITIZED else "5,5,5"
        path = os.path.join(ROOT, "configs", "gradient_box.json")
        plain = [word for term in (0, 1) for word in ("-set", f"objective.{term}.least_squares=false")]
        return self.check(path, 12, "-elements", elements, *plain, *arguments, **options)

    def test_box_on_the_linear_scale(self):
        self.box("-scale", "linear")

    def test_box_on_the_log_scale(self):
        self.box("-scale", "log", ranks=3)

    def test_box_as_sums_of_squares(self):
        """Six functionals of the edge, two of the face; a layerwise term has none."""
        squares = [word for term in (0, 1) for word in ("-set", f"objective.{term}.least_squares=true")]
        self.box(*squares, functionals=8)

    @run_fabseq.only_release
    def test_released_as_sums_of_squares(self):
        """Arm, a face, twice; underside along its normal."""
        for dimension, functionals in ((2, 2 * 4 + 1), (3, 2 * 9 + 2)):
            config = post_on_substrate(dimension)
            for term in config["objective"][:3]:
                term["least_squares"] = True
            with self.subTest(dimension=dimension):
                self.check(config, 8, functionals=functionals)

    @run_fabseq.only_release
    def test_box_with_filter(self):
        self.box("-filter_radius", 0.7, ranks=1)

    def test_plane(self):
        config = plate_2d()
        config["constraints"].append({"type": "deposition_speed"})
        for scale in ("log", "linear"):
            with self.subTest(scale=scale):
                self.check(config, 9, "-scale", scale)

    @run_fabseq.only_release
    def test_overhang_with_both_void_models(self):
        for void in ("absent", "quiet"):
            with self.subTest(void=void):
                self.check(hook_3d(), 8, "-void", void)

    def test_released_from_clamps(self):
        for dimension in (2, 3):
            for void in ("absent", "quiet"):
                with self.subTest(dimension=dimension, void=void):
                    self.check(post_on_substrate(dimension), 8, "-void", void)


if __name__ == "__main__":
    run_fabseq.main()
