#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""--machine of fabseq-tools new, orient and compare-families: all take the machine's limits from its file."""

import json
import os
import shutil
import subprocess
import sys

import run_fabseq
from run_fabseq import ENVIRONMENT, PROGRAM, ROOT, FabseqTest
from small_meshes import write_box
from small_parts import hook_3d

from fabseq_tools.run.machine import settings_for
from fabseq_tools.run.read_run import read_config

TOOLS = os.path.join(ROOT, "scripts", "fabseq-tools")
MACHINES = os.path.join(ROOT, "configs", "machines")


def hook():
    """In mm, with a tool of its own, which --machine replaces but for what no machine file says."""
    config = hook_3d()
    config["domain"] = {"size": [64, 32, 64], "elements": [8, 4, 8], "unit": "mm"}
    config["part"] = {"union": [{"box": {"min": [0, 0, 0], "max": [32, 32, 64]}},
                                {"box": {"min": [0, 0, 40], "max": [64, 32, 64]}}]}
    return config | {"node_sets": {"skin": {"all": True, "surface": True}}, "sequence": {"type": "heat"},
                     "objective": [{"type": "distortion", "measure": "shape", "nodes": "skin"}],
                     "constraints": [{"type": "layer_thickness", "target": 20}, {"type": "tilt"}],
                     "tool": {"thickness": [0.9, 1.1], "max_tilt": 80, "most_places": 3},
                     "optimizer": {"max_iterations": 2, "final_move_limit": 0.004}}


