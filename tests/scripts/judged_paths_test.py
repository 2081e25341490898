#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Paths and layers of a run are what its check has judged, and rapid ways know what stands."""

import json
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy as np

from fabseq_tools.geometry import export_layers
from fabseq_tools.geometry.layer_bodies import LayeredPart
from fabseq_tools.paths.torch_paths import all_passes
from fabseq_tools.paths.ways import Standing, rapid_ways

from fake_results import element_centres, node_coordinates
from layered_results import write_layers

PROJECT = Path(__file__).resolve().parents[2]
VERDICT = "buildable but for 3 places"
COUNTS, SIZE = (24, 10, 12), (2.4, 1.0, 1.2)  # elements of 0.1


class JudgedPathsTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.run_directory = os.path.join(folder.name, "run")

    def judged(self, built, time, count, gradient, **more):
        """The result of a check: a run with layers of a time of the nodes with that gradient."""
        centres = element_centres(COUNTS, SIZE)
        element_time, slope = time(*centres), np.stack(np.broadcast_arrays(*gradient(*centres)), axis=-1)
        layer = np.where(built, np.clip(np.ceil(element_time * count - 1e-9), 1, count), 0.0)
        length = np.linalg.norm(slope, axis=-1)
        thickness = np.where(built, 1.0 / (count * length), 0.0)
        summary = {"verdict": {"buildable": False, "class": "buildable_but_for_places", "words": VERDICT, "reasons": []},
                   "places": [{"words": "a roof of 3 x 3 mm near [1, 2, 3]"}], "places_in_all": 3,
                   "checks": {"local_thickness": {"least": thickness[built].min(), "largest": thickness[built].max()}}}
        write_layers(self.run_directory, SIZE, built, count, 1.0 - time(*node_coordinates(COUNTS, SIZE)), layer=layer,
                     local_thickness=thickness, build_direction=slope / length[..., None], summary=summary, **more)
        return layer, summary["checks"]["local_thickness"]

    def sloping(self, x, y, z):
        """Layers that are thicker to the right."""
        return z * (1.0 - 0.2 * x) / 1.25

    def slope(self, x, y, z):
        return -0.2 * z / 1.25, 0.0 * x, (1.0 - 0.2 * x) / 1.25

    def test_heights_are_those_judged(self):
        """Also where a layer ends at the part's top, thinner than any element that was judged."""
        built = np.ones(COUNTS[::-1], bool)
        layer, judged = self.judged(built, self.sloping, 5, self.slope)
        part = LayeredPart(self.run_directory)
        passes = all_passes(part, 0.12, 1, 0.0, 90.0, 0.5)
        heights = np.concatenate([one.heights for one in passes])
        self.assertGreaterEqual(heights.min(), 0.99 * judged["least"])
        self.assertLessEqual(heights.max(), 1.01 * judged["largest"])
        self.assertLessEqual({one.layer for one in passes}, set(np.unique(layer)))
        for one in passes:
            x, y, z = one.points.T
            np.testing.assert_allclose(one.heights, 0.2 / np.linalg.norm(self.slope(x, y, z), axis=0), rtol=0.03)
            np.testing.assert_allclose(one.levels, 5 * self.sloping(x, y, z) - one.layer + 1, atol=0.02)
        wire = sum((one.lengths() * one.heights * one.spacings).sum() for one in passes)
        self.assertAlmostEqual(wire / part.body.volumes().sum(), 1.0, delta=0.02)
        part = LayeredPart(self.run_directory)
        for number, one in part.layers.items():
            thickness, _ = part.thickness(one, np.unique(part.body.corners[part.body.label == number]))
            self.assertGreaterEqual(thickness.min(), judged["least"])
            self.assertLessEqual(thickness.max(), judged["largest"])

    def test_slivers_become_part_of_a_neighbour(self):
        """The last layer ends a third of an element's edge above the interface: no element belongs to it."""
        built = element_centres(COUNTS, SIZE)[2] < 1.1
        layer, _ = self.judged(built, lambda x, y, z: (z + 0.0 * x) / 1.2, 9, lambda x, y, z: (0.0, 0.0, 1 / 1.2 + 0.0 * z))
        self.assertEqual(layer.max(), 8)  # the ninth begins at 1.067, the part ends at 1.1
        part = LayeredPart(self.run_directory)
        self.assertEqual(list(part.layers), list(range(1, 9)))
        self.assertAlmostEqual(part.joined[9], 2.4 * 1.0 * (1.1 - 8 * 1.2 / 9), places=4)
        record = export_layers.export(part, os.path.join(self.run_directory, "out"), ["stl"])
        self.assertEqual([row["layer"] for row in record["joined"]], [9])
        self.assertAlmostEqual(record["volume"], 2.4 * 1.1, places=6)
        self.assertTrue(all(row["open_edges"] == 0 for row in record["layers"]))

    def test_words(self):
        built = element_centres(COUNTS, SIZE)[2] < 1.1
        self.judged(built, lambda x, y, z: (z + 0.0 * x) / 1.2, 9, lambda x, y, z: (0.0, 0.0, 1 / 1.2 + 0.0 * z))
        for command in (["paths", "--bead-width", "0.3", "--no-picture"], ["layers", "--format", "stl"]):
            done = subprocess.run(["/usr/bin/python3", PROJECT / "scripts/fabseq-tools", command[0], self.run_directory,
                                   *command[1:]], capture_output=True, text=True, check=True)
            self.assertEqual(done.stdout.splitlines()[:3],
                             [VERDICT, "  a roof of 3 x 3 mm near [1, 2, 3]", "  and 2 more places"])
            self.assertIn("slivers that no element of their layer stands for are part of a neighbour", done.stdout)
            self.assertIn("by layer, with their volume: 9 (0.08)", done.stdout)
        record = json.loads((Path(self.run_directory) / "paths/paths_summary.json").read_text())
        self.assertEqual((record["verdict"]["words"], record["ways"]["count"]), (VERDICT, record["starts"] - 1))

    def posts(self):
        """Two posts, the left one built before the right one."""
        x, _, z = element_centres(COUNTS, SIZE)
        built = ((x < 0.8) | (x > 1.6)) & (z < 1.0)

        def time(x, y, z):
            return (z + 0.0 * x) / 2.4 + np.where(x > 1.2, 0.5, 0.0)

        self.judged(built, time, 12, lambda x, y, z: (0.0, 0.0, 1 / 2.4 + 0.0 * z))
        part = LayeredPart(self.run_directory)
        return part, all_passes(part, 0.2, 1, 0.0, 0.0, 0.5)

    def test_rapid_ways(self):
        """From the top of one post down to the foot of the other, the straight way cuts the first one."""
        part, passes = self.posts()
        ways = rapid_ways(part, passes, 0.15)
        jump = next(k for k, one in enumerate(passes) if one.points[:, 0].mean() > 1.2) - 1
        self.assertEqual([way.number for way in ways if way.straight > 0], [jump + 1])
        way = ways[jump]
        self.assertTrue(way.raised)
        self.assertEqual(way.depth, 0.0)
        self.assertAlmostEqual(way.points[1:3, 2].min(), 1.15, places=6)
        self.assertFalse(any(one.raised for one in ways if one is not way))

    def test_depth(self):
        part, passes = self.posts()
        standing = Standing(part, passes)
        last, through = len(passes), np.array([[-0.5, 0.5, 0.5], [1.2, 0.5, 0.5]])
        self.assertAlmostEqual(standing.depth(last, through)[0], 0.4, delta=0.06)  # in the middle of a post 0.8 wide
        self.assertEqual(standing.depth(0, through)[0], 0.0)
        self.assertEqual(standing.depth(last, through + [0, 0, 0.6])[0], 0.0)
        self.assertAlmostEqual(standing.depth(last, np.array([[1.2, 0.5, 0.5], [1.2, 0.5, -0.3]]))[0], 0.3)  # the plate


if __name__ == "__main__":
    unittest.main()
