# SPDX-License-Identifier: MIT
"""solver.region: systems of what is built only. Gradients are exact for it, both solver paths agree, values
differ from the whole part's by less than 1e-3, and agree for all ranks and groups."""

import run_fabseq
from read_outputs import assert_close
from run_fabseq import BAD_INPUT, FabseqTest, SANITIZED, largest_relative_difference
from small_parts import hook_3d, plate_2d

SPLITS = ((2, 1),) if SANITIZED else ((2, 1), (3, 3), (4, 2))
LIMIT = 1e-7  # of solves to 1e-11


def many_layers(config, void="absent"):
    """More than are solved side by side; distortion of all nodes and after the release: all layers count."""
    config["layers"] = {"count": 18}
    config["process"] = {"void": void, "deposition": "nominal"}
    config["node_sets"]["every"] = {"all": True}
    config["objective"] = [{"type": "distortion", "nodes": "every", "least_squares": False},
                           {"type": "distortion", "nodes": "every", "after_release": True, "least_squares": False}]
    config["constraints"] = []
    return config


def with_heat(config):
    config["material"] = {"mass_density": 7.85, "conductivity": 30, "heat_capacity": 600,
                          "temperatures": [20, 400, 900],
                          "conductivity_factors": [1.3, 1, 0.7], "heat_capacity_factors": [0.7, 1, 1.5]}
    config["process"].update({"deposition_rate": 2.5, "dwell": 20})
    config["thermal"] = {"heat_input": 2e6, "vanishing": 1400, "reference": 40,
                         "film_coefficient": 60, "plate": 60, "steps": [2, 1]}
    config["constraints"] = [{"type": "interpass_temperature", "limit": 300}]
    return config


def values(result):
    return [[entry["value"]] for entry in result.json("evaluation.json")["responses"]]


class RegionTest(FabseqTest):
    def evaluate(self, config, region, ranks=1, groups=1, *arguments):
        result = self.run_config(ranks, config, "-task", "evaluate", "-solver_region", region, "-layer_groups", groups,
                                 "-tolerance", "1e-11", *arguments)
        self.assert_done(result)
        return result

    def test_values(self):
        for config in (with_heat(many_layers(plate_2d())), many_layers(hook_3d())):
            with self.subTest(config=config["name"]):
                built = values(self.evaluate(config, "built"))
                whole = values(self.evaluate(config, "whole"))
                self.assertLess(largest_relative_difference(built, whole), 1e-3)
                self.assertNotEqual(built, whole)
                reference = values(self.evaluate(config, "built", 1, 1, "-solver_path", "reference"))
                self.assertLess(largest_relative_difference(reference, built), LIMIT)
                for ranks, groups in SPLITS:
                    other = values(self.evaluate(config, "built", ranks, groups))
                    self.assertLess(largest_relative_difference(other, built), LIMIT, (ranks, groups))

    def test_gradients(self):
        """Of the truncated model itself, also at a low sharpness, where it differs from the whole one. In 3D
        strains follow the temperature, and a rank may have no elements of the region."""
        for config in (many_layers(plate_2d()), with_heat(many_layers(hook_3d()))):
            for sharpness in (20, 72):
                config["projection"] = {"beta": sharpness}
                check = self.run_config(2, config, "-task", "check_gradients", "-solver_region", "built", "-layer_groups", 1)
                self.assert_done(check)
                self.assertLess(check.json("gradient_check.json")["worst"], 1e-5, (config["name"], sharpness))

    def test_the_other_deposition_is_not_known(self):
        record = self.evaluate(many_layers(plate_2d()), "built").json("evaluation.json")["deposition"]
        self.assertIsNone(record["follow"])
        self.assertIsNotNone(record["nominal"])

    def test_optimization(self):
        """Its iterations leave out what is not built; what it reports does not."""
        config = many_layers(hook_3d())
        runs = [self.optimize(config, 2, 2, "-solver_region", region) for region in ("built", "whole")]
        histories = [[line["objective"] for line in run.history()] for run in runs]
        self.assertNotEqual(*histories)
        assert_close(*histories, 1e-3, "objective")
        for run in runs:
            self.assertIsNotNone(run.json("summary.json")["optimized"]["deposition"]["follow"])

    def test_automatic(self):
        """Built in iterations if there are a rank per group, sharp layers and several blocks; else whole."""
        def first(config, groups, region):
            run = self.optimize(config, 2, 1, "-layer_groups", groups, "-solver_region", region)
            return run.history()[0]["objective"]

        blunt, few, follow = many_layers(plate_2d()), many_layers(plate_2d()), many_layers(plate_2d())
        blunt["projection"] = {"beta": 30}
        few["layers"]["count"] = 8
        follow["process"]["deposition"] = "follow"
        for config, groups, expected in ((many_layers(plate_2d()), 2, "built"), (many_layers(plate_2d()), 1, "whole"),
                                         (blunt, 2, "whole"), (few, 2, "whole"), (follow, 2, "whole")):
            with self.subTest(config=config, groups=groups):
                self.assertEqual(first(config, groups, "auto"), first(config, groups, expected))
        evaluations = [values(self.evaluate(many_layers(plate_2d()), region)) for region in ("auto", "whole")]
        self.assertEqual(*evaluations)

    def test_where_the_unbuilt_counts(self):
        for process in ({"deposition": "follow"}, {"void": "quiet"}):
            config = many_layers(plate_2d())
            config["process"].update(process)
            result = self.run_config(2, config, "-task", "evaluate", "-solver_region", "built")
            self.assertEqual(result.status, BAD_INPUT)
            self.assertIn('/solver/region: found "built" with process.', result.stderr)


if __name__ == "__main__":
    run_fabseq.main()
