# SPDX-License-Identifier: MIT
"""Simulated layers that stand for several real ones, each a bead high."""

import copy
import os

import h5py
import numpy as np

import run_fabseq
from multi_planar_test import tee_2d
from run_fabseq import FabseqTest, distinct, largest_relative_difference
from small_parts import direct_2d, hook_3d, plate_2d
from thermal_test import interpass, warmed

TOOL = {"max_tilt": 60, "thickness": [0.6, 1.6], "bead_width": 0.3}


def in_beads(config, passes):
    """The same simulated layers, each of so many beads: thicknesses are those of a bead."""
    config = copy.deepcopy(config)
    config["layers"]["passes"] = passes
    for term in config["constraints"]:
        if term["type"] == "layer_thickness":
            term["target"] /= passes
    return config


class BeadsTest(FabseqTest):
    def evaluated(self, config):
        run = self.run_config(1, config, "-task", "evaluate", "-tolerance", "1e-11")
        self.assert_done(run)
        return run.json("evaluation.json")

    def values(self, config):
        return [entry["value"] for entry in self.evaluated(config)["responses"]]

    def test_thicknesses_are_those_of_beads(self):
        """What counts is a layer's: as many times as thick as its beads."""
        for config in (plate_2d(), hook_3d()):
            config["constraints"].append({"type": "local_thickness"})
            self.assertLess(largest_relative_difference(self.values(in_beads(config, 3)), self.values(config)), 1e-9)

    def test_slabs_are_as_thick_as_their_beads_together(self):
        config = {"domain": {"size": [6, 12], "elements": [6, 12]}, "part": {"box": {"min": [0, 0], "max": [6, 12]}},
                  "sequence": {"type": "planar"}, "layers": {"type": "multi_planar", "subparts": 1, "thickness": 3},
                  "objective": [{"type": "distortion", "measure": "layerwise"}]}
        beads = copy.deepcopy(config)
        beads["layers"] |= {"thickness": 1, "passes": 3}
        records = [self.evaluated(one) for one in (config, beads)]
        self.assertEqual(*(one["layers"] for one in records))
        self.assertEqual(*(one["responses"] for one in records))

    def test_heat_counts_the_same_passes(self):
        """Alone, thermal.passes counts for heat and pauses only, as the layers' thickness is what it was."""
        alone = warmed(hook_3d(), passes=2)
        both = in_beads(alone, 2)
        left_open = copy.deepcopy(both)
        del left_open["thermal"]["passes"]
        expected = interpass(self.evaluated(alone))
        for config in (both, left_open):
            self.assertEqual(interpass(self.evaluated(config)), expected)
        other = copy.deepcopy(both)
        other["thermal"]["passes"] = 3
        self.assert_refused(other, '/thermal/passes: found 3 with layers.passes 2; allowed: "layers" or the same number')

    def assert_refused(self, config, words, *options):
        run = self.run_config(1, config, "-task", "simulate", *options)
        self.assertEqual(run.status, run_fabseq.BAD_INPUT, str(run))
        self.assertEqual(run.stderr, f"fabseq: {words}\n")

    def test_pauses_follow_each_bead(self):
        config = plate_2d()
        config["material"] = {"mass_density": 7.85}
        config["process"] = {"deposition_rate": 2.5, "dwell": 600}
        hours = []
        for passes in (1, 4):
            run = self.run_config(1, in_beads(config, passes), "-task", "simulate", "-binary")
            self.assert_done(run)
            hours.append(run.json("summary.json")["build_hours"])
        self.assertAlmostEqual(hours[1] - hours[0], 3 * 4 * 600 / 3600, places=9)

    def test_cut_again(self):
        """A file says how many beads its layers stand for: as many are made, whatever layers they come in."""
        run = self.optimize(in_beads(plate_2d(), 3), 1, 2)
        with h5py.File(run.path("result.h5"), "r") as file:
            self.assertEqual(file.attrs["passes"], 3)
        for options, count, passes in (((), 4, 3), (("-set", "layers.passes=1"), 12, 1), (("-layers", 6), 6, 2),
                                       (("-layers", 5), 5, 1), (("-layers", 8, "-set", "layers.passes=2"), 8, 2)):
            again = self.run_config(1, run.path("config.json"), "-task", "simulate", "-binary", "-sequence",
                                    run.path("result.h5"), *options)
            self.assert_done(again)
            layers = again.json("config.json")["layers"]
            self.assertEqual((layers["count"], layers["passes"]), (count, passes), options)
            self.assertAlmostEqual(layers["target"] * passes * count, 4 * 0.3, places=9, msg=str(options))
        self.assert_refused(run.path("config.json"), "/layers/passes: found 5 with -sequence of 12 real layers; allowed: a "
                            "number that divides them, or one with layers.count", "-sequence", run.path("result.h5"),
                            "-set", "layers.passes=5")

    def test_check_says_what_a_layer_stands_for(self):
        config = in_beads(plate_2d(), 3)
        config["domain"]["unit"] = "mm"
        run = self.run_config(1, config, "-task", "check")
        self.assert_done(run)
        self.assertIn("\nbeads: a layer stands for 3 one above the other, 0.1 mm each\n", run.stdout)
        self.assertNotIn("beads:", self.run_config(1, plate_2d(), "-task", "check").stdout)


