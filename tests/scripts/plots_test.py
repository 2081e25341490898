#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""fabseq-tools plot-gradients, plot-sensitivity and plot-check, on made-up data."""

import json
import subprocess
import tempfile
import unittest
from pathlib import Path
from xml.etree import ElementTree

import h5py
import numpy as np

from fabseq_tools.plot import check
from fabseq_tools.plot.voxel_view import Box, faces_of_cells

PROJECT = Path(__file__).resolve().parents[2]
SVG = "{http://www.w3.org/2000/svg}"
HOSTILE = "a$b$ <&> \"c\""  # what Matplotlib or XML could take for something else


class Picture:
    """Texts of an SVG file, and how many shapes the groups of a name have."""

    def __init__(self, path):
        self.root = ElementTree.parse(path).getroot()
        self.texts = ["".join(text.itertext()).strip() for text in self.root.iter(SVG + "text")]

    def shapes(self, name):
        return sum(len([*group.iter(SVG + kind)]) for group in self.root.iter(SVG + "g") if group.get("id") == name
                   for kind in ("path", "use"))


class PlotsTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def run_tool(self, *words):
        return subprocess.run(["/usr/bin/python3", PROJECT / "scripts/fabseq-tools", *map(str, words)], cwd=self.folder,
                              capture_output=True, text=True, check=False)

    def picture(self, command, name):
        done = self.run_tool(command, self.folder)
        self.assertEqual((done.returncode, done.stderr, done.stdout.strip()), (0, "", str(self.folder / name)))
        return Picture(self.folder / name)

    def write_json(self, name, content):
        (self.folder / name).write_text(json.dumps(content), encoding="utf-8")

    def assert_refused(self, command, words):
        done = self.run_tool(command, self.folder)
        self.assertEqual((done.returncode, done.stderr.count("\n")), (2, 1), done.stderr)
        self.assertIn(words, done.stderr)


class Gradients(PlotsTest):
    def test_a_curve_for_each_component(self):
        self.assert_refused("plot-gradients", "gradient_check.json")
        steps = [10.0 ** -k for k in range(1, 8)]
        components = [{"name": f"objective_{k}", "type": "distortion", "variables": variables,
                       "relative_errors": [0.0, 1e-30, 1e5, *(step ** 2 for step in steps[3:])]}
                      for k in range(30) for variables in ("design", "time_points")]
        self.write_json("gradient_check.json", {"name": HOSTILE, "steps": steps, "components": components})
        texts = self.picture("plot-gradients", "gradient_check.svg").texts
        self.assertIn(f"Gradients of {HOSTILE}", texts)
        self.assertLessEqual({"1e-7", "1e-1", "objective_7 distortion", "objective_29 distortion, time_points"}, set(texts))


class Sensitivity(PlotsTest):
    def test_a_line_for_each_change(self):
        self.assert_refused("plot-sensitivity", "sensitivity.json")
        changes = [{"change": "unchanged", "ratio": {"length": 3.0, "rms": 1.0}},
                   {"change": "strain xx +10 %", "ratio": {"length": None, "rms": 0.0}},
                   {"change": "grid twice as fine", "skipped": "left out"}]
        for length, tick in ((3.0, "5"), (1e30, "1e+09")):
            changes[0]["ratio"]["length"] = length
            self.write_json("sensitivity.json", {"name": HOSTILE, "changes": changes})
            texts = self.picture("plot-sensitivity", "sensitivity.svg").texts
            self.assertLessEqual({f"Sensitivity of {HOSTILE}", "unchanged", "grid twice as fine (skipped)", tick},
                                 set(texts))


