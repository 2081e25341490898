# SPDX-License-Identifier: MIT
"""fabseq-tools orient compares a part in several orientations."""

import csv
import json
import os
import re
import subprocess
import sys

import numpy as np

import run_fabseq
from mesh_test import box_triangles, stl_text
from pictures import drawn
from run_fabseq import ENVIRONMENT, FabseqTest, PROGRAM, ROOT

UP = np.array([0.0, 0, 7])  # of the drawing's origin, from which the plate takes the part down
TOOL = os.path.join(ROOT, "scripts", "fabseq-tools"), "orient"


def angle():
    """A foot of 40 x 20 x 10 with a wall at its end, 40 high; and what means nothing once it is turned."""
    return {"name": "angle", "domain": {"element": 5, "unit": "mm"},
            "part": {"mesh": {"file": "angle.stl", "least_elements": 2, "rotate": [["z", 90]]}},
            "clamps": {"box": {"min": [-20, 0, 0], "max": [0, 5, 5]}},
            "node_sets": {"foot": {"box": {"min": [-20, 0, 0], "max": [0, 40, 0]}}},
            "sequence": {"type": "heat"}, "layers": {"count": 4},
            "objective": [{"type": "distortion", "nodes": "foot"}],
            "constraints": [{"type": "layer_thickness", "target": 10}]}


def whole():
    """A config of the same part with most of what a user can ask for; in its own orientation the wall lies at
    y 0 to 10."""
    config = angle()
    del config["clamps"]
    config["node_sets"] |= {
        "top": {"box": {"min": [-20, 0, 40], "max": [0, 10, 40]}, "samples": 5},
        "ball": {"sphere": {"center": [-10, 0, 20], "radius": 12}}, "rod": {"cylinder": {"from": [-10, 0, 5], "to": [-10, 40, 5],
                                                                                         "radius": 6}},
        "profile": {"polygon": {"axis": "x", "points": [[0, 0], [12, 0], [0, 33]]}, "surface": True},
        "mixed": {"difference": [{"half_space": {"point": [0, 20, 0], "normal": [0, -1, 0]}},
                                 {"union": [{"box": {"min": [-20, 30, 0], "max": [-10, 40, 5]}}]}]},
        "near": {"near": {"mesh": "face.stl", "distance": 1}}, "skin": {"all": True, "surface": True}}
    return config | {
        "build_plate": "z-", "material": {"inherent_strain": [-0.01, -0.01, -0.005, 0, 0, 0], "yield_stress": 400},
        "process": {"min_stiffness": 1e-6}, "sequence": {"type": "heat", "characteristic_length": 48},
        "projection": {"beta": 8, "max": 100, "factor": 1.4}, "baseline": {"layers": 4},
        "objective": [{"type": "distortion", "measure": "flatness", "axis": "z", "nodes": "top", "after_release": True},
                      {"type": "distortion", "measure": "shape", "nodes": "near"}, {"type": "layer_uniformity", "weight": 0.3}],
        "constraints": [{"type": "layer_thickness", "target": 10, "tolerance": 0.2},
                        {"type": "distortion", "nodes": "profile", "limit": 1.5}, {"type": "last_layer"}],
        "tool": {"max_tilt": 60, "bead_width": 5}, "optimizer": {"max_iterations": 7}, "solver": {"tolerance": 1e-7},
        "output": {"every": 3}}


