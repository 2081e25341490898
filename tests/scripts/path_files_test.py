#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""What import-paths makes of tables and files of torch paths: order, kinds, programs of robots, gradients."""

import json
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

import h5py
import numpy as np

from fabseq_tools.paths.deposited import is_off
from fabseq_tools.paths.hermite import interpolate
from fabseq_tools.paths.path_sequence import ends

PROJECT = Path(__file__).resolve().parents[2]
TOOLS = PROJECT / "scripts/fabseq-tools"
SIZE, COUNTS = (40.0, 20.0, 8.0), (20, 10, 8)  # of the box; two layers of 4
CONFIG = {"name": "box", "domain": {"size": SIZE, "elements": COUNTS, "unit": "mm"}, "part": {}, "sequence": {"type": "heat"},
          "layers": {"type": "curved", "count": 2}}


def lines(layer, low=0.0, high=SIZE[0]):
    """Waypoints of lines along y in a layer, between two x."""
    z = 4.0 * layer - 2.0
    return [(x, y, z) for x in np.arange(low + 1.0, high, 2.0) for y in (1.0, 7.0, 13.0, 19.0)]


class PathFilesTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        (self.folder / "config.json").write_text(json.dumps(CONFIG), encoding="utf-8")

    def imported(self, name, *options):
        command = ["/usr/bin/python3", TOOLS, "import-paths", self.folder / name, self.folder / "config.json", *options]
        return subprocess.run(command, capture_output=True, text=True, check=False)

    def table(self, header, rows, name="paths.csv"):
        text = "\n".join([header, *(",".join(map(str, row)) for row in rows)])
        (self.folder / name).write_text(text + "\n", encoding="utf-8")
        return name

    def fields(self, name, *options):
        done = self.imported(name, *options)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        with h5py.File(self.folder / (os.path.splitext(name)[0] + "_sequence.h5")) as file:
            return {key: file[key][()] for key in file}, done.stdout

    def refused(self, name, *words):
        done = self.imported(name)
        self.assertEqual((done.returncode, done.stderr.count("\n")), (2, 1), done.stderr)
        for word in words:
            self.assertIn(word, done.stderr)

    def test_order_against_layer(self):
        """The left half is built to its top before the right one begins."""
        rows, order = [], 0
        for low, high in ((0.0, 20.0), (20.0, 40.0)):
            for layer in (1, 2):
                for x, y, z in lines(layer, low, high):
                    order += 1
                    rows.append((order, x, y, z, layer))
        random = np.random.default_rng(1)
        fields, printed = self.fields(self.table("order,x,y,z,layer", [rows[k] for k in random.permutation(len(rows))]))
        self.assertIn("the column order goes back to earlier layers: 2 of the table are 4 in this order", printed)
        self.assertIn('"count": 4', printed)
        expected = np.empty(COUNTS[::-1], int)
        expected[:4, :, :10], expected[4:, :, :10], expected[:4, :, 10:], expected[4:, :, 10:] = 1, 2, 3, 4
        np.testing.assert_array_equal(fields["layer"], expected)
        # Differences of the times within a layer point upwards.
        for first in (0, 4):
            np.testing.assert_allclose(np.diff(fields["time"][first:first + 4], axis=0), 1 / 16, rtol=0.05)
        # Without the column, layers count, and that is said; one that begins anew in each layer counts there.
        fields, printed = self.fields(self.table("x,y,z,layer", [row[1:] for row in rows]))
        self.assertIn("layers count, as there is no column order", printed)
        self.assertEqual(fields["layer"].max(), 2)
        again = [(k + 1, x, y, z, layer) for layer in (1, 2) for k, (x, y, z) in enumerate(lines(layer))]
        fields, printed = self.fields(self.table("order,x,y,z,layer", again))
        self.assertIn("they count within each layer", printed)
        self.assertEqual(fields["layer"].max(), 2)

    def test_finer_grid(self):
        rows = [(*point, layer) for layer in (1, 2) for point in lines(layer)]
        name = self.table("x,y,z,layer", rows)
        fields, printed = self.fields(name, "--finer", "2")
        expected = np.empty([2 * count for count in COUNTS[::-1]], int)
        expected[:8], expected[8:] = 1, 2
        np.testing.assert_array_equal(fields["layer"], expected)
        self.assertIn(" -set domain.elements=[40,20,16] ", printed)
        voxels = {**CONFIG, "part": {"voxels": {"file": "part.h5"}}}
        (self.folder / "config.json").write_text(json.dumps(voxels), encoding="utf-8")
        self.assertIn("allowed: 1 for a part in voxels", self.imported(name, "--finer", "2").stderr)

    def test_no_direction_far_from_those_of_the_waypoints(self):
        """Where two fronts meet and one has grown farther in its layer, interpolated slopes overshoot."""
        rows, fronts = [], ((1.0, 0.5), (1.2, 0.1))  # lean and level
        for layer in (1, 2):
            for x, y, z in lines(layer):
                lean, level = fronts[x > 17]
                rows.append((x, y, z, lean, 0.0, 1.0, layer, 4.0, level))
        fields, _ = self.fields(self.table("x,y,z,axis_x,axis_y,axis_z,layer,height,level", rows))
        slopes = fields["build_direction"] / fields["local_thickness"][..., None]
        given = np.array([np.array([lean, 0.0, 1.0]) / np.hypot(lean, 1.0) / 4.0 for lean, _ in fronts])
        room = 0.6 * np.ptp(given, axis=0) + 1e-9  # without a bound, 20 times as far
        self.assertTrue((slopes > given.min(axis=0) - room).all() and (slopes < given.max(axis=0) + room).all())

    def test_travels_are_left_out(self):
        """By whatever column says so: at a safe height they would be layers of their own."""
        rows = [(*point, layer) for layer in (1, 2) for point in lines(layer)]
        plain, _ = self.fields(self.table("x,y,z,layer", rows, "plain.csv"))
        for column, on, off in (("kind", "weld", "travel"), ("Type", "WALL-OUTER", "rapid move"), ("arc", 1, 0),
                                ("arc_on", "true", "false"), ("move", "G1", "G0"), ("extruder toggle", "True", "False"),
                                ("velocity", 10, -1), ("state", "on", "arc off"), ("is travel", "False", "True"), ("rapid", 0, 1),
                                ("segment_type", "PRINT", "NON_PRINT"), ("wire speed [m/min]", 5, 0), ("e", 0.2, 0),
                                ("motion", "ArcL", "MoveJ"), ("process", "welding", "non-welding"), ("arc", 1, "")):
            rows = [(x, y, height, layer, cell) for layer in (1, 2) for x, y, z in lines(layer)
                    for height, cell in ((z + 6.0, off), (z, on))]
            fields, printed = self.fields(self.table(f"x,y,z,layer,{column}", rows))
            words = f"nothing is deposited at 160 of 320 waypoints, which are left out: {'empty' if off == '' else off} (160)"
            self.assertIn(words, printed, column)
            np.testing.assert_array_equal(fields["layer"], plain["layer"], column)
        rows = [(*point, 1, k % 2) for k, point in enumerate(lines(1))]
        self.assertIn("column type: numbers, of which it is not known", self.fields(self.table("x,y,z,layer,type", rows))[1])
        rows = [(*point, 1, 0) for point in lines(1)]
        self.refused(self.table("x,y,z,layer,arc", rows), "column arc: found 0 (80) in all rows")

    def test_paths_that_do_not_fit_the_part(self):
        """Of a run, whose elements are known."""
        with h5py.File(self.folder / "result.h5", "w") as file:
            file["density"] = np.ones(COUNTS[::-1])
        rows = [(*point, layer) for layer in (1, 2) for point in lines(layer)]
        self.fields(self.table("x,y,z,layer", rows))  # without a word
        for moved, words in (([row for row in rows if row[0] < 25], "% of the part's elements lie farther than"),
                             ([(x + 15, y, z, layer) for x, y, z, layer in rows], "% of the waypoints lie farther than")):
            done = self.imported(self.table("x,y,z,layer", moved))
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn(words, done.stderr)
        axes = [(*row[:3], 0, 0, -1, row[3], 4) for row in rows]
        done = self.imported(self.table("x,y,z,axis_x,axis_y,axis_z,layer,height", axes))
        self.assertIn("warning: ", done.stderr)
        self.assertIn("the axes point towards the plate", done.stderr)
        axes[3] = (*axes[3][:3], 0, 0, 0, *axes[3][6:])
        self.refused(self.table("x,y,z,axis_x,axis_y,axis_z,layer,height", axes), "line 5, column axis_x: found '0,0,0'")

    def test_words(self):
        for cell in ("0", "0.0", "-1", "nan", "off", "ARC_OFF", "no weld", "non-deposition", "travel", "Rapid", "g00", "G0",
                     "jump move", "approach", "False", "PTP"):
            self.assertTrue(is_off(cell), cell)
        for cell in ("non-planar", "weld no 5", "standoff 3"):
            self.assertFalse(is_off(cell), cell)
        for cell in ("1", "0.3", "on", "weld", "outline", "hatch", "link", "G1", "g01", "G2", "infill", "north", "offset wall",
                     "seam", "nozzle", "contour", ""):
            self.assertFalse(is_off(cell), cell)

    def test_programs_of_machines(self):
        """By their lines or their endings."""
        for name, text, what in (("a.gcode", "G1 X1 Y2 E3\n", "G-code"), ("b.csv", "N10 G01 X1.5 Y2\n", "G-code"),
                                 ("c.nc", "%\nO1000\nG0 Z5\n", "G-code"), ("d.src", "DEF part( )\nLIN {X 1, Y 2, Z 3}\n", "KRL"),
                                 ("e.txt", "&ACCESS RVP\n", "KRL"), ("f.mod", "MODULE Weld\nENDMODULE\n", "RAPID"),
                                 ("g.txt", "  MoveL p10, v100, fine, tool0;\n", "RAPID"), ("h.ls", "/PROG WELD\n", "Fanuc")):
            (self.folder / name).write_text(text, encoding="utf-8")
            self.refused(name, f": is {what}" if what == "G-code" else what, "allowed: a table (CSV)")

    def test_lengths_that_cannot_be(self):
        for name, value in (("height", 0), ("height", -4), ("spacing", 0)):
            rows = [(*point, 1, 0, 0, 1, value if k == 2 else 4) for k, point in enumerate(lines(1))]
            table = self.table(f"x,y,z,layer,axis_x,axis_y,axis_z,{name}", rows)
            self.refused(table, f"line 4, column {name}: found '{value}'", "a length above 0")

    def test_gradient(self):
        """Axes and heights of a table become direction, thickness and gradient; without, there are none."""
        rows = [(*point, layer, 0, 0, 1, 4) for layer in (1, 2) for point in lines(layer)]
        fields, _ = self.fields(self.table("x,y,z,layer,axis_x,axis_y,axis_z,height", rows))
        np.testing.assert_allclose(fields["build_direction"], np.tile([0, 0, 1.0], (*COUNTS[::-1], 1)), atol=1e-6)
        np.testing.assert_allclose(fields["local_thickness"], 4.0, rtol=1e-5)
        np.testing.assert_allclose(fields["time_gradient"][..., 2], 1 / 8, rtol=1e-5)
        centres = np.arange(8) + 0.5
        np.testing.assert_allclose(fields["time"], np.tile(centres[:, None, None] / 8, (1, 10, 20)), atol=1e-6)
        fields, _ = self.fields(self.table("x,y,z,layer", [row[:4] for row in rows]))
        self.assertEqual(set(fields), {"time", "layer"})
        np.testing.assert_allclose(fields["time"], np.tile(centres[:, None, None] / 8, (1, 10, 20)), atol=1e-6)

    def test_level_of_waypoints(self):
        """A column says where in their layers they lie."""
        rows = [(x, y, z + 1.5, layer, 0, 0, 1, 4, 0.875) for layer in (1, 2) for x, y, z in lines(layer)]
        fields, _ = self.fields(self.table("x,y,z,layer,axis_x,axis_y,axis_z,height,level", rows))
        np.testing.assert_allclose(fields["time"][:, 5, 10], (np.arange(8) + 0.5) / 8, atol=1e-6)


