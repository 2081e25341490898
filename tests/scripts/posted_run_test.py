#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""fabseq-tools paths --post: pauses and speeds of a run, travels over what stands, and files for the cell."""

import csv
import json
import os
import shutil
import subprocess
import tempfile
import types
import unittest
from pathlib import Path

import numpy as np

from fabseq_tools.geometry.layer_bodies import LayeredPart
from fabseq_tools.paths.pace import pace_of
from fabseq_tools.paths.torch_paths import all_passes
from fabseq_tools.paths.travels import Tops, travels
from fabseq_tools.paths.ways import Standing
from fabseq_tools.run.progress import SILENT

from fake_results import element_centres, node_coordinates
from layered_results import write_layers
from program_readers import read_gcode, read_rapid, weld_speeds

PROJECT = Path(__file__).resolve().parents[2]
COUNTS, SIZE = (24, 10, 12), (48.0, 20.0, 24.0)  # elements of 2
LAYERS, WIDTH = 6, 4.0
CONFIG = {"domain": {"size": SIZE, "elements": COUNTS, "unit": "mm"}, "process": {"deposition_rate": 3.6, "dwell": 5.0},
          "material": {"mass_density": 8e-6}, "thermal": {"passes": 2, "interpass_limit": 150.0}}
PAUSES = [10.0, None, 12.0, 0.0, 4.0, 0.0]


class PostedRunTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.run_directory = os.path.join(folder.name, "run")

    def posts(self, **config):
        """Two posts, the left one built before the right one, up to 20 of 24."""
        x, _, z = element_centres(COUNTS, SIZE)
        built = ((x < 16) | (x > 32)) & (z < 20)

        def time(x, y, z):
            return (z + 0.0 * x) / 48.0 + np.where(x > 24, 0.5, 0.0)

        layer = np.where(built, np.clip(np.ceil(time(x, 0.0, z) * LAYERS - 1e-9), 1, LAYERS), 0.0)
        up = np.broadcast_to([0.0, 0.0, 1.0], (*built.shape, 3))
        write_layers(self.run_directory, SIZE, built, LAYERS, 1.0 - time(*node_coordinates(COUNTS, SIZE)), layer=layer,
                     local_thickness=np.where(built, 8.0, 0.0), build_direction=up, config={**CONFIG, **config},
                     summary={"interpass": {"pauses": PAUSES}})

    def exported(self, *words, status=0):
        done = subprocess.run(["/usr/bin/python3", PROJECT / "scripts/fabseq-tools", "paths", self.run_directory, "--bead-width",
                               str(WIDTH), "--no-picture", *words], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, status, done.stderr)
        return done

    def test_pace(self):
        """Of the deposition rate: 1 g/s of 0.008 g/mm3 is 125 mm3/s; of --speed; of neither. Pauses: of the
        report, times the real layers; of process.dwell; none."""
        part = types.SimpleNamespace(config=CONFIG, layers={number: None for number in range(1, 7)},
                                     judged=types.SimpleNamespace(block={"interpass": {"pauses": PAUSES}}))
        pace = pace_of(part, None, 1.0, 10.0)
        self.assertAlmostEqual(pace.speed, 12.5)
        np.testing.assert_allclose(pace.speeds(np.array([1.0, 2.0, 0.01])), [12.5, 6.25, 62.5])
        self.assertEqual(pace.pauses, {1: 20.0, 2: None, 3: 24.0, 4: 0.0, 5: 8.0, 6: 0.0})
        self.assertEqual(pace.known_pauses()[2], 24.0)
        self.assertAlmostEqual(pace_of(part, 7.0, 25.4, 10.0).speed, 7.0 / 25.4)
        part.config = {"thermal": {"interpass_limit": 150.0}}
        part.judged.block = {"interpass": {"pauses": [10.0, 4.0]}, "real_layers": {"passes": 3}}
        self.assertEqual(list(pace_of(part, None, 1.0, 10.0).pauses.values()), [10.0] * 3 + [4.0] * 3)
        part.config, part.judged.block = CONFIG, {}
        self.assertEqual(pace_of(part, None, 1.0, 10.0).pauses[2], 10.0)
        for passes, pause in ({"thermal": {"passes": "layers"}}, 5.0), ({"layers": {"passes": 3}}, 15.0):
            part.config = {"process": {"dwell": 5.0}, **passes}
            self.assertEqual(pace_of(part, None, 1.0, 10.0).pauses[2], pause)
        part.config = {"process": {"deposition_rate": "none"}}
        pace = pace_of(part, None, 1.0, 10.0)
        self.assertEqual((pace.speed, pace.pauses[2], pace.pauses_from), (10.0, 0.0, "none"))

    def test_travels(self):
        """They never run into what stands, and from post to post go above its top by the clearance."""
        self.posts()
        part = LayeredPart(self.run_directory)
        passes = all_passes(part, WIDTH, 1, 0.0, 0.0, 0.5)
        standing = Standing(part, passes)
        found = travels(standing, passes, 3.0, SILENT)
        self.assertEqual(len(found), len(passes) + 1)
        self.assertEqual([way.depth for way in found], [0.0] * len(found))
        jump = next(number for number, one in enumerate(passes) if one.points[:, 0].mean() > 24)
        self.assertGreaterEqual(found[jump].leaving[-1, 2], 20.0 + 3.0)
        self.assertAlmostEqual(found[jump].coming[0, 2], 20.0 + 3.0)
        start = passes[jump].points[0]
        np.testing.assert_allclose(found[jump].coming[-1], [*start[:2], 8.0 + 3.0], atol=0.1)  # above the bead to be
        self.assertAlmostEqual(found[jump + 1].coming[0, 2], 20.0 + 3.0)  # a new layer: above all, also what is far away
        self.assertEqual(len(found[0].coming), 1)  # above the plate
        self.assertEqual([len(found[0].leaving), len(found[-1].coming)], [0, 0])

    def test_travels_within_a_layer(self):
        """They rise where something stands near the way, and nowhere else."""
        self.posts()
        part = LayeredPart(self.run_directory)
        passes = all_passes(part, WIDTH, 1, 0.0, 0.0, 0.5)
        tops = Tops(Standing(part, passes))
        last = len(passes)
        for y, reach, top in ((10.0, 1.0, 20.0), (30.0, 5.0, 0.0), (30.0, 11.0, 20.0)):
            self.assertAlmostEqual(tops.between(last, np.array([-5.0, y, 7.0]), np.array([60.0, y, 3.0]), reach), top)
        self.assertAlmostEqual(tops.between(0, np.array([-5.0, 10.0, 7.0]), np.array([60.0, 10.0, 3.0]), 9.0), 0.0)

    def test_files(self):
        """Each point with the arc on is a row of paths.csv, in its layer's file, in either program."""
        self.posts()
        done = self.exported("--post", "gcode", "--post", "rapid", "--tolerance", "0.05")
        folder = Path(self.run_directory) / "paths"
        with open(folder / "paths.csv", encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
        record = json.loads((folder / "paths_summary.json").read_text())
        self.assertIn("layer 2: no pause keeps the interpass limit", done.stderr)
        self.assertIn("programs: gcode (7 files), rapid (9 files)", done.stdout)
        weld, travel = weld_speeds((folder / "rapid/fabseq_main.mod").read_text())
        for layer, pause in zip(record["layers"], (20.0, 24.0, 24.0, 0.0, 8.0, None)):
            number = layer["layer"]
            own = [row for row in rows if row["layer"] == str(number)]
            waypoints = np.array([[float(row[axis]) for axis in "xyz"] for row in own])
            gcode, _ = read_gcode((folder / f"gcode/O1{number:03d}.nc").read_text(), "AC")
            rapid, _ = read_rapid((folder / f"rapid/layer_{number:03d}.mod").read_text(), weld, travel)
            np.testing.assert_allclose(gcode.points, rapid.points, atol=1e-3)
            away = np.linalg.norm(gcode.points[gcode.arc][:, None] - waypoints, axis=2).min(axis=1)
            self.assertLess(away.max(), 1e-3)
            self.assertLess(np.abs(gcode.turns - [0, 0, 1]).max(), 1e-4)
            speeds = np.array([float(row["speed"]) for row in own])
            self.assertTrue((gcode.speeds[gcode.arc] > 0.99 * speeds.min()).all())
            self.assertTrue((gcode.speeds[gcode.arc] < 1.01 * speeds.max()).all())
            self.assertEqual(gcode.pauses, [pause] if pause else [])
            self.assertEqual([row["pause"] for row in own[:-1]], ["0"] * (len(own) - 1))
            self.assertEqual(own[-1]["pause"], "" if number == 2 else f"{2 * PAUSES[number - 1]:g}")
        self.assertAlmostEqual(record["programs"]["seconds"]["welding"] / (record["wire"] / 125.0), 1.0, delta=0.05)

    def test_a_file_of_measured_data_stays(self):
        """And files of another control go."""
        self.posts()
        folder = Path(self.run_directory) / "paths"
        self.exported("--post", "rapid", "--post", "gcode", "--control", "linuxcnc")
        (folder / "rapid/fabseq_data.mod").write_text("measured")
        (folder / "rapid/layer_099.mod").write_text("of an earlier run")
        self.exported("--post", "rapid", "--post", "gcode")
        self.assertEqual((folder / "rapid/fabseq_data.mod").read_text(), "measured")
        self.assertFalse((folder / "rapid/layer_099.mod").exists())
        self.assertEqual({path.suffix for path in (folder / "gcode").iterdir()}, {".nc"})

    def test_refusals(self):
        self.posts(domain={**CONFIG["domain"], "unit": "furlong"})
        done = self.exported("--post", "gcode", status=2)
        self.assertIn("domain.unit: found furlong; allowed for --post", done.stderr)
        self.assertFalse((Path(self.run_directory) / "paths").exists())
        self.assertIn("invalid choice: 'krl'", self.exported("--post", "krl", status=2).stderr)

    def test_a_new_post_is_one_module(self):
        """Its name, options and first line stand in the help, and its files are written."""
        self.posts()
        copy = Path(self.run_directory).parent / "scripts"
        shutil.copytree(PROJECT / "scripts/fabseq_tools", copy / "fabseq_tools",
                        ignore=shutil.ignore_patterns("__pycache__", "page"))
        shutil.copy(PROJECT / "scripts/fabseq-tools", copy)
        text = ('"""Counts layers."""\n\nPOST = "count"\nENDINGS, KEPT = (".txt",), ()\n\n\ndef add_options(group):\n'
                '    group.add_argument("--sign", default="#")\n\n\ndef program_files(program, options):\n'
                '    return {"count.txt": options.sign * len(program.layers)}\n')
        (copy / "fabseq_tools/paths/posts/count.py").write_text(text, encoding="utf-8")

        def called(*words):
            return subprocess.run(["/usr/bin/python3", copy / "fabseq-tools", "paths", *words], capture_output=True, text=True,
                                  check=True).stdout

        self.assertRegex(called("--help"), r"count:\s+Counts\s+layers")
        called(self.run_directory, "--bead-width", "4", "--no-picture", "--post", "count", "--sign", "+")
        self.assertEqual((Path(self.run_directory) / "paths/count/count.txt").read_text(), "+" * LAYERS)


if __name__ == "__main__":
    unittest.main()