class OrientTest(FabseqTest):
    def setUp(self):
        super().setUp()
        with open(os.path.join(self.directory, "angle.stl"), "w", encoding="utf-8") as file:
            file.write(stl_text(UP + np.concatenate([box_triangles(np.zeros(3), np.array(high))
                                                     for high in ([40.0, 20.0, 10.0], [10.0, 20.0, 40.0])])))

    def orient(self, config, *options):
        text = "// a comment\n" + json.dumps(config)
        command = [sys.executable, *TOOL, self.write_config(text), "--program", PROGRAM, "--output", self.path(""), *options]
        return subprocess.run(command, capture_output=True, text=True, cwd=self.directory, check=False,
                              env={**ENVIRONMENT, **os.environ})

    def path(self, name):
        return os.path.join(self.directory, "out", name)

    def json(self, name):
        with open(self.path(name), encoding="utf-8") as file:
            return json.load(file)

    def test_two_that_can_be_built_and_one_that_cannot(self):
        run = self.orient(angle(), "--turn", "y 45", "--turn", "z 0", "--turn", "x 45 x -135")
        self.assertEqual((run.returncode, run.stderr), (0, ""))
        *records, refused = self.json("orientation.json")
        self.assertEqual(refused["orientation"], "y45")
        self.assertIn("/part/mesh: found", refused["reason"])
        by_name = {record["orientation"]: record for record in records}
        self.assertEqual({name: record["face_down"] for name, record in by_name.items()}, {"z0": "z-", "x45_x-135": "y+"})
        for name, height, layers, contact, overhang in (("z0", 40, 4, 800, 0), ("x45_x-135", 40, 7, 200, 600)):
            record = by_name[name]
            self.assertEqual([record[key] for key in ("height", "contact_area", "overhang")], [height, contact, overhang])
            self.assertEqual((record["start"]["layers"], record["planar"]["layers"]), (layers, 4))
            for sequence in ("start", "planar"):
                value = self.json(f"{name}/{sequence}/summary.json")["responses"][0]["value"]
                self.assertAlmostEqual(record[sequence]["as_built"]["rms"] / np.sqrt(value), 1, delta=1e-5)
                self.assertGreater(record[sequence]["released"]["largest"], record[sequence]["released"]["rms"])
        best = [record["start"]["released"]["rms"] for record in records]
        self.assertEqual(best, sorted(best))
        with open(self.path("orientation.csv"), encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([row["orientation"] for row in rows], [*by_name, "y45"])
        self.assertEqual(float(rows[0]["start_released_rms"]), best[0])
        self.assertIn("/part/mesh", run.stdout.splitlines()[-2])
        left, middle, right = drawn(self.path("orientation.png"), 2, 3, (0.1, 0.8, 0.1, 0.9))[:3]
        self.assertGreater(min(left, middle), 0.05)
        self.assertLess(right, 0.05)

    def test_multi_planar_layers(self):
        """They have no number from which the length of the drain could follow."""
        config = angle() | {"layers": {"type": "multi_planar", "subparts": 2, "thickness": 10}, "constraints": []}
        run = self.orient(config, "--turn", "z 0")
        self.assertEqual((run.returncode, run.stderr), (0, ""))
        self.assertEqual(self.json("z0/simulated.json")["sequence"], {"type": "heat"})

    def counts(self, path):
        """Nodes of each set, as -task check says it."""
        run = self.run_program(1, "-config", path, "-task", "check", output="")
        self.assert_done(run)
        return dict(re.findall(r"^node set (\w+): (\d+) nodes", run.stdout, re.MULTILINE))

    def test_config_to_go_on_with(self):
        """It is the user's own, and its node sets hold the nodes at the same places of the part."""
        with open(os.path.join(self.directory, "face.stl"), "w", encoding="utf-8") as file:
            file.write(stl_text(UP + box_triangles(np.array([40.0, 0, 0]), np.array([40.0, 20, 10]))))  # y 40 as given
        config = whole()
        run = self.orient(config, "--turn", "x 45 x -135", "--turn", "z 0")
        self.assertEqual((run.returncode, run.stderr), (0, ""))
        turned, same = self.json("x45_x-135/config.json"), self.json("z0/config.json")
        face, part = (os.path.join(self.directory, name) for name in ("face.stl", "angle.stl"))
        config["node_sets"]["near"]["near"]["mesh"], config["part"]["mesh"]["file"] = face, part
        self.assertEqual(same, config | {"name": "angle_z0", "part": {"mesh": config["part"]["mesh"] | {
            "rotate": [["z", 90], ["z", 0.0]]}}})
        changed = {key for key in config if config[key] != turned[key]}
        self.assertEqual((set(config), changed), (set(turned), {"name", "part", "node_sets", "objective", "layers", "sequence",
                                                                "projection"}))
        self.assertEqual(turned["node_sets"]["top"], {"box": {"min": [-20, 47, 30], "max": [0, 47, 40]}, "samples": 5})
        config["objective"][0]["axis"] = "y"
        self.assertEqual(turned["objective"], config["objective"])
        self.assertEqual(turned["layers"], {"count": 7})
        self.assertEqual((turned["sequence"], turned["projection"]), ({"type": "heat", "characteristic_length": 84},
                                                                      {"beta": 14, "max": 175, "factor": 1.4}))
        expected = self.counts(os.path.join(self.directory, "case.json"))
        self.assertEqual(set(expected), set(config["node_sets"]))
        for name in ("x45_x-135", "z0"):
            self.assertEqual(self.counts(self.path(f"{name}/config.json")), expected)
        notes = {record["orientation"]: record["notes"] for record in self.json("orientation.json")}
        self.assertEqual(notes, {"z0": [], "x45_x-135": [
            "with the number of layers: layers.count 4 to 7, sequence.characteristic_length 48 to 84, projection.beta 8 to 14, "
            "projection.max 100 to 175"]})
        self.assert_done(self.run_program(1, "-config", self.path("x45_x-135/config.json"), "-max_iterations", 1))

    def test_what_cannot_be_turned(self):
        """Half a right angle: no polygon, no flatness; a face without a node of the turned grid becomes
        thicker. What stood somewhere is not there any more."""
        config = whole()
        del config["node_sets"]["near"], config["objective"][1]
        config["part"]["mesh"]["least_elements"] = 0
        config["domain"] = {"size": [20, 40, 40], "elements": [4, 8, 8], "origin": [-20, 0, 0], "unit": "mm"}
        config |= {"clamps": {"box": {"min": [-20, 0, 0], "max": [0, 5, 5]}}, "layers": {"count": "auto"}}
        run = self.orient(config, "--turn", "y 45")
        self.assertEqual((run.returncode, run.stderr), (0, ""))
        turned, (record,) = self.json("y45/config.json"), self.json("orientation.json")
        notes = dict(note.split(": ", 1) for note in record["notes"])
        self.assertEqual(set(notes), {
            "domain", "node set profile is left out, with 1 of constraints that name it",
            "objective", "clamps is left out, the part stands on the build plate", "with the number of layers",
            *(f"node set {name}" for name in ("foot", "top") if turned["node_sets"][name].get("within"))})
        for note in record["notes"]:
            self.assertIn(f"{self.path('y45')}/config.json: {note}", run.stdout)
        self.assertEqual(turned["domain"], {"element": [5, 5, 5], "unit": "mm"})
        self.assertEqual(turned["layers"], {"count": "auto"})
        self.assertNotIn("clamps", turned)
        self.assertEqual(set(self.counts(self.path("y45/config.json"))),
                         set(config["node_sets"]) - {"profile"} | {"compared_surface"})
        self.assertEqual([term["type"] for term in turned["constraints"]], ["layer_thickness", "last_layer"])
        self.assertEqual([term.get("measure") for term in turned["objective"]], ["shape", None])

    def test_errors(self):
        shape = angle()
        shape["part"] = {"box": {"min": [0, 0, 0], "max": [40, 20, 10]}}
        for config, options, words in ((shape, [], "part.mesh is missing"), (angle(), ["--turn", "x"], '--turn "x": allowed'),
                                       (angle(), ["--turn", "w 90"], "found w 90"), ({}, [], "domain is missing")):
            run = self.orient(config, *options)
            self.assertEqual(run.returncode, 2)
            self.assertTrue(run.stderr.startswith("fabseq-tools orient: "), run.stderr)
            self.assertIn(words, run.stderr)
            self.assertEqual(len(run.stderr.splitlines()), 1)


if __name__ == "__main__":
    run_fabseq.main()