class RealLayersTest(FabseqTest):
    """What is judged, and what paths are made of."""

    def real_layers(self, run):
        """Times and layers of the elements in its folder beads, and all else that is in there."""
        with h5py.File(run.path("beads/result.h5"), "r") as file:
            fields = {name: file[name][()] for name in file if name in ("time", "layer", "density", "time_points")}
        return fields, run.json("beads/summary.json")

    def test_planar_layers_are_what_a_simulation_of_them_says(self):
        """On that grid, with as many layers: the time is linear, so that nothing is lost on the way."""
        config = plate_2d() | {"sequence": {"type": "planar"}, "tool": TOOL}
        for ranks in distinct(1, 2):
            run = self.run_config(ranks, in_beads(config, 3), "-task", "simulate", "-binary")
            self.assert_done(run)
            found = run.json("summary.json")
            real = found["real_layers"]
            self.assertEqual((real["passes"], real["count"], real["elements"]), (3, 12, [80, 48]))
            self.assertAlmostEqual(real["elements_per_bead"], 4)
            self.assertIn(real["words"], run.stdout)
            direct = copy.deepcopy(config)
            direct["domain"]["elements"], direct["layers"]["count"] = [80, 48], 12
            direct["constraints"][0]["target"] = 0.1
            expected = self.run_config(1, direct, "-task", "simulate", "-binary")
            self.assert_done(expected)
            expected = expected.json("summary.json")
            self.assertEqual(found["verdict"]["class"], expected["verdict"]["class"])
            self.assertEqual(found["places_in_all"], expected["places_in_all"])
            for name in ("hanging", "tilt"):
                self.assertEqual(found["checks"][name], expected["checks"][name], name)
            self.assertAlmostEqual(found["checks"]["local_thickness"]["largest"], 0.1, places=9)
            fields, summary = self.real_layers(run)
            np.testing.assert_array_equal(fields["layer"][fields["density"] > 0],
                                          np.ceil(12 * fields["time"][fields["density"] > 0] - 1e-9))
            self.assertEqual(summary["verdict"], found["verdict"])
            element = 2.0 * 1.2 * 0.5 / fields["density"].size
            volume = sum(layer["volume"] for layer in summary["layers"])
            self.assertAlmostEqual(volume, fields["density"].sum() * element, places=9)

    def test_each_layer_is_cut_into_equal_steps(self):
        """Of the pseudo-time between its own time points, where these vary, too."""
        config = direct_2d("nodes")
        run = self.run_config(1, in_beads(config, 2), "-set", "optimizer.max_iterations=2")
        self.assert_done(run)
        fields, summary = self.real_layers(run)
        with h5py.File(run.path("result.h5"), "r") as file:
            ends = np.concatenate([[0.0], file["time_points"][()], [1.0]])
        cut = np.interp(np.arange(9) / 2, np.arange(5), ends)
        np.testing.assert_allclose(fields["time_points"], cut[1:-1], atol=1e-12)
        built = fields["density"] > 0
        np.testing.assert_array_equal(fields["layer"][built], np.searchsorted(cut[1:], fields["time"][built] - 1e-12) + 1)
        self.assertEqual(len(summary["layers"]), 8)

    def test_a_bound_of_the_tilt_holds_for_real_layers(self):
        """Directions of the design that keep it are carried to the finer grid, and keep it there."""
        config = hook_3d() | {"sequence": {"type": "guided", "max_tilt": 50}, "tool": TOOL | {"max_tilt": 50}}
        config["objective"] = config["objective"][:1]
        summary = self.optimize(in_beads(config, 3), 1, 2).json("summary.json")
        self.assertLessEqual(summary["binary"]["checks"]["tilt"]["largest"], 50 + 1e-6)
        self.assertGreater(summary["binary"]["checks"]["tilt"]["largest"], 5)

    def test_layers_of_a_ridge_are_as_thick_as_elsewhere(self):
        """Where layers of two sides meet, the gradient turns over within an element, and is as long there."""
        config, slope = plate_2d(), np.radians(60)
        config |= {"part": {"box": {"min": [0, 0], "max": [2, 1.2]}}, "tool": TOOL | {"max_tilt": 180}}
        x, y = np.meshgrid(0.05 + 0.1 * np.arange(20), 0.05 + 0.1 * np.arange(12))
        height = 1.2 * np.cos(slope) + np.sin(slope)
        path = os.path.join(self.directory, "roof.h5")
        with h5py.File(path, "w") as file:
            file["time"] = (y * np.cos(slope) + (1 - np.abs(x - 1)) * np.sin(slope)) / height
            file["time_gradient"] = np.stack([-np.sign(x - 1) * np.sin(slope), np.full(x.shape, np.cos(slope))], axis=-1) / height
        config["constraints"][0]["target"] = height / 12
        config["layers"] = {"count": 4, "passes": 3}
        run = self.run_config(1, config, "-task", "simulate", "-sequence", path, "-binary")
        self.assert_done(run)
        summary = run.json("summary.json")
        self.assertGreater(summary["real_layers"]["elements_per_bead"], 2)
        found = summary["checks"]["local_thickness"]
        self.assertAlmostEqual(found["least"] / (height / 12), 1, delta=1e-6)
        self.assertAlmostEqual(found["largest"] / (height / 12), 1, delta=1e-6)

    def test_spread_by_lumping(self):
        """As simulations of the same sequence in simulated and in real layers have it, and planar ones."""
        config = in_beads(plate_2d(), 2)
        run = self.optimize(config, 1, 2)
        real = run.json("summary.json")["binary"]["real_layers"]
        lumping = real["lumping"]
        self.assertEqual(lumping["elements"], [20, 12])
        self.assertAlmostEqual(lumping["elements_per_bead"], 1.5)
        self.assertIn(lumping["words"], run.stdout)
        self.assertIn("spread by lumping: the first distortion term, as a length, is ", lumping["words"])
        for passes, name in ((2, "simulated"), (1, "real")):
            options = "-task", "simulate", "-binary", "-set", f"layers.passes={passes}", "-tolerance", "1e-11"
            again = self.run_config(1, run.path("config.json"), "-sequence", run.path("result.h5"), *options)
            planar = self.run_config(1, config | {"sequence": {"type": "planar"}}, *options, "-layers", 8 // passes)
            for one, key in ((again, name), (planar, "planar_" + name)):
                self.assert_done(one)
                expected = one.json("summary.json")
                self.assertAlmostEqual(lumping[key]["length"]**2 / expected["responses"][0]["value"], 1, delta=1e-6)
                self.assertAlmostEqual(lumping[key]["rms"] / expected["displacement"]["rms"], 1, delta=1e-6)
        self.assertNotAlmostEqual(lumping["real"]["length"] / lumping["simulated"]["length"], 1, delta=1e-3)

    def test_thin_real_layers_are_simulated_on_a_finer_grid(self):
        for options, elements, count in (((), [40, 24], 1.2), (("-finer_grid", "false"), [20, 12], 0.6)):
            run = self.run_config(1, in_beads(plate_2d(), 5), "-set", "optimizer.max_iterations=1", *options)
            self.assert_done(run)
            lumping = run.json("summary.json")["binary"]["real_layers"]["lumping"]
            self.assertEqual(lumping["elements"], elements)
            self.assertAlmostEqual(lumping["elements_per_bead"], count)
            self.assertEqual("the grid does not resolve real layers" in lumping["words"], count < 1)

    def test_all_sequences_are_judged_alike(self):
        config = in_beads(hook_3d(), 3) | {"tool": TOOL, "baseline": {"direction": "best"}}
        runs = [self.run_config(ranks, config, "-set", "optimizer.max_iterations=2") for ranks in distinct(1, 2)]
        for run in runs:
            self.assert_done(run)
            summary = run.json("summary.json")
            for block in ("binary", "start", "baseline", "baseline_tilted", "baseline_even"):
                self.assertEqual(summary[block]["real_layers"]["elements"], [32, 16, 32], block)
                self.assertEqual(summary[block]["real_layers"]["count"], 3 * len(summary[block]["layers"]), block)
            self.assertNotIn("real_layers", summary["optimized"])
            self.assertEqual(summary["answer"]["class"], summary["binary"]["verdict"]["class"])
            self.assertIn(summary["binary"]["real_layers"]["words"], run.stdout)
        for run in runs[1:]:
            self.assertEqual(run.json("summary.json")["binary"]["verdict"]["class"],
                             runs[0].json("summary.json")["binary"]["verdict"]["class"])

    def test_slabs_are_cut(self):
        config = tee_2d()
        thickness = config["layers"].get("thickness", 3.0)
        config["layers"] |= {"passes": 2, "thickness": thickness / 2}
        run = self.run_config(1, config, "-task", "simulate", "-binary")
        self.assert_done(run)
        _, summary = self.real_layers(run)
        simulated = run.json("summary.json")["layers"]
        self.assertLessEqual(abs(len(summary["layers"]) - 2 * len(simulated)), config["layers"]["subparts"] * 2)
        self.assertEqual({layer["subpart"] for layer in summary["layers"]}, {layer["subpart"] for layer in simulated})

    def test_paths_are_those_of_beads(self):
        config = in_beads(hook_3d(), 3) | {"tool": TOOL}
        run = self.optimize(config, 1, 2)
        done = self.run_tool("paths", run.output, "--no-picture")
        self.assertEqual(done.returncode, 0, done.stderr)
        record = run.json("paths/paths_summary.json")
        numbers = [layer["layer"] for layer in record["layers"] + record["without_path"]]
        self.assertEqual(sorted(numbers), list(range(1, 10)))
        self.assertIn(f"feed 1 is a bead of {0.55 / 3:.4g} x ", done.stdout)
        refused = self.run_tool("paths", run.output, "--no-picture", "--of", "planar")
        self.assertEqual(refused.returncode, 2)
        self.assertIn("each of the layers stands for 3 beads, and the run has cut only the optimized ones", refused.stderr)

    def test_runs_that_others_begin_with_are_not_judged(self):
        options = "-set", "optimizer.coarse_iterations=2", "-set", "optimizer.max_iterations=1"
        run = self.run_config(1, in_beads(plate_2d(), 2), *options)
        self.assert_done(run)
        self.assertIn("real_layers", run.json("summary.json")["binary"])
        self.assertNotIn("real_layers", run.json("coarse/summary.json")["binary"])
        self.assertFalse(os.path.exists(run.path("coarse/beads")))

    def test_the_next_run_removes_the_folder(self):
        path = self.write_config(in_beads(plate_2d(), 3))
        options = "-task", "simulate", "-binary", "-overwrite"
        run = self.run_program(1, "-config", path, *options)
        self.assert_done(run)
        self.assertTrue(os.path.isdir(run.path("beads")))
        again = self.run_program(1, "-config", self.write_config(plate_2d()), *options, output=run.output)
        self.assert_done(again)
        self.assertFalse(os.path.exists(run.path("beads")))
        self.assertNotIn("real_layers", again.json("summary.json"))


if __name__ == "__main__":
    run_fabseq.main()
