# SPDX-License-Identifier: MIT
"""scripts/use/orient.py compares a part in several orientations."""

import csv
import json
import os
import subprocess
import sys

import numpy as np

import run_fabseq
from mesh_test import box_triangles, stl_text
from run_fabseq import ENVIRONMENT, FabseqTest, PROGRAM, ROOT

sys.path.insert(0, os.path.join(ROOT, "tests", "scripts"))
from pictures import drawn  # noqa: E402

SCRIPT = os.path.join(ROOT, "scripts", "use", "orient.py")


def angle():
    """A foot of 40 x 20 x 10 with a wall at its end, 40 high; and what means nothing once it is turned."""
    return {"name": "angle", "domain": {"element": 5, "unit": "mm"},
            "part": {"mesh": {"file": "angle.stl", "least_elements": 2, "rotate": [["z", 90]]}},
            "clamps": {"box": {"min": [-20, 0, 0], "max": [0, 5, 5]}},
            "node_sets": {"foot": {"box": {"min": [-20, 0, 0], "max": [0, 40, 0]}}},
            "sequence": {"type": "heat"}, "layers": {"count": 4},
            "objective": [{"type": "distortion", "nodes": "foot"}],
            "constraints": [{"type": "layer_thickness", "target": 10}]}


class OrientTest(FabseqTest):
    def setUp(self):
        super().setUp()
        with open(os.path.join(self.directory, "angle.stl"), "w", encoding="utf-8") as file:
            file.write(stl_text(np.concatenate([box_triangles(np.zeros(3), np.array(high))
                                                for high in ([40.0, 20.0, 10.0], [10.0, 20.0, 40.0])])))

    def orient(self, config, *options):
        text = "// a comment\n" + json.dumps(config)
        command = [sys.executable, SCRIPT, self.write_config(text), "--program", PROGRAM, "--output", self.path(""), *options]
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

    def test_errors(self):
        shape = angle()
        shape["part"] = {"box": {"min": [0, 0, 0], "max": [40, 20, 10]}}
        for config, options, words in ((shape, [], "part.mesh is missing"), (angle(), ["--turn", "x"], '--turn "x": allowed'),
                                       (angle(), ["--turn", "w 90"], "found w 90"), ({}, [], "domain is missing")):
            run = self.orient(config, *options)
            self.assertEqual(run.returncode, 1)
            self.assertTrue(run.stderr.startswith("orient.py: "), run.stderr)
            self.assertIn(words, run.stderr)
            self.assertEqual(len(run.stderr.splitlines()), 1)


if __name__ == "__main__":
    run_fabseq.main()
