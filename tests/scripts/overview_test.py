#!/usr/bin/python3
"""scripts/overview.py, render_part.py and summarize.py on made-up results."""

import json
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import h5py
import numpy as np
from matplotlib import image

PROJECT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(PROJECT / "scripts"))
sys.path.insert(0, str(Path(__file__).parent))
import fake_results
import render_part
import summarize


def run(script, *arguments, **environment):
    return subprocess.run(["/usr/bin/python3", PROJECT / "scripts" / script, *map(str, arguments)], capture_output=True,
                          text=True, env={**os.environ, **environment})


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

    def colours_of(self, picture):
        """Share of the picture's upper half that is clearly coloured."""
        pixels = image.imread(picture)[..., :3]
        upper = pixels[: len(pixels) // 2]
        return float((upper.max(axis=-1) - upper.min(axis=-1) > 0.25).mean())

    def test_overview_draws_solid_and_flat_parts(self):
        for directory in (self.solid, self.flat):
            done = run("overview.py", directory)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertNotIn("cannot be rendered", done.stderr)
            self.assertGreater(self.colours_of(directory / "overview.png"), 0.08)

    def test_without_xvfb_it_says_so_and_draws_the_charts(self):
        with tempfile.TemporaryDirectory() as empty:
            picture = Path(empty) / "charts.png"
            done = run("overview.py", self.solid, "--picture", picture, PATH=empty)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn("cannot be rendered (xvfb-run is not installed", done.stderr)
            self.assertTrue(picture.is_file())

    def test_a_directory_without_a_run_is_refused(self):
        with tempfile.TemporaryDirectory() as empty:
            for script in ("overview.py", "summarize.py"):
                done = run(script, empty)
                self.assertEqual(done.returncode, 1)
                self.assertIn("summary.json is missing", done.stderr)
                self.assertNotIn("Traceback", done.stderr)

    def test_layers_without_thickness_and_runs_without_constraints(self):
        with tempfile.TemporaryDirectory() as folder:
            fake_results.write_run(folder, "bare", np.ones((4, 4, 4)), (1.0, 1.0, 1.0))
            for name, change in (("config.json", lambda c: c.pop("constraints")),
                                 ("summary.json", lambda s: s["optimized"]["layers"][2].update(thickness=None, volume=0.0))):
                path = Path(folder) / name
                document = json.loads(path.read_text(encoding="utf-8"))
                change(document)
                path.write_text(json.dumps(document), encoding="utf-8")
            history = Path(folder) / "history.jsonl"
            lines = [json.loads(line) for line in history.read_text(encoding="utf-8").splitlines()]
            history.write_text("".join(json.dumps({**line, "worst_constraint": None}) + "\n" for line in lines), encoding="utf-8")
            done = run("overview.py", folder, "--charts-only")
            self.assertEqual(done.returncode, 0, done.stderr)
            table = run("summarize.py", folder)
            self.assertEqual(table.returncode, 0, table.stderr)
            self.assertIn("11 of 12", table.stdout)

    def test_render_part_draws_a_layer_picture(self):
        picture = Path(self.folder.name) / "part.png"
        done = subprocess.run(["xvfb-run", "-a", "/usr/bin/python3", PROJECT / "scripts/render_part.py",
                               self.solid / "result.h5", picture, "--pixels", "400"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertGreater(self.colours_of(picture), 0.05)


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


class Table(unittest.TestCase):
    def test_values(self):
        with tempfile.TemporaryDirectory() as folder:
            fake_results.write_run(folder, "cube", np.ones((4, 4, 4)), (1.0, 1.0, 1.0), count=4, planar_count=4)
            summary, config = summarize.read(folder, "summary.json"), summarize.read(folder, "config.json")
            rows = {row[0].strip(): row[1:] for row in summarize.table(summary, config)}
            self.assertEqual(rows["distortion"][0], "4.100e-01")
            self.assertEqual(rows["planar / this"], ["1.0", "911.1", "773.6"])
            self.assertEqual(rows["layer thickness / target"][0], "1.000 – 1.000")
            with h5py.File(os.path.join(folder, "result.h5")) as file:
                self.assertEqual(rows["layers used"][1], f"{len(np.unique(file['layer'][:]))} of 4")


if __name__ == "__main__":
    unittest.main()