class MachineOptionTest(FabseqTest):
    def tool(self, *words, status=0):
        done = subprocess.run([sys.executable, TOOLS, *words], capture_output=True, text=True, cwd=self.directory, check=False,
                              env={**ENVIRONMENT, **os.environ, "FABSEQ_PROGRAM": PROGRAM})
        self.assertEqual(done.returncode, status, done.stderr)
        return done.stderr if status else done.stdout

    def path(self, *names):
        return os.path.join(self.directory, *names)

    def json(self, *names):
        with open(self.path(*names), encoding="utf-8") as file:
            return json.load(file)

    def check(self, name):
        command = [PROGRAM, "-config", self.path(name), "-task", "check"]
        return subprocess.run(command, capture_output=True, text=True, check=False)

    def test_new(self):
        """The config names the machine; what options say otherwise stands beside it."""
        write_box(self.path("bar.stl"), (60.0, 20.0, 20.0))
        printed = self.tool("new", "bar.stl", "--machine", "robot_turn_tilt", "--thickness", "8")
        config = read_config(self.path("bar.json"))
        self.assertEqual(config["machine"], "robot_turn_tilt")
        self.assertNotIn("tool", config)
        self.assertEqual([one["type"] for one in config["constraints"]],
                         ["layer_thickness", "last_layer", "local_thickness", "tilt", "tool_clearance", "supported"])
        self.assertEqual(config["sequence"]["type"], "heat")  # 90 degrees
        self.assertIn("beads 6 mm wide and 2 high, layers of 8 that are 4.8 to 12 thick in places", printed)
        self.assertNotIn("tilt: at most 60", printed)
        checked = self.check("bar.json")
        self.assertEqual(checked.returncode, 0, checked.stderr)
        self.assertIn("cell: robot with a table that turns and tilts; ", checked.stdout)

    def test_new_with_a_file(self):
        """A file's path is relative to the config. Without a thickness layers are a bead high."""
        write_box(self.path("bar.stl"), (60.0, 20.0, 20.0))
        shutil.copy(os.path.join(MACHINES, "large_bead.json"), self.path("cell.json"))
        os.mkdir(self.path("configs"))
        self.tool("new", "bar.stl", "--machine", "cell.json", "--bead-width", "9", "--max-tilt", "30", "-o", "configs/bar.json")
        config = read_config(self.path("configs", "bar.json"))
        self.assertEqual(config["machine"], "../cell.json")
        self.assertEqual(config["tool"], {"bead_width": 9.0, "max_tilt": 30.0})
        self.assertEqual((config["constraints"][0]["target"], config["sequence"]["type"]), (5, "guided"))
        self.assertEqual(self.check("configs/bar.json").returncode, 0)

    def test_new_with_a_gantry(self):
        """Its torch stays upright, so no constraint holds its tilt."""
        write_box(self.path("bar.stl"), (60.0, 20.0, 20.0))
        self.tool("new", "bar.stl", "--machine", "gantry_three_axis", "--thickness", "8")
        config = read_config(self.path("bar.json"))
        self.assertNotIn("tilt", [one["type"] for one in config["constraints"]])
        self.assertEqual(config["sequence"]["type"], "guided")
        self.assertIn("the torch stands upright on layers, which lean up to 30 degrees", self.check("bar.json").stdout)

    def test_new_refuses(self):
        write_box(self.path("bar.stl"), (60.0, 20.0, 20.0))
        for words, message in ((["--machine", "none"], "/machine: found \"none\""),
                               (["--machine", "large_bead", "--thickness", "3"], "/layers/target: found layers of 3"),
                               (["--machine", "large_bead", "--unit", "ell"], "/domain/unit: found \"ell\" with a machine")):
            self.assertIn(message, self.tool("new", "bar.stl", *words, status=2))
            self.assertFalse(os.path.exists(self.path("bar.json")))

    def test_families(self):
        """Runs have the machine's tool in place of the config's, and layers lean no further."""
        self.tool("compare-families", self.write_config(hook()), "--machine", "gantry_three_axis", "--subparts", "--step", "30",
                  "--azimuths", "1", "--ranks", "1", "--output", "out", "--program", PROGRAM)
        rows = {row["layers"]: row for row in self.json("out", "families.json")["rows"]}
        self.assertIn("tilted planar, 30 degrees", rows)
        for name in ("planar", "guided"):
            tool = self.json("out", rows[name]["folder"], "config.json")["tool"]
            self.assertEqual((tool["name"], tool["axis"], tool["max_tilt"], tool["most_places"]),
                             ("three-axis gantry", [0, 0, 1], 30, 3))
            self.assertEqual(tool["thickness"], [0.7, 1.4])
            self.assertTrue(tool["profile"])

    def test_orient(self):
        """Simulations have the machine's tool; the config to go on with names the machine."""
        write_box(self.path("bar.stl"), (60.0, 30.0, 20.0))
        config = hook() | {"domain": {"element": 5, "unit": "mm"}, "part": {"mesh": {"file": "bar.stl"}}, "layers": {"count": 3},
                           "constraints": [{"type": "layer_thickness", "target": 8}], "machine": "robot_fixed_plate"}
        self.tool("orient", self.write_config(config), "--machine", "robot_turn_tilt", "--turn", "y 90", "--output", "out")
        tool = self.json("out", "y90", "planar", "config.json")["tool"]
        self.assertEqual((tool["name"], tool["most_places"]), ("robot with a table that turns and tilts", 3))
        self.assertEqual(tool["thickness"], [0.6, 1.5])
        written = self.json("out", "y90", "config.json")
        self.assertEqual((written["machine"], written["tool"]), ("robot_turn_tilt", {"most_places": 3}))
        self.assertEqual(self.check("out/y90/config.json").returncode, 0)

    def test_what_a_machine_replaces(self):
        config = {"tool": {"max_tilt": 3, "places_share": 0.1}, "process": {"dwell": 5, "deposition_rate": 2},
                  "thermal": {"plate": 9}}
        self.assertEqual(settings_for(config, None), {})
        self.assertEqual(settings_for(config, "gantry_three_axis"),
                         {"machine": "gantry_three_axis", "tool": {"places_share": 0.1}, "process": {"dwell": 5}})


if __name__ == "__main__":
    run_fabseq.main()