class Check(PlotsTest):
    def write(self, layer, substrate=None, spacing=0.5, plate="z-", node_sets=()):
        with h5py.File(self.folder / "check.h5", "w") as file:
            file["layer"] = np.asarray(layer, dtype="f4")
            file["substrate"] = np.zeros_like(file["layer"]) if substrate is None else np.asarray(substrate, dtype="f4")
            file["spacing"] = np.full(np.ndim(layer), spacing)
            file.attrs.update(name=HOSTILE, unit="mm", plate=plate)
            for name, count, nodes in node_sets:
                file[f"node_sets/{name}"] = np.asarray(nodes, dtype=float)
                file.attrs[f"node_sets/{name}"] = count

    def test_solids_show_the_faces_that_are_seen(self):
        layer = np.zeros((3, 2, 2))
        layer[1, :, 0], layer[2] = 1, 2
        substrate = np.zeros((3, 2, 2))
        substrate[0] = 1
        self.write(layer, substrate, node_sets=[(HOSTILE, 3000, [[0, 0, 3], [2, 2, 3]])])
        picture = self.picture("plot-check", "check.svg")
        # Substrate and layer 2: four sides each, two and four tops. Layer 1: two at right, one in front.
        self.assertEqual(picture.shapes("cells"), 8 + 6 + 3)
        self.assertEqual(picture.texts, [f"{HOSTILE}: [2,2,3] elements", "box 1 × 1 × 1.5 mm", "build plate z-", "substrate",
                                         "layer 1 of the start design", "layer 2", f"node set {HOSTILE}, 3000 nodes"])

    def test_plates_are_seen_from_the_front(self):
        layer = np.repeat([[1], [2], [3]], 5, axis=1)
        layer[1, 4] = 0
        self.write(layer, plate="y-", node_sets=[("a", 1, [[0, 3]]), ("b", 1, [[5, 3]])])
        picture = self.picture("plot-check", "check.svg")
        self.assertEqual(picture.shapes("cells"), 14)
        self.assertEqual(picture.texts[2:], ["build plate y-", "layer 1 of the start design", "layer 3",
                                             "node set a, 1 nodes", "node set b, 1 nodes"])
        first = (self.folder / "check.svg").read_bytes()
        self.picture("plot-check", "check.svg")
        self.assertEqual((self.folder / "check.svg").read_bytes(), first)
        done = self.run_tool("plot-check", self.folder, "--picture", "other.png")
        self.assertEqual((done.returncode, done.stderr, done.stdout), (0, "", "other.png\n"))

    def test_nothing_to_draw(self):
        self.assert_refused("plot-check", "check.h5")
        self.write(np.zeros((2, 2, 2)))
        self.assertEqual(self.picture("plot-check", "check.svg").shapes("cells"), 0)
        with h5py.File(self.folder / "check.h5", "w") as file:
            file["layer"] = np.zeros((2, 2))
        self.assert_refused("plot-check", "spacing, substrate")
        (self.folder / "check.h5").write_text("no HDF5", encoding="utf-8")
        self.assert_refused("plot-check", "check.h5")

    def test_fine_grids_are_drawn_in_blocks(self):
        layer = np.zeros((90, 150))
        layer[1, 0], layer[:, 149] = 2, 3
        self.write(layer, plate="y-")
        drawn = check.Check(self.folder / "check.h5")
        self.assertIn("drawn in blocks of 3", drawn.title())
        self.assertEqual(drawn.content.shape, (50, 30))
        self.assertEqual((drawn.content[0, 0], drawn.content[1, 0], set(drawn.content[49])), (3, 0, {4}))
        joined = check.joined(np.arange(5 * 4 * 3).reshape(5, 4, 3), 2)
        self.assertEqual(joined.shape, (3, 2, 2))
        self.assertEqual((joined[0, 0, 0], joined[-1, -1, -1]), (16, 59))

    def test_faces_in_front_come_last(self):
        content = np.ones((2, 2, 1), dtype=int)
        content[1, 0, 0] = 2
        corners, colours = faces_of_cells(content, ["#000000", "#ffffff"])
        self.assertEqual(len(corners), 2 + 2 + 4)
        brightness = [colour[0] for colour in colours]
        self.assertEqual(brightness[-3:], [0.72, 0.88, 1.0])
        self.assertEqual(set(brightness[:-3]), {0.0})
        np.testing.assert_allclose(corners[-1][:, 2], 1)
        # x to the right and down, y to the right and up, z up.
        x, y, z = Box((1, 1, 1), (1, 1, 1)).project(np.eye(3))
        self.assertTrue(x[0] > 0 > x[1] and y[0] > 0 and y[1] > 0 and z[0] == 0 and z[1] > 0)


if __name__ == "__main__":
    unittest.main()