class HermiteTest(unittest.TestCase):
    def test_fields_of_degree_two(self):
        """Near a smooth field and its gradient, and nothing of neighbours that do not count."""
        random = np.random.default_rng(5)
        points, places = random.uniform(-1, 1, (40, 20, 3)), random.uniform(-0.3, 0.3, (40, 3))
        matrix = np.array([[0.2, 0.1, 0.0], [0.1, -0.1, 0.05], [0.0, 0.05, 0.3]])

        def value(x):
            return 1.0 + x @ [0.5, -2.0, 3.0] + np.einsum("...i,ij,...j", x, matrix, x)

        def slope(x):
            return [0.5, -2.0, 3.0] + 2.0 * x @ matrix

        counts = random.random((40, 20)) < 0.8
        values, gradients = value(points), slope(points)
        values[~counts], gradients[~counts] = 1e6, 1e6
        field, gradient = interpolate(places, points, values, gradients, counts)
        np.testing.assert_allclose(field, value(places), atol=0.02)
        np.testing.assert_allclose(gradient, slope(places), atol=0.15)
        twice = np.concatenate([points, points[:, :5]], axis=1)  # points that coincide
        again, _ = interpolate(places, twice, value(twice), slope(twice), np.ones((40, 25), bool))
        np.testing.assert_allclose(again, value(places), atol=0.02)

    def test_slopes_of_those_that_are_heard(self):
        slopes = np.array([[[0.0, 0.1, 1.0], [0.2, 0.0, 1.0], [9.0, 9.0, 9.0]]])
        low, high = ends(slopes, np.array([[True, True, False]]))
        np.testing.assert_array_equal([low[0], high[0]], [[0.0, 0.0, 1.0], [0.2, 0.1, 1.0]])


if __name__ == "__main__":
    unittest.main()
