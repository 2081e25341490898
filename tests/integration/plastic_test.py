# SPDX-License-Identifier: MIT
"""Plastic flow in runs of the program: what it must have in common with other runs."""

import copy
import itertools

import run_fabseq
from read_outputs import assert_close, read_result
from run_fabseq import FabseqTest, distinct
from small_parts import hook_3d


def flowing(yield_stress, heated=False):
    """The hook of a material that flows, and that follows its temperature."""
    config = hook_3d()
    config["layers"]["count"] = 5
    config["process"] = {"model": "elastoplastic", "deposition": "nominal"}
    config["material"] = {"yield_stress": yield_stress, "hardening": 0.02}
    config["objective"][1]["after_release"] = True
    if heated:
        config["process"].update({"deposition_rate": 2.5, "dwell": 60})
        config["material"].update({"mass_density": 7.85, "temperatures": [20, 600, 1200],
                                   "young_factors": [1, 0.5, 0.05], "yield_factors": [1, 0.4, 0.03],
                                   "elongations": [0, 0.008, 0.016], "cut_off": 1100,
                                   "conductivity": 30, "conductivity_factors": [1.3, 0.8, 0.7],
                                   "heat_capacity": 600, "heat_capacity_factors": [0.7, 1.3, 1.1]})
        config["thermal"] = {"heat_input": 1e6, "vanishing": 1200}
    return config


def with_hanging_piece():
    """The hook with a tooth below its arm, in planar layers: it hangs in the air until the arm carries it."""
    config = hook_3d()
    config["part"]["union"].append({"box": {"min": [1.2, 0.2, 0.4], "max": [1.6, 0.6, 1.0]}})
    config.update({"sequence": {"type": "planar"}, "layers": {"count": 8}, "projection": {"binary": True},
                   "material": {"yield_stress": 0.0019, "hardening": 0.0017},
                   "process": {"model": "elastoplastic", "deposition": "nominal"},
                   "objective": config["objective"][:1], "constraints": []})
    return config


def turned(config):
    """The same part with its axes in the order y, z, x: the plate's normal is y."""
    def turn(value):
        if isinstance(value, dict):
            return {key: turn(inner) for key, inner in value.items()}
        if isinstance(value, list) and len(value) == 3 and not isinstance(value[0], dict):
            return [value[1], value[2], value[0]]
        return [turn(inner) for inner in value] if isinstance(value, list) else value
    result = turn(copy.deepcopy(config))
    result["build_plate"] = "y-"
    result["objective"][1]["axis"] = "y"
    if "material" in result:
        curves = {key for key in config["material"] if key.endswith("_factors")} | {"temperatures", "elongations"}
        for key in curves & set(config["material"]):
            result["material"][key] = config["material"][key]
    return result


class PlasticTest(FabseqTest):
    def values(self, ranks, config, *options):
        run = self.run_config(ranks, config, "-task", "simulate", "-tolerance", "1e-10", *options)
        self.assert_done(run)
        return {entry["name"]: entry["value"] for entry in run.json("summary.json")["responses"]
                if entry["type"] == "distortion"}

    def assert_same(self, found, expected, limit):
        self.assertEqual(set(found), set(expected))
        for name, value in expected.items():
            self.assertAlmostEqual(found[name] / value, 1, delta=limit, msg=name)

    def test_is_linear_below_the_yield_stress(self):
        linear = flowing(1e30)
        linear["process"]["model"] = "linear"
        self.assert_same(self.values(1, flowing(1e30)), self.values(1, linear), 1e-9)

    def test_flow_changes_the_distortion(self):
        elastic, plastic = self.values(1, flowing(1e30)), self.values(1, flowing(0.002))
        for name, value in elastic.items():
            self.assertGreater(abs(plastic[name] / value - 1), 0.01, name)

    def test_pieces_that_hang_in_the_air(self):
        config = with_hanging_piece()
        expected = self.values(1, config, "-set", "solver.path=reference", "-tolerance", "1e-6")
        self.assert_same(self.values(1, config, "-tolerance", "1e-6"), expected, 1e-5)

    def test_rounding_moves_pieces_that_hang(self):
        """Sweeps cannot bring them closer to rest: evaluations, which are to be exact, end all the same."""
        config = with_hanging_piece()
        expected = self.values(1, config, "-tolerance", "1e-6")
        run = self.run_config(1, config, "-task", "evaluate")
        self.assert_done(run)
        self.assertIn("rounding moves what hangs in the air", run.stderr)
        self.assert_same({"distortion": run.json("evaluation.json")["responses"][0]["value"]},
                         {"distortion": next(iter(expected.values()))}, 1e-5)

    def test_ranks_groups_and_lanes(self):
        for heated in distinct(False, True):
            config = flowing(0.002, heated)
            expected = self.values(1, config)
            for ranks, groups, lanes in ((1, 1, 2), (2, 1, 8), (2, 2, 8), (4, 2, 4)):
                with self.subTest(heated=heated, ranks=ranks, groups=groups, lanes=lanes):
                    options = "-layer_groups", groups, "-set", f"solver.lanes={lanes}"
                    self.assert_same(self.values(ranks, config, *options), expected, 1e-8)

    def test_gradients_of_ranks_and_groups(self):
        """With lanes of 2 and five steps, one group has no step in the last wave."""
        for heated in distinct(False, True):
            expected = self.gradients(1, flowing(0.002, heated))
            for ranks, groups in ((2, 2), (4, 2)):
                with self.subTest(heated=heated, ranks=ranks, groups=groups):
                    options = "-layer_groups", groups, "-set", "solver.lanes=2"
                    found = self.gradients(ranks, flowing(0.002, heated), *options)
                    self.assertEqual(set(found), set(expected))
                    for name, values in expected.items():
                        assert_close(found[name], values, 1e-6, name)

    def gradients(self, ranks, config, *options):
        run = self.run_config(ranks, config, "-task", "evaluate", "-tolerance", "1e-10", *options)
        self.assert_done(run)
        return read_result(run, "gradients.h5")

    def test_a_part_that_is_turned_in_the_box(self):
        for heated, ranks in itertools.product(distinct(False, True), (1,)):
            with self.subTest(heated=heated):
                config = flowing(0.002, heated)
                config["build_plate"] = "z-"
                # Sums along other axes round otherwise: 1e-8 of the heated part's flatness.
                limit = 5e-8 if heated else 1e-8
                self.assert_same(self.values(ranks, turned(config)), self.values(ranks, config), limit)


if __name__ == "__main__":
    run_fabseq.main()
