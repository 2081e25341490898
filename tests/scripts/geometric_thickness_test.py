#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""fabseq-tools thickness on pseudo-times whose layers have a known thickness."""

import json
import subprocess
import tempfile
import unittest
from pathlib import Path

import h5py
import numpy as np

from fabseq_tools.geometry import geometric_thickness
from fabseq_tools.run.command_line import RunError

from fake_results import element_centres, node_coordinates

PROJECT = Path(__file__).resolve().parents[2]


def write_result(directory, size, built, time, count, target=None, nodes=None, nodes_as="temperature", time_points=None,
                 location=None):
    """What the script reads of a simulation: `time` on the elements and, if given, on the nodes; `built`,
    [z][y][x]."""
    with h5py.File(Path(directory) / "result.h5", "w") as file:
        file["density"] = 1.0 * built
        file["time"] = np.where(built, time, 0.0)
        if nodes is not None:
            file[nodes_as] = 1.0 - nodes if nodes_as == "temperature" else nodes
        if time_points is not None:
            file["time_points"] = time_points
    config = {"domain": {"size": list(size), "elements": list(built.shape[::-1])},
              "sequence": {"type": "direct", "location": location} if location else {"type": "heat"},
              "constraints": [{"type": "layer_thickness", "target": target}] if target else []}
    summary = {"layers": [{"volume": 1.0, "thickness": None, "cv": None}] * count}
    for name, content in (("config.json", config), ("summary.json", summary)):
        (Path(directory) / name).write_text(json.dumps(content), encoding="utf-8")


class GeometricThicknessTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.directory = folder.name

    def measure(self, **options):
        return geometric_thickness.measure(self.directory, points=200, **options)

    def assert_inner(self, record, thickness, tolerance, number):
        inner = [row for row in record["layers"] if row["place"] == "inner"]
        self.assertEqual(len(inner), number)
        for row in inner:
            for key in ("mean", "least", "largest"):
                self.assertAlmostEqual(row[key] / thickness, 1.0, delta=tolerance, msg=f"{key} of layer {row['layer']}")

    def test_planar_layers_are_as_thick_as_the_height_over_their_number(self):
        """Times of elements and of nodes, elements that are no cubes, an overhang: there is part above every
        point."""
        counts, size = (9, 5, 14), (3.0, 1.1, 2.1)
        x, _, z = element_centres(counts, size)
        built = (z > 1.0) | (x < 2.0)
        for nodes in (None, node_coordinates(counts, size)[2] / size[2]):
            write_result(self.directory, size, built, z / size[2], 6, nodes=nodes)
            record = self.measure()
            self.assert_inner(record, size[2] / 6, 1e-6, 4)
            self.assertAlmostEqual(record["inner"]["mean"] / (size[2] / 6), 1.0, places=6)
            for row in (record["layers"][0], record["layers"][-1]):
                self.assertAlmostEqual(row["mean"] / (size[2] / 6), 1.0, delta=2e-3, msg=row["place"])
            self.assertEqual([row["drawn_again"] for row in record["layers"]], [0] * 6)

    def test_the_last_layer_reaches_to_the_end_of_the_part(self):
        """Guided times go beyond 1 where a part is higher than its layers together."""
        counts, size = (4, 4, 16), (1.0, 1.0, 4.0)
        _, _, z = element_centres(counts, size)
        nodes = node_coordinates(counts, size)[2] * 1.25 / size[2]
        write_result(self.directory, size, np.ones(z.shape, bool), z * 1.25 / size[2], 5, nodes=nodes, nodes_as="nodal_time")
        layers = self.measure()["layers"]
        for row, height in zip(layers, [0.64] * 4 + [1.44]):
            self.assertAlmostEqual(row["mean"] / height, 1.0, delta=2e-3, msg=row["place"])

    def test_layers_along_a_slanted_direction(self):
        """Linear times are continued to the surface exactly. Without a target, and points that face
        nothing."""
        counts, size = (12, 8), (3.0, 2.0)
        x, y = element_centres(counts, size)
        time = (0.6 * x + 0.8 * y) / 3.4
        built = np.ones(time.shape, bool)
        write_result(self.directory, size, built, time, 5, target=3.4 / 5)
        record = self.measure()
        for row in record["layers"][1:4]:
            self.assertAlmostEqual(row["least"], 3.4 / 5, places=6)
            self.assertLessEqual(row["largest"], 1.3 * 3.4 / 5)

    def test_rings_in_two_dimensions(self):
        """A quarter of a disc of radius 1: isolines are circles. The error falls with the square of the
        element."""
        for count, tolerance in ((30, 0.02), (90, 0.004)):
            x, y = element_centres((count, count), (1.0, 1.0))
            nodes_x, nodes_y = node_coordinates((count, count), (1.0, 1.0))
            built = np.hypot(x, y) <= 1.0
            for nodes_as, nodes in (("nodal_time", np.hypot(nodes_x, nodes_y)),
                                    ("temperature", np.hypot(nodes_x, nodes_y)), ("", None)):
                write_result(self.directory, (1.0, 1.0), built, np.hypot(x, y), 5, target=0.2, nodes=nodes, nodes_as=nodes_as,
                             location="nodes" if nodes_as == "nodal_time" else None)
                self.assert_inner(self.measure(), 0.2, tolerance, 3)

    def test_times_of_nodes_come_before_those_of_elements(self):
        """A sequence that has them needs them; the design may have been smoothed."""
        _, y = element_centres((10, 10), (1.0, 1.0))
        nodes = node_coordinates((10, 10), (1.0, 1.0))[1]**2
        for location, thickness in (("nodes", np.sqrt(0.5) - 0.5), ("elements", 0.25)):
            write_result(self.directory, (1.0, 1.0), np.ones((10, 10), bool), y, 4, nodes=nodes if location == "nodes" else None,
                         nodes_as="nodal_time", location=location)
            self.assertAlmostEqual(self.measure()["layers"][1]["mean"], thickness, delta=5e-3)
        write_result(self.directory, (1.0, 1.0), np.ones((10, 10), bool), y, 4, nodes=nodes, nodes_as="design", location="nodes")
        with self.assertRaisesRegex(RunError, "lacks the dataset nodal_time; repeat the run"):
            self.measure()

    def test_time_points_of_the_file(self):
        write_result(self.directory, (1.0, 1.0), np.ones((10, 10), bool), element_centres((10, 10), (1.0, 1.0))[1], 4,
                     time_points=[0.2, 0.3, 0.7])
        self.assertEqual([round(row["mean"], 6) for row in self.measure()["layers"][1:3]], [0.1, 0.4])

    def test_points_that_face_nothing_are_drawn_again(self):
        """A wide block with a tower on one fifth of it: the first boundary in the tower is five times as
        short as the last in the block."""
        counts, size = (50, 40), (5.0, 4.0)
        x, y = element_centres(counts, size)
        built = (y < 2.0) | (x < 1.0)
        write_result(self.directory, size, built, y / 4.0, 8, target=0.5)
        record = self.measure()
        self.assertEqual(record["target"], 0.5)
        # Layer 4 ends where the block does, at y = 2; a line just below is as wide as the block, one above as
        # the tower.
        write_result(self.directory, size, built, y / 4.0, 10, target=0.4, time_points=np.arange(1, 10) / 10 + 0.04)
        facing = self.measure()["layers"]
        self.assertEqual([row["drawn_again"] for row in facing[1:4]], [0, 0, 0])
        share = facing[4]["drawn_again"] / (facing[4]["drawn_again"] + 200)  # layer 5: from y = 1.76, all wide, to 2.16
        self.assertAlmostEqual(share, 1 - (1.0 + np.sqrt(0.52**2 - 0.4**2)) / 5, delta=0.05)
        self.assertLessEqual(facing[4]["largest"], 0.52)
        self.assertIsNotNone(facing[4]["mean"])

    def test_layers_without_material(self):
        """The last used layer is told from those that are empty."""
        write_result(self.directory, (1.0, 1.0), np.ones((20, 20), bool), 0.75 * element_centres((20, 20), (1.0, 1.0))[1], 8)
        record = self.measure()
        self.assertEqual([row["place"] for row in record["layers"]], ["first"] + ["inner"] * 4 + ["last"] + ["empty"] * 2)
        self.assertEqual([row["mean"] for row in record["layers"][6:]], [None, None])
        self.assert_inner(record, 1.0 / 6, 1e-6, 4)

    def test_program(self):
        write_result(self.directory, (1.0, 1.0), np.ones((8, 8), bool), element_centres((8, 8), (1.0, 1.0))[1], 4)
        command = ["/usr/bin/python3", PROJECT / "scripts/fabseq-tools", "thickness", self.directory, "--points", "50"]
        first = subprocess.run(command, capture_output=True, text=True, check=True).stdout
        self.assertIn("no target", first)
        with open(Path(self.directory) / "geometric_thickness.json", encoding="utf-8") as file:
            record = json.load(file)
        self.assertEqual(record["points"], 50)
        self.assertAlmostEqual(record["inner"]["mean"], 0.25)
        self.assertEqual(subprocess.run(command, capture_output=True, text=True, check=True).stdout, first)  # fixed seed
        refused = subprocess.run([*command[:3], self.directory + "/no"], capture_output=True, text=True, check=False)
        self.assertEqual(refused.returncode, 2)
        self.assertIn("is missing", refused.stderr)


if __name__ == "__main__":
    unittest.main()
