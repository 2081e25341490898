#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""fabseq-tools overview and render on made-up results."""

import json
import os
import subprocess
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import h5py
import matplotlib.pyplot as plt
import numpy as np

from fabseq_tools.geometry.node_sets import measured_nodes
from fabseq_tools.plot import overview, render_part
from fabseq_tools.run.command_line import RunError
from fabseq_tools.run.read_run import Run

import fake_results
from pictures import coloured, drawn, filled

PROJECT = Path(__file__).resolve().parents[2]


def run(command, *arguments, **environment):
    words = [PROJECT / "scripts/fabseq-tools", command, *map(str, arguments)]
    return subprocess.run(["/usr/bin/python3", *words], capture_output=True, text=True, env={**os.environ, **environment})


def overview_of(folder, name):
    """Draws a run and returns the picture's path."""
    picture = os.path.join(folder, name + ".png")
    done = run("overview", folder, picture)
    assert done.returncode == 0, done.stderr
    return picture


class Pictures(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.solid = Path(cls.folder.name) / "solid"
        cls.flat = Path(cls.folder.name) / "flat"
        fake_results.write_run(cls.solid, "v_shape", fake_results.v_shape_density((20, 10, 20)), (2.0, 1.0, 2.0))
        fake_results.write_run(cls.flat, "plate", np.ones((8, 12)), (3.0, 2.0))

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def assert_overview(self, picture):
        """Two pictures of layers in the upper half, small ones of distorted shapes and charts below."""
        self.assertGreater(min(coloured(picture, 0.15, 0.5, 2)), 0.08)
        self.assertGreater(min(filled(picture, 0.75, 0.9, 4)), 0.01)

    def test_overview_draws_solid_and_flat_parts(self):
        for directory in (self.solid, self.flat):
            done = run("overview", directory)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertNotIn("cannot be rendered", done.stderr)
            self.assert_overview(directory / "overview.png")

    def test_overview_of_a_simulation(self):
        for release in (True, False):
            with tempfile.TemporaryDirectory() as folder:
                fake_results.write_run(folder, "plate", np.ones((8, 12)), (3.0, 2.0))
                fake_results.add_checks(folder)
                fake_results.make_simulation(folder)
                if not release:
                    with h5py.File(os.path.join(folder, "result.h5"), "r+") as file:
                        del file["release_displacement"]
                    fake_results.change(folder, "summary.json", lambda summary: summary.pop("released"))
                done = run("overview", folder)
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertGreater(coloured(Path(folder) / "overview.png", 0.2, 0.5)[0], 0.08)
                self.assertGreater(min(filled(Path(folder) / "overview.png", 0.75, 0.9, 4 if release else 3)), 0.01)
                words = " ".join(overview.simulation_sentences(Run(folder, simulations=True)))
                self.assertIn("after the release: 0.01 mm root mean" if release else "There is no shape", words)
                self.assertIn("Residual stress, without plastic flow: up to 300, above the yield stress 250 in", words)

    def drawn_with(self, folder):
        """What is on the sheet, and the displacements of its shapes."""
        with mock.patch.object(overview, "draw_sheet") as sheet, mock.patch.object(overview, "Shapes") as shapes, \
                mock.patch.object(overview, "Layers"):
            shapes.return_value.largest_each = [0.1, 0.2]
            overview.draw_optimization(Run(folder), "none.png")
        return sheet.call_args.args[1], shapes.call_args.args[1]

    def test_the_shape_of_the_headline(self):
        """Released where the distortion is, if the file has that shape."""
        with tempfile.TemporaryDirectory() as folder:
            fake_results.write_run(folder, "plate", np.ones((8, 12)), (3.0, 2.0))
            fake_results.change(folder, "config.json", lambda config: config["objective"][0].update(after_release=True))
            content, built = self.drawn_with(folder)
            self.assertEqual([words for words, _ in content.labels],
                             ["planar layers: moved by up to 0.1", "optimized layers: moved by up to 0.2"])
            fake_results.add_checks(folder)  # its release takes half of the displacement away
            content, released = self.drawn_with(folder)
            self.assertEqual([words for words, _ in content.labels], ["planar layers, released: moved by up to 0.1 mm",
                                                                      "optimized layers, released: moved by up to 0.2 mm"])
            for whole, half in zip(built, released):
                np.testing.assert_allclose(half, 0.5 * whole)

    def test_nothing_to_gain(self):
        with tempfile.TemporaryDirectory() as folder:
            fake_results.write_run(folder, "plate", np.ones((8, 12)), (3.0, 2.0))
            for value, words in ((0.405, "distortion of the top edge about as large as with planar layers"),
                                 (0.82, "distortion of the top edge 1.4 times larger than with planar layers")):
                fake_results.change(folder, "summary.json", lambda s, v=value: s["binary"]["responses"][0].update(value=v))
                self.assertIn(words, self.drawn_with(folder)[0].title)

    def test_words_below_the_headline(self):
        with tempfile.TemporaryDirectory() as folder:
            fake_results.write_run(folder, "plate", np.ones((8, 12)), (3.0, 2.0))
            fake_results.add_checks(folder)
            distortion, _, stress = overview.sentences(Run(folder))
            self.assertIn("planar 0.64 mm, optimized 0.023 mm (with smooth layers 0.0212 mm)", distortion)
            self.assertIn("above the yield stress 250 in", stress)
            fake_results.add_torch(folder)
            words = " ".join(overview.sentences(Run(folder)))
            self.assertIn("% of the part is out of the torch's reach (by 0.4 mm near [1.5,1.5]).", words)
            self.assertIn("% of the part is tilted beyond the limit (33.3 of 30 degrees near [1,2]).", words)

    def test_without_xvfb_it_says_so(self):
        with tempfile.TemporaryDirectory() as empty:
            done = run("overview", self.solid, Path(empty) / "picture.png", PATH=empty, DISPLAY="")
            self.assertEqual(done.returncode, 1)
            self.assertIn("fabseq-tools overview: needs a display, or Xvfb", done.stderr)

    def test_a_directory_without_a_run_is_refused(self):
        with tempfile.TemporaryDirectory() as empty:
            done = run("overview", empty)
            self.assertEqual(done.returncode, 2)
            self.assertIn("config.json is missing", done.stderr)
            self.assertNotIn("Traceback", done.stderr)

    def test_layers_without_thickness_and_runs_without_constraints(self):
        with tempfile.TemporaryDirectory() as folder:
            fake_results.write_run(folder, "bare", np.ones((4, 4, 4)), (1.0, 1.0, 1.0))
            for name, change in (("config.json", lambda c: c.pop("constraints")),
                                 ("summary.json", lambda s: [s[b]["layers"][0].update(thickness=None, volume=0.0, cv=None)
                                                             for b in ("optimized", "binary")])):
                path = Path(folder) / name
                document = json.loads(path.read_text(encoding="utf-8"))
                change(document)
                path.write_text(json.dumps(document), encoding="utf-8")
            history = Path(folder) / "history.jsonl"
            lines = [json.loads(line) for line in history.read_text(encoding="utf-8").splitlines()]
            history.write_text("".join(json.dumps({**line, "worst_constraint": None}) + "\n" for line in lines), encoding="utf-8")
            with h5py.File(os.path.join(folder, "result.h5")) as file:
                used = len(np.unique(file["layer"][:]))
            done = run("overview", folder, "--table")
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertRegex(done.stdout, rf"layers used +\d+ +{used - 1} +{used - 1}\n")

    def test_render_part_draws_a_layer_picture(self):
        picture = Path(self.folder.name) / "part.png"
        done = subprocess.run(["/usr/bin/python3", PROJECT / "scripts/fabseq-tools", "render",
                               self.solid / "result.h5", picture, "--pixels", "400"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertGreater(coloured(picture)[0], 0.05)

    def test_render_part_draws_temperatures_with_a_bar(self):
        picture = Path(self.folder.name) / "warm.png"
        with tempfile.TemporaryDirectory() as folder:
            fake_results.write_run(folder, "v_shape", fake_results.v_shape_density((20, 10, 20)), (2.0, 1.0, 2.0))
            words = os.path.join(folder, "result.h5"), picture, "--pixels", 400, "--colour", "interpass_temperature"
            done = run("render", *words)
            self.assertEqual((done.returncode, done.stderr.count("\n")), (2, 1), done.stderr)
            self.assertIn("found no interpass_temperature, since the run's config has no block thermal", done.stderr)
            fake_results.add_temperatures(folder)
            for planar in ([], ["--planar"]):
                with self.subTest(planar=planar):
                    done = run("render", *words, *planar)
                    self.assertEqual(done.returncode, 0, done.stderr)
                    self.assertEqual(plt.imread(picture).shape[:2], (400, 400))
                    self.assertGreater(coloured(picture, columns=3)[0], 0.05)  # the part
                    self.assertGreater(drawn(picture, inner=(0.2, 0.8, 0.86, 1.0))[0], 0.05)  # the bar

    def test_colours_of_temperatures_reach_from_the_coldest_to_the_hottest_element(self):
        part = render_part.VoxelPart(np.array([[0.0, 1.0, 1.0, 1.0]]), (4.0, 1.0))
        colours, ends = render_part.colours_of(part, "interpass_temperature", np.array([[0.0, 300.0, 100.0, 200.0]]))
        self.assertEqual(ends, (100.0, 300.0))
        expected = plt.get_cmap(render_part.TEMPERATURE_COLOURS)([1.0, 0.0, 0.5])[:, :3]
        np.testing.assert_array_equal(colours["face_colours"], (255 * expected).astype(np.uint8))


class Surface(unittest.TestCase):
    def area_and_normals(self, part):
        corners = part.nodes[part.faces]
        vectors = np.cross(corners[:, 1] - corners[:, 0], corners[:, 3] - corners[:, 0])
        return np.linalg.norm(vectors, axis=1).sum(), vectors

    def test_closed_surface_with_outward_normals(self):
        part = render_part.VoxelPart(np.ones((2, 3, 4)), (4.0, 6.0, 1.0))
        area, vectors = self.area_and_normals(part)
        self.assertAlmostEqual(area, 2 * (4 * 6 + 4 * 1 + 6 * 1))
        np.testing.assert_allclose(vectors.sum(axis=0), 0, atol=1e-12)
        # Gauss: the flux of x through an outward surface is three times the volume.
        self.assertAlmostEqual((part.nodes[part.faces].mean(axis=1) * vectors).sum(), 3 * 24.0)

    def test_faces_carry_the_element_behind_them(self):
        density = np.zeros((2, 2, 2))
        density[1, 0, 1] = 1
        part = render_part.VoxelPart(density, (1.0, 1.0, 1.0))
        self.assertEqual(set(part.face_element), {5})
        self.assertEqual(len(part.faces), 6)


class Figures(unittest.TestCase):
    def test_table(self):
        with tempfile.TemporaryDirectory() as folder:
            fake_results.write_run(folder, "cube", np.ones((4, 4, 4)), (1.0, 1.0, 1.0), count=4, planar_count=4)
            rows = {line[:22].strip(): line[22:].split("  ") for line in overview.table(Run(folder)).splitlines()}
            cells = {name: [cell.strip() for cell in row if cell.strip()] for name, row in rows.items()}
            self.assertEqual(cells["distortion"], ["4.100e-01", "4.500e-04", "5.300e-04"])
            self.assertEqual(cells["length"], ["6.403e-01", "2.121e-02", "2.302e-02"])
            self.assertEqual(cells["planar / this"], ["1.0", "30", "28"])
            self.assertEqual(cells["thickness / target"][0], "1.00 .. 1.00")
            with h5py.File(os.path.join(folder, "result.h5")) as file:
                self.assertEqual(cells["layers used"][1], str(len(np.unique(file["layer"][:]))))

    def test_measured_nodes_are_those_of_the_program(self):
        """All sets are known but those that are too large to mark; results without them are refused."""
        with tempfile.TemporaryDirectory() as folder:
            fake_results.write_run(folder, "cube", np.ones((2, 2, 2)), (1.0, 1.0, 1.0))
            self.assertEqual(list(measured_nodes(Run(folder))), [18 + 2, 18 + 5, 18 + 8])
            polygon = {"polygon": {"axis": "y", "points": [[0, 0], [1, 0], [1, 1]]}}
            for name, node_set, expected in (("flank", polygon, [3, 5]), ("skin", {"all": True}, [])):
                def rename(config, name=name, node_set=node_set):
                    config["node_sets"] = {name: node_set}
                    config["objective"][0]["nodes"] = name

                fake_results.change(folder, "config.json", rename)
                if expected:
                    with self.assertRaisesRegex(RunError, "lacks the dataset model/node_sets/.*; repeat the run"):
                        measured_nodes(Run(folder))
                    with h5py.File(os.path.join(folder, "result.h5"), "r+") as file:
                        file["model/node_sets/" + name] = expected
                self.assertEqual(list(measured_nodes(Run(folder))), expected)
            with h5py.File(os.path.join(folder, "result.h5"), "r+") as file:
                del file["model"]
            fake_results.change(folder, "config.json", lambda config: config.update(node_sets={"skin": polygon}))
            done = run("overview", folder)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn("warning: result.h5: lacks the dataset model/node_sets/skin; repeat", done.stderr)


if __name__ == "__main__":
    unittest.main()
