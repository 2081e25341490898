# SPDX-License-Identifier: MIT
"""What summary.json and evaluation.json say of both deposition models, and of the start design. Each figure
of the model that was not optimized is that of a run which has it."""

import numpy as np

import run_fabseq
from read_outputs import assert_close, read_result
from run_fabseq import FabseqTest, SANITIZED, largest_relative_difference
from small_parts import hook_3d, plate_2d, post_on_substrate

MODELS = ("follow", "nominal")
LIMIT = 1e-7  # of solves to 1e-11
SPLITS = ((2, 1),) if SANITIZED else ((1, 1), (2, 1), (2, 2))


def numbers(block):
    """Of a block of a summary, in the order in which it stands there."""
    return [list(block["displacement"].values()), [list((block["nodes"] or {}).values())],
            [[term["value"], term["length"]] for term in block["distortion"]]]


class DepositionTest(FabseqTest):
    def run_task(self, config, ranks, groups, model, *arguments):
        run = self.run_config(ranks, config, "-deposition", model, "-layer_groups", groups, "-tolerance", "1e-11",
                              *arguments)
        self.assert_done(run)
        return run

    def assert_own(self, block, model):
        """The run's own model has the figures that stand elsewhere in the block."""
        own = block["deposition"][model]
        self.assertEqual(own["displacement"], block["displacement"])
        terms = [entry for entry in block["responses"]
                 if entry["type"] == "distortion" and entry["name"].startswith("objective")]
        self.assertEqual([(term["name"], term["value"]) for term in own["distortion"]],
                         [(term["name"], term["value"]) for term in terms])
        for term in own["distortion"]:
            self.assertAlmostEqual(term["length"]**2 / term["value"], 1, places=12)

    def assert_same(self, found, expected):
        """Two blocks of the same design, by runs of different models."""
        for model in MODELS:
            pair = [numbers(block["deposition"][model]) for block in (found, expected)]
            self.assertLess(largest_relative_difference(*pair), LIMIT, model)
        follow, nominal = (numbers(found["deposition"][model]) for model in MODELS)
        self.assertGreater(largest_relative_difference(follow, nominal), 0.1)

    def compare(self, config, task, file):
        for ranks, groups in SPLITS:
            with self.subTest(config=config["name"], task=task, ranks=ranks, groups=groups):
                blocks = [self.run_task(config, ranks, groups, model, "-task", task).json(file) for model in MODELS]
                for block, model in zip(blocks, MODELS, strict=True):
                    self.assert_own(block, model)
                self.assert_same(*blocks)

    def test_simulate(self):
        """Also of all layers' increments, and after the release."""
        plate = plate_2d()
        plate["objective"].append({"type": "distortion", "measure": "layerwise"})
        for config in (plate, hook_3d(), post_on_substrate(2), post_on_substrate(3)):
            self.compare(config, "simulate", "summary.json")

    def test_evaluate(self):
        """Gradients are of the run's own model."""
        self.compare(plate_2d(), "evaluate", "evaluation.json")
        self.compare(hook_3d(), "evaluate", "evaluation.json")
        config = hook_3d()
        check = self.run_config(2, config, "-task", "check_gradients", "-deposition", "nominal", "-layer_groups", 2)
        self.assert_done(check)
        self.assertLess(check.json("gradient_check.json")["worst"], 1e-5)

    def test_optimize(self):
        """After one iteration the best design is the one to start from."""
        for config in (plate_2d(), hook_3d()):
            for ranks, groups in SPLITS[-2:]:
                with self.subTest(config=config["name"], ranks=ranks, groups=groups):
                    follow, nominal = (self.run_task(config, ranks, groups, model, "-max_iterations", 1).json("summary.json")
                                       for model in MODELS)
                    for name in ("optimized", "binary", "baseline", "start"):
                        self.assert_own(follow[name], "follow")
                        self.assert_own(nominal[name], "nominal")
                        self.assert_same(nominal[name], follow[name])

    def test_nodes_are_those_that_the_objective_measures(self):
        config = hook_3d()
        run = self.run_task(config, 2, 1, "nominal", "-task", "simulate")
        displacement = read_result(run)["displacement"]
        length = np.linalg.norm(displacement, axis=-1)[-1]  # the whole top, in which the edge lies
        nodes = run.json("summary.json")["deposition"]["nominal"]["nodes"]
        self.assertAlmostEqual(nodes["max"] / length.max(), 1)
        self.assertAlmostEqual(nodes["rms"] / np.sqrt((length**2).mean()), 1)
        config["objective"] = [{"type": "distortion", "measure": "layerwise"}]
        run = self.run_task(config, 1, 1, "nominal", "-task", "simulate")
        self.assertIsNone(run.json("summary.json")["deposition"]["follow"]["nodes"])

    def test_sets_that_the_last_layers_build(self):
        """At nominal positions they move with their own layer, and a check warns of them."""
        warning = "the last layer builds 100 % of node set top, which moves mostly with its own layer"
        for model in MODELS:
            check = self.run_config(2, plate_2d(), "-deposition", model, "-task", "check")
            self.assert_done(check)
            (self.assertIn if model == "nominal" else self.assertNotIn)(warning, check.stderr)

    def test_nominal_hardly_depends_on_the_least_stiffness(self):
        """What is not built yet is as soft as that."""
        change = {}
        for model in MODELS:
            runs = [self.run_task(hook_3d(), 1, 1, model, "-task", "simulate", "-set", f"process.min_stiffness={least}")
                    for least in (1e-9, 2e-9)]
            soft, stiffer = (read_result(run)["displacement"] for run in runs)
            change[model] = np.abs(stiffer - soft).max() / np.abs(soft).max()
        self.assertLess(change["nominal"], 1e-3)
        self.assertGreater(change["follow"], change["nominal"])


class StartTest(FabseqTest):
    def test_start_is_what_the_config_starts_from(self):
        """Whatever the run starts from, and whether it was interrupted."""
        self.resumes = True
        config = plate_2d()
        first = self.optimize(config, 2)
        summary = first.json("summary.json")
        again = self.optimize(config, 2, 2, "-design", first.path("result.h5"))
        start = again.json("summary.json")["start"]
        self.assertEqual([entry["name"] for entry in start["responses"]],
                         [entry["name"] for entry in summary["start"]["responses"]])
        values = [[entry["value"] for entry in block["responses"]] for block in (start, summary["start"])]
        self.assertLess(largest_relative_difference(*values), LIMIT)
        simulated = self.run_config(1, config, "-task", "simulate", "-binary", "-tolerance", "1e-11")
        self.assert_done(simulated)
        expected = read_result(simulated)
        for name in ("time", "layer", "displacement"):
            assert_close(read_result(first)["start/" + name], expected[name], LIMIT, name)
        for block, title in (("baseline", "planar"), ("binary", "optimized")):
            skin = summary[block]["finished"]["as_built"]["skin"]
            self.assertRegex(first.stdout, rf"(?m)^  {title} +{skin['rms']:.3g} +{skin['max']:.3g} ")


if __name__ == "__main__":
    run_fabseq.main()
