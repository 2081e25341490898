# SPDX-License-Identifier: MIT
"""Scenarios of the strain: superposed figures against simulations of each alone, and the min-max of the
worst."""

import copy

import run_fabseq
from run_fabseq import FabseqTest, SANITIZED, largest_relative_difference
from small_parts import hook_3d, plate_2d, v_2d

LIMIT = 1e-7  # of solves to 1e-11
AXES = [[1, 1, 1], [1.15, 1, 1], [1, 1, 1.15]]
RUNS = ((2, 2),) if SANITIZED else ((1, 1), (2, 1), (2, 2))  # ranks and groups


def with_scenarios(config, dimension):
    config["material"] = {"inherent_strain": [-0.01, -0.008, 0.003] if dimension == 2 else [-0.01, -0.009, -0.007, 0.001, 0, 0],
                          "scenarios": [axes[:dimension - 1] + axes[2:] for axes in AXES]}
    return config


class ScenariosTest(FabseqTest):
    def evaluation(self, config, ranks=1, groups=1, task="evaluate", *arguments):
        run = self.run_config(ranks, config, "-task", task, "-layer_groups", groups, "-tolerance", "1e-11", *arguments)
        self.assert_done(run)
        return run.json("evaluation.json" if task == "evaluate" else "summary.json")

    def alone(self, config, axes, task):
        """First objective term of a scenario, simulated with its strain."""
        single = copy.deepcopy(config)
        single["material"].pop("scenarios")
        single["material"]["strain_scale"] = axes
        return self.evaluation(single, 1, 1, task)["responses"][0]["value"]

    def test_figures_are_those_of_simulations_of_their_own(self):
        for make, dimension in ((plate_2d, 2), (hook_3d, 3)):
            for model in ("follow", "nominal"):
                config = with_scenarios(make(), dimension)
                config["process"] = {"deposition": model}
                config["objective"][0]["after_release"] = dimension == 3
                expected = [self.alone(config, axes, "evaluate") for axes in config["material"]["scenarios"]]
                for ranks, groups in RUNS:
                    with self.subTest(dimension=dimension, model=model, ranks=ranks, groups=groups):
                        record = self.evaluation(config, ranks, groups)["scenarios"][0]
                        self.assertLess(largest_relative_difference(record["values"], expected), LIMIT)
                        self.assertAlmostEqual(record["mean"] / (sum(expected) / len(expected)), 1, places=6)
                        self.assertAlmostEqual(record["worst"] / max(expected), 1, places=6)
                        for aggregate in ("mean", "spread", "worst"):
                            config["objective"][0]["aggregate"] = aggregate
                            value = self.evaluation(config, ranks, groups)["responses"][0]["value"]
                            self.assertAlmostEqual(value / record[aggregate], 1, places=10)
                        config["objective"][0].pop("aggregate")

    def test_spread_is_what_deviations_make(self):
        """Of two scenarios that differ in one axis by a quarter of the strain: J of an eighth of it, and of
        half the difference in shear."""
        config = with_scenarios(plate_2d(), 2)
        config["material"]["scenarios"] = [[0.875, 1], [1.125, 1]]
        spread = self.evaluation(config)["scenarios"][0]["spread"]
        shear = 0.003 * 0.5 * (1.125**0.5 - 0.875**0.5)
        config["material"] = {"inherent_strain": [0.125 * -0.01, 0, shear]}
        value = self.evaluation(config)["responses"][0]["value"]
        self.assertAlmostEqual(spread / value, 1, places=6)

    def test_one_strain_component_is_one_case(self):
        """Strains of a single component are multiples of each other: one solve per layer, as without
        scenarios."""
        config = plate_2d()
        config["material"] = {"inherent_strain": [-0.01, 0, 0]}
        plain = self.evaluation(config)
        config["material"]["scenarios"] = [[1.2, 1], [0.7, 1.3]]
        record = self.evaluation(config)
        value = plain["responses"][0]["value"]
        self.assertEqual(record["responses"][0]["value"], value)
        self.assertLess(largest_relative_difference(record["scenarios"][0]["values"], [1.44 * value, 0.49 * value]), 1e-12)

    def test_the_worst_is_made_as_small_as_possible(self):
        """At its optimum the scenarios that count are equal, and it is better than that of the mean's
        optimum."""
        config = v_2d()
        config["material"] = {"inherent_strain": [-0.01, -0.01, 0], "scenarios": [[1.0, 1.0], [1.3, 1.0], [1.0, 1.3]]}
        config["objective"] = [{"type": "distortion", "nodes": next(iter(config["node_sets"])), "aggregate": "worst"}]
        config["projection"] = {"beta": 20, "max": 20}
        if SANITIZED:
            self.optimize(config, 2, 2)
            return
        found = {}
        for aggregate in ("worst", "mean"):
            config["objective"][0]["aggregate"] = aggregate
            summary = self.optimize(config, 2, 60).json("summary.json")
            found[aggregate] = summary["optimized"]["scenarios"][0]
        self.assertLess(found["worst"]["worst"], 0.5 * summary["start"]["scenarios"][0]["worst"])
        self.assertLess(found["worst"]["worst"], found["mean"]["worst"])
        _, second, largest = sorted(found["worst"]["values"])
        self.assertGreater(second, 0.95 * largest)

    def test_they_must_be_there_and_the_worst_is_alone(self):
        config = plate_2d()
        config["objective"][0]["aggregate"] = "mean"
        run = self.run_config(2, config, "-task", "evaluate")
        self.assertEqual(run.status, run_fabseq.BAD_INPUT)
        self.assertIn('/objective/0/aggregate: found "mean" without material.scenarios', run.messages()[0])
        config["material"] = {"scenarios": [[1, 1], [1, 1.2]]}
        config["objective"] = [{"type": "distortion", "nodes": "top", "aggregate": "worst"},
                               {"type": "distortion", "nodes": "top", "aggregate": "worst", "mean": True}]
        self.assertIn("/objective/1/aggregate: found", self.run_config(1, config, "-task", "evaluate").messages()[0])
        config["objective"][1] = {"type": "distortion", "nodes": "top", "least_squares": True}
        self.assertIn("/objective/1/least_squares: found true beside", self.run_config(1, config).messages()[0])
        config["material"]["scenarios"] = [[1, 1], [1]]
        self.assertIn("/material/scenarios/1: found [1]; allowed: a list of 2 numbers",
                      self.run_config(1, config).messages()[0])


if __name__ == "__main__":
    run_fabseq.main()
