#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""A machine file in a config, from its entries to what a run checks and writes."""

import json
import os

import run_fabseq
from run_fabseq import BAD_INPUT, ROOT, FabseqTest, distinct

MACHINES = os.path.join(ROOT, "configs", "machines")
# A column with an arm, on a foot that each of the plates has room for.
ARM = {"name": "arm", "domain": {"size": [64, 16, 48], "elements": [16, 4, 12], "unit": "mm"},
       "part": {"union": [{"box": {"min": [0, 0, 0], "max": [24, 16, 32]}}, {"box": {"min": [0, 0, 32], "max": [64, 16, 48]}}]},
       "node_sets": {"skin": {"all": True, "surface": True}},
       "material": {"file": os.path.join(ROOT, "configs", "materials", "ER70S-6.json")},
       "sequence": {"type": "guided"}, "layers": {"count": 6},
       "objective": [{"type": "distortion", "measure": "shape", "nodes": "skin"}],
       "constraints": [{"type": "layer_thickness"}, {"type": "local_thickness"}]}


class MachineFileTest(FabseqTest):
    def machine(self, name):
        with open(os.path.join(MACHINES, name), encoding="utf-8") as file:
            return json.load(file)

    def test_the_shelf(self):
        """Every machine of configs/machines can be taken, and its rate, speed and bead go together."""
        names = sorted(os.listdir(MACHINES))
        self.assertGreaterEqual(len(names), 5)
        for name in distinct(*names):
            run = self.run_config(1, ARM, "-task", "check", "-machine", name, "-set", "layers.target=10",
                                  "-set", "constraints=[]")
            self.assert_done(run)
            machine = self.machine(name)
            self.assertIn(f"cell: {machine['name']}; ", run.stdout)
            tilt, width = machine["tilt"]["value"], machine["bead_width"]["value"]
            self.assertIn(f"lean up to {tilt} degrees; beads {width} mm wide", run.stdout)
            self.assertNotIn("/tool/", run.stderr)

    def test_a_run(self):
        """The effective config has what follows from the machine, and repeats the run."""
        turn_tilt = self.machine("robot_turn_tilt.json")
        run = self.run_config(1, {**ARM, "machine": "robot_turn_tilt"}, "-task", "simulate", "-binary", "-set",
                              "constraints.0.target=8", "-set", "tool.max_tilt=50", "-set", "thermal.heat_input=3e6")
        self.assert_done(run)
        config = run.json("config.json")
        self.assertNotIn("machine", config)
        tool = config["tool"]
        self.assertEqual((tool["name"], tool["max_tilt"], tool["axis"]), (turn_tilt["name"], 50, "normal"))
        self.assertEqual(tool["profile"], turn_tilt["torch"]["value"])
        self.assertEqual(tool["thickness"], [end / 2 for end in turn_tilt["bead_heights"]["value"]])
        self.assertEqual((config["thermal"]["passes"], config["thermal"]["interpass_limit"]), (4, 149))
        self.assertEqual(config["process"]["deposition_rate"], 3)
        self.assertEqual(config["sequence"]["stretch"], "auto")
        self.assertGreater(run.json("summary.json")["build_hours"], 0)
        again = self.run_config(1, config, "-task", "simulate", "-binary")
        self.assert_done(again)
        self.assertEqual(again.json("config.json")["tool"], tool)
        self.assertEqual(again.json("summary.json")["checks"], run.json("summary.json")["checks"])

    def test_what_follows(self):
        """-task machine prints it, whatever else is wrong with the config."""
        run = self.run_config(1, {"machine": "gantry_three_axis", "domain": {"unit": "cm"}}, "-task", "machine")
        self.assert_done(run)
        printed = json.loads(run.stdout)
        self.assertEqual(printed["tool"]["axis"], [0, 0, 1])
        self.assertEqual((printed["tool"]["bead_width"], printed["layers"]["target"]), (0.5, 0.2))

    def test_refusals(self):
        cases = [(["-machine", "none"], "; allowed: a file beside the config, or one of gantry_three_axis.json, "),
                 (["-machine", "robot_turn_tilt", "-set", "domain.unit=ell"], "/domain/unit: found \"ell\" with a machine"),
                 (["-machine", "robot_turn_tilt", "-set", "constraints.0.target=0.5"],
                  "/constraints/0/target: found layers of 0.5"),
                 (["-machine", "robot_turn_tilt", "-set", "tool.plate=[60, 60]"],
                  "/tool/plate: found a part of 64 x 16; allowed: at most 60 x 60"),
                 (["-set", "tool.plate=[60]"], "/tool/plate: found [60]; allowed: two numbers > 0, or []")]
        for words, message in cases:
            run = self.run_config(1, ARM, "-set", "constraints.0.target=8", *words)
            self.assertEqual(run.status, BAD_INPUT, str(run))
            self.assertEqual(len(run.messages()), 1, str(run))
            self.assertIn(message, run.stderr)
            self.assertFalse(os.path.exists(run.output))

    def test_speed_that_cannot_be(self):
        """A bead's section times the speed is another rate than the machine's."""
        run = self.run_config(1, ARM, "-task", "check", "-machine", "robot_turn_tilt", "-set",
                              "constraints.0.target=8", "-set", "tool.travel_speed=90")
        self.assert_done(run)
        self.assertIn("/tool/travel_speed: found 90, with which a bead of this width and height takes 30.5 kg/h; expected: about "
                      "process.deposition_rate, 3", run.stderr)


if __name__ == "__main__":
    run_fabseq.main()
