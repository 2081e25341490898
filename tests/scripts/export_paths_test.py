#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""fabseq-tools paths and import-paths on parts whose paths have known lengths."""

import csv
import json
import math
import os
import subprocess
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import h5py
import numpy as np

from fabseq_tools.geometry.layer_bodies import LayeredPart
from fabseq_tools.paths import import_paths, order as path_order
from fabseq_tools.paths.pace import USUAL_SPEED, travel_speed
from fabseq_tools.paths.layer_paths import Line, PathSurface
from fabseq_tools.paths.torch_paths import all_passes, summary
from fabseq_tools.run.command_line import RunError

from fake_results import element_centres, node_coordinates
from layered_results import write_layers
from small_meshes import box_triangles
from three_mf_files import mesh_text, write_three_mf

PROJECT = Path(__file__).resolve().parents[2]

UP = np.array([0.0, 0.0, 1.0])
TOOLS = PROJECT / "scripts/fabseq-tools"


class PathsTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.run_directory = os.path.join(folder.name, "run")

    def box(self, count=2, config=None):
        """2 x 1 x 0.2 in planar layers."""
        counts, size = (20, 10, 4), (2.0, 1.0, 0.2)
        height = node_coordinates(counts, size)[2] / size[2]
        z = element_centres(counts, size)[2]
        return write_layers(self.run_directory, size, np.ones(counts[::-1], bool), count, 1.0 - height, config=config,
                            layer=np.ceil(z / size[2] * count - 1e-9))

    def test_outline_and_hatch_of_a_box(self):
        """With a bead of 0.1: an outline of 1.9 x 0.9, and eight lines of 1.8, or eighteen of 0.8 across, in
        one pass, with ways of a bead's width between them."""
        part = LayeredPart(self.box())
        for outlines, angle, expected in ((1, 0.0, 5.6 + 8 * 1.9), (1, 90.0, 5.6 + 18 * 0.9), (2, 0.0, 5.6 + 4.9 + 6 * 1.7)):
            passes = all_passes(part, 0.1, outlines, angle, 0.0, 0.5)
            rows = summary(part, passes, UP)
            self.assertEqual([row["starts"] for row in rows], [1] * 2)
            for row in rows:
                links = sum(one.lengths()[one.kinds == "link"].sum() for one in passes if one.layer == row["layer"])
                self.assertAlmostEqual(row["length"] / expected, 1.0, delta=0.03)  # corners are cut
                self.assertLess(links, 0.1 * expected)
                self.assertAlmostEqual(row["wire"] / 0.2, 1.0, delta=0.01)
                self.assertAlmostEqual(row["angle"][1], 0.0, delta=1e-4)
                self.assertEqual(row["missed"], 0.0)
                self.assertLess(row["farthest"], 0.1)
        first = passes[0]
        np.testing.assert_allclose(first.points[:, 2], 0.05, atol=5e-3)
        inner = (first.kinds == "hatch") & np.all(np.abs(first.points[:, :2] - (1.0, 0.5)) < (0.5, 0.15), axis=1)
        np.testing.assert_allclose(first.heights[inner], 0.1, rtol=0.05)  # volume is counted in random places
        self.assertAlmostEqual(first.heights[inner].mean(), 0.1, delta=5e-4)
        self.assertAlmostEqual(first.spacings[inner].mean(), 0.1, delta=0.01)

    def test_an_area_that_no_bead_reaches(self):
        part = LayeredPart(self.box())
        lines = PathSurface.lines
        with mock.patch.object(PathSurface, "lines", lambda *words: lines(*words)[:1]):
            rows = summary(part, all_passes(part, 0.1, 1, 0.0, 0.0, 0.5), UP)
        for row in rows:  # the outline alone, which lies half a bead inside: all but 1.5 beads at the sides
            self.assertAlmostEqual(row["missed"], 1.7 * 0.7 / 2.0, delta=0.01)
            self.assertAlmostEqual(row["farthest"], 0.45, delta=0.03)

    def test_height_of_the_waypoints(self):
        part = LayeredPart(self.box())
        for at, level in ((0.0, 0.0), (1.0, 0.1)):
            first = all_passes(part, 0.1, 1, 0.0, 0.0, at)[0]
            np.testing.assert_allclose(first.points[:, 2], level, atol=5e-3)

    def test_layers_of_a_ball(self):
        """Axes point away from the centre, and the wire is the part's volume."""
        counts, size = (16, 16, 16), (1.0, 1.0, 1.0)
        radius = np.sqrt(sum(x**2 for x in node_coordinates(counts, size)))
        built = np.sqrt(sum(x**2 for x in element_centres(counts, size))) < 1.0
        part = LayeredPart(write_layers(self.run_directory, size, built, 4, 1.0 - np.minimum(radius, 1.2) / 1.2))
        passes = all_passes(part, 0.1, 1, 0.0, 90.0, 0.5)
        points, axes = (np.concatenate([getattr(one, name) for one in passes if one.layer > 1]) for name in ("points", "axes"))
        outward = points / np.linalg.norm(points, axis=1)[:, None]
        self.assertGreater(np.quantile(np.einsum("ni,ni->n", axes, outward), 0.05), math.cos(math.radians(8)))
        for row in summary(part, passes, UP):  # those that hold a bead
            self.assertAlmostEqual(row["wire"] / row["volume"], 1.0, delta=0.02, msg=row["layer"])

    def test_order(self):
        """A zigzag is found from lines in any order; of closed lines any point may be the first."""
        lines = [Line(np.array([[0.0, y, 0], [5.0, y, 0]]), "hatch") for y in range(10)]
        random = np.random.default_rng(4)
        found = path_order.ordered([lines[k] for k in random.permutation(10)], np.zeros(3), 1.5)
        gaps = [path_order.gap(a.points[-1], b.points[0]) for a, b in zip(found, found[1:])]
        self.assertEqual(gaps, [1.0] * 9)
        self.assertEqual(len(path_order.passes(found, 1.5, lambda a, b: True)), 1)
        self.assertEqual(len(path_order.passes(found, 0.5, lambda a, b: True)), 10)
        ring = Line(np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 0]]), "outline", True)
        np.testing.assert_array_equal(path_order.ordered([ring], np.array([2.0, 2, 0]), 1.0)[0].points[[0, -1]], [[1, 1, 0]] * 2)

    def call(self, command, *arguments):
        return subprocess.run(["/usr/bin/python3", TOOLS, command, *arguments], capture_output=True, text=True, check=False)

    def test_files_and_the_way_back(self):
        """Files of a part that its mesh file has in inches and lying, and the sequence read from them."""
        matrix = 25.4 * np.array([[0, 1, 0, 0], [0, 0, 1, 0], [1, 0, 0, 0]], float)
        counts, size = (20, 10, 8), (50.8, 25.4, 10.16)
        config = {"domain": {"size": size, "elements": counts, "unit": "mm"}, "tool": {"bead_width": 3.0},
                  "run": {"mesh_placement": matrix.tolist()}}
        height = node_coordinates(counts, size)[2] / size[2]
        number = np.ceil(element_centres(counts, size)[2] / size[2] * 4 - 1e-9)
        write_layers(self.run_directory, size, np.ones(counts[::-1], bool), 4, 1.0 - height, config=config, layer=number)
        done = self.call("paths", self.run_directory, "--no-picture", "--turn", "0")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("4 starts", done.stdout)
        folder = Path(self.run_directory) / "paths"
        with open(folder / "paths.csv", encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
        first = {name: float(rows[0][name]) for name in ("x", "y", "z", "axis_x", "axis_y", "axis_z", "height")}
        self.assertAlmostEqual(first["x"], 0.05, delta=5e-3)  # up in the config is x in the file, 0.1 a layer
        np.testing.assert_allclose([first["axis_x"], first["axis_y"], first["axis_z"]], [1, 0, 0], atol=1e-6)
        self.assertLess(max(float(row["z"]) for row in rows), 1.0)
        record = json.loads((folder / "paths.json").read_text())
        self.assertEqual((len(record["waypoints"]), record["unit"], record["frame"]), (len(rows), "in", "drawing"))
        self.check_programs(folder, rows)
        of_programs = [(name, 0.999) for name in ("paths_compas.json", "paths_irbcam.csv", "paths_irbcam.json")]
        for table, least in (("paths.csv", 0.999), ("paths.json", 0.999), *of_programs, ("plain.csv", 0.99)):
            if table == "plain.csv":  # position and layer are enough
                (folder / table).write_text("x,y,z,layer\n" + "".join(
                    f"{row['x']},{row['y']},{row['z']},{10 * int(row['layer'])}\n" for row in rows), encoding="utf-8")
            done = self.call("import-paths", folder / table, self.run_directory)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn('"count": 4', done.stdout)
            with h5py.File(folder / (table.rpartition(".")[0] + "_sequence.h5")) as file:
                self.assertGreaterEqual((file["layer"][()] == number).mean(), least)
                np.testing.assert_array_equal(np.ceil(file["time"][()] * 4), file["layer"][()])
        (folder / "alone.csv").write_bytes((folder / "paths_irbcam.csv").read_bytes())
        done = self.call("import-paths", folder / "alone.csv", self.run_directory)
        self.assertIn("alone_sequence.h5: an order without layers", done.stdout)

    def drawn(self, scale, unit):
        """The run of a box that its mesh file has lying and `scale` times smaller than the config, in which
        it is 40 x 20 x 8 and not at the origin."""
        matrix = np.column_stack([scale * np.array([[0, 1, 0], [0, 0, 1], [1, 0, 0]], float), [7.0, -30.0, 0.0]])
        counts, size = (20, 10, 8), (40.0, 20.0, 8.0)
        drawing = os.path.join(os.path.dirname(self.run_directory), "box.3mf")
        box = np.array(list(box_triangles((0, 0, 0), np.array([8.0, 40.0, 20.0]) / scale)))
        write_three_mf(drawing, f'<object id="1">{mesh_text(box)}</object>', '<item objectid="1"/>')
        config = {"domain": {"size": size, "elements": counts, "origin": [7, -30, 0], **({"unit": unit} if unit else {})},
                  "part": {"mesh": {"file": drawing}}, "run": {"mesh_placement": matrix.tolist()}}
        height = node_coordinates(counts, size)[2] / size[2]
        number = np.ceil(element_centres(counts, size)[2] / size[2] * 2 - 1e-9)
        write_layers(self.run_directory, size, np.ones(counts[::-1], bool), 2, 1.0 - height, config=config, layer=number)
        return matrix, number

    def exported(self, frame):
        """Positions of waypoints and of IRBCAM's targets at them, axes, and the JSON files."""
        folder = Path(self.run_directory) / frame
        done = self.call("paths", self.run_directory, "--no-picture", "--bead-width", "4", "--frame", frame, "--output",
                         folder)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        files = {name: json.loads((folder / f"{name}.json").read_text())
                 for name in ("paths", "paths_summary", "paths_compas", "paths_irbcam")}
        with open(folder / "paths_irbcam.csv", encoding="utf-8", newline="") as file:
            targets = [row for row in csv.DictReader(file)]
        kept = np.array([row["velocity"] != "-1" for row in targets])
        found = files["paths_irbcam"]["targets"]
        np.testing.assert_allclose([found["p" + axis.upper()] for axis in "xyz"],
                                   [[float(row[axis]) for row in targets] for axis in "xyz"], atol=1e-5)
        waypoints = np.array([row[4:] for row in files["paths"]["waypoints"]])
        position = np.array([[float(row[axis]) for axis in "xyz"] for row in targets])
        self.assertAlmostEqual(np.linalg.norm(position[0] - position[1]) / (8 * self.millimetres), 1.0, places=5)  # two beads
        return waypoints[:, :3], position[kept], waypoints[:, 3:6], files, done.stdout

    def test_units_and_frames(self):
        """A part drawn in metres and one in inches, turned: IRBCAM's files are in millimetres of the placed
        part, all others in the unit that they name, and either way back leads to the layers."""
        for scale, unit, drawn_in, self.millimetres in (
                (1000.0, "mm", "m", 1.0), (25.4, "mm", "in", 1.0), (1.0, "in", "in", 25.4), (1e-3, "m", "mm", 1000.0),
                (1000.0, None, None, 1.0), (1.03, "mm", None, 1.0)):
            matrix, number = self.drawn(scale, unit)
            drawing, plate = self.exported("drawing"), self.exported("plate")
            np.testing.assert_allclose(plate[0], drawing[0] @ matrix[:, :3].T + matrix[:, 3], atol=1e-4)
            np.testing.assert_allclose(plate[2], drawing[2] @ matrix[:, :3].T / scale, atol=1e-6)
            for end, expected in ((np.min, [9, -28, 2]), (np.max, [45, -12, 6])):
                np.testing.assert_allclose(end(plate[0], axis=0), expected, atol=0.1)
            np.testing.assert_allclose(plate[1], self.millimetres * plate[0], rtol=1e-6, atol=1e-4)
            np.testing.assert_allclose(drawing[1], self.millimetres * scale * drawing[0], rtol=1e-6, atol=1e-4)
            for frame, lengths_in, system, (*_, files, printed) in (("drawing", drawn_in, "those of box.3mf", drawing),
                                                                    ("plate", unit, "those of the config", plate)):
                self.check_facts(files, lengths_in, frame, system)
                self.assertIn(f"coordinates: {system} (frame: {frame})" + (f" in {lengths_in}" if lengths_in else ""), printed)
                self.assertEqual("takes the config's lengths as millimetres" in printed, unit is None)
                factor = 1.0 if frame == "plate" else 1.0 / scale
                self.assertAlmostEqual(files["paths_summary"]["bead_width"], 4 * factor)
                self.assertAlmostEqual(files["paths_summary"]["volume"] / (6400 * factor**3), 1.0, places=6)
                for name in ("paths.csv", "paths.json") if drawn_in in ("m", "in") and unit == "mm" else ():
                    self.assert_way_back(Path(self.run_directory) / frame / name, number)

    def check_facts(self, files, unit, frame, system):
        facts = {"unit": unit, "frame": frame, "coordinates": system}
        told = [(files["paths"], facts), (files["paths_summary"], facts), (files["paths_irbcam"], facts | {"unit": "mm"}),
                *((point["attributes"], facts) for point in files["paths_compas"].values())]
        for content, expected in told:
            self.assertEqual({key: content[key] for key in expected}, expected)

    def assert_way_back(self, path, number, *options):
        done = self.call("import-paths", path, self.run_directory, *options)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        with h5py.File(str(path).rpartition(".")[0] + "_sequence.h5") as file:
            self.assertGreaterEqual((file["layer"][()] == number).mean(), 0.99)

    def test_frame_of_a_table(self):
        """The option comes first, then the JSON file beside the table, then the drawing. What lies elsewhere
        than the part is refused."""
        self.millimetres = 1.0
        _, number = self.drawn(1000.0, "mm")
        self.exported("plate")
        folder = Path(self.run_directory) / "plate"
        alone = folder / "alone.csv"
        alone.write_bytes((folder / "paths.csv").read_bytes())
        self.assert_way_back(alone, number, "--frame", "plate")
        for options in ((), ("--frame", "drawing")):
            done = self.call("import-paths", alone, self.run_directory, *options)
            self.assertEqual(done.returncode, 2)
            self.assertIn("waypoints lie outside of the config's box, which goes from [7,-30,0] to [47,-10,8]", done.stderr)
            self.assertEqual(len(done.stderr.splitlines()), 1)
        (folder / "alone.json").write_text('{"another": "file"}')
        self.assertIn("lie outside", self.call("import-paths", alone, self.run_directory).stderr)
        done = self.call("import-paths", folder / "alone.json", self.run_directory)
        self.assertIn("has no columns and waypoints; allowed", done.stderr)

    def test_a_unit_that_nobody_knows(self):
        """IRBCAM wants millimetres: no file is better than one in furlongs."""
        self.drawn(1.0, "furlong")
        done = self.call("paths", self.run_directory, "--no-picture", "--bead-width", "4")
        self.assertEqual(done.returncode, 0)
        self.assertIn("warning: domain.unit: found furlong; allowed for paths_irbcam", done.stderr)
        names = {path.name for path in (Path(self.run_directory) / "paths").iterdir()}
        self.assertEqual(names, {"paths.csv", "paths.json", "paths_compas.json", "paths_summary.json"})

    def test_an_order_and_layers_that_are_counted(self):
        """A simulation of a file does not look at the constraint that counts layers."""
        folder = Path(self.box(config={"layers": {"type": "curved", "count": "auto"}}))
        table = folder / "order.csv"
        table.write_text("x,y,z,order\n0.5,0.5,0.05,1\n1.5,0.5,0.15,2\n", encoding="utf-8")
        self.assertIn("order_sequence.h5 -layers 2 -binary", self.call("import-paths", table, folder).stdout)
        (folder / "summary.json").unlink()
        self.assertIn("order_sequence.h5 -layers NUMBER -binary", self.call("import-paths", table, folder).stdout)

    def check_programs(self, folder, rows):
        """Print points of COMPAS Slicer, and targets of IRBCAM."""
        points = json.loads((folder / "paths_compas.json").read_text())
        self.assertEqual(list(points), [str(k) for k in range(len(rows))])
        self.assertEqual(sum(not point["extruder_toggle"] for point in points.values()), 4)
        frame = points["3"]["frame"]
        np.testing.assert_allclose(np.cross(frame["xaxis"], frame["yaxis"]), [-1, 0, 0], atol=1e-6)  # the tool's way
        with open(folder / "paths_irbcam.csv", encoding="utf-8", newline="") as file:
            targets = list(csv.DictReader(file))
        self.assertEqual(len(targets), len(rows) + 8)
        self.assertEqual([k for k, row in enumerate(targets) if row["velocity"] == "-1"][0], 0)
        rz1, ry = (math.radians(float(targets[5][name])) for name in ("rz1", "ry"))
        tool = [math.cos(rz1) * math.sin(ry), math.sin(rz1) * math.sin(ry), math.cos(ry)]
        np.testing.assert_allclose(tool, [-1, 0, 0], atol=1e-6)
        in_radians = json.loads((folder / "paths_irbcam.json").read_text())["targets"]
        self.assertAlmostEqual(in_radians["rY"][5], ry, places=6)

    def test_refusals(self):
        self.box()
        for options, words in ((["--bead-width", "0.001"], "--bead-width: found 0.001; allowed: 0.0125 to 2"),
                               (["--bead-width", "0.1", "--outlines", "0"],
                                "--outlines: found 0; allowed: an integer from 1 to 100")):
            done = self.call("paths", self.run_directory, "--no-picture", *options)
            self.assertEqual((done.returncode, words in done.stderr), (2, True), done.stderr)
        table = Path(self.run_directory) / "table.csv"
        for text, words in (("x,y,z\n0,0,0\n", "neither a column layer nor order"), ("x,y,layer\n0,0,1\n", "names no column z"),
                            ("x,y,z,layer\n0,0,a,1\n", "line 2, column z: found 'a'; allowed: a finite number")):
            table.write_text(text, encoding="utf-8")
            done = self.call("import-paths", table, self.run_directory)
            self.assertEqual((done.returncode, words in done.stderr), (2, True), done.stderr)
        with self.assertRaisesRegex(RunError, "allowed: the config.json of a run"):
            import_paths.checked_config({"domain": {"element": 5}, "part": {"mesh": {}}}, "part.json")

    def test_picture(self):
        done = self.call("paths", self.box(), "--bead-width", "0.2")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertGreater((Path(self.run_directory) / "paths" / "paths.png").stat().st_size, 10_000)

    def test_speed_of_the_machine(self):
        """In mm/s, whatever the unit of the part."""
        for unit, speed, expected in (("mm", 9.0, 9.0), ("cm", 0.5, 5.0), (None, 7, 7), ("mm", "none", USUAL_SPEED),
                                      ("ell", 2.0, USUAL_SPEED)):
            domain = {} if unit is None else {"unit": unit}
            self.assertEqual(travel_speed({"domain": domain, "tool": {"travel_speed": speed}}), expected)
        self.assertEqual(travel_speed({"domain": {}}), USUAL_SPEED)


if __name__ == "__main__":
    unittest.main()
