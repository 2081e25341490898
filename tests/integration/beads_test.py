# SPDX-License-Identifier: MIT
"""Simulated layers that stand for several real ones, each a bead high."""

import copy

import h5py

import run_fabseq
from run_fabseq import FabseqTest, largest_relative_difference
from small_parts import hook_3d, plate_2d
from thermal_test import interpass, warmed


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


if __name__ == "__main__":
    run_fabseq.main()
