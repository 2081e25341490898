#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""fabseq-tools report on made-up results: what its page says."""

import hashlib
import json
import shutil
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import h5py
import numpy as np

from fabseq_tools.report import report as report_page
from fabseq_tools.report import views as report_views
from fabseq_tools.report.report import ReportRun
from fabseq_tools.run.command_line import RunError

import fake_results
from report_case import BLOCKS, MODELS, PROJECT, Page, Report, report, write_run
from run_fabseq import Runner


class Contents(Report):
    def test_it_loads_nothing(self):
        self.assertEqual(self.page.loads, [])
        self.assertIn("default-src 'none'", self.page.source)
        for words in ("@import", "url(", "XMLHttpRequest(", "importScripts"):
            self.assertNotIn(words, self.page.source.split("<script")[0], words)

    def test_figures_are_those_of_the_summary(self):
        header = [text for text, _ in self.page.tables["results"][0]]
        self.assertEqual(header, ["", *BLOCKS, "planar / binary", "start / binary"])
        for model, heading in zip(MODELS, ("Nominal deposition", "Deposition that follows")):
            rows = self.page.rows_after("results", heading)
            told = [self.summary[block]["deposition"][model] for block in BLOCKS.values()]
            lengths = [figures["distortion"][0]["length"] for figures in told]
            self.assertEqual(rows["root of the sum of squared displacements of top edge"],
                             [*lengths, *(lengths[k] / lengths[4] for k in (1, 0))])
            for what, words in (("nodes", "the objective's nodes"), ("displacement", "the whole part")):
                for key, kind in (("rms", "rms"), ("max", "largest")):
                    self.assertEqual(rows[f"{kind} displacement of {words}"][:5], [figures[what][key] for figures in told])
        layers = self.page.rows_after("results", "Layers")
        thickness = [layer["thickness"] for layer in self.summary["binary"]["layers"]]
        self.assertEqual([layers[f"{word} layer"][4] for word in ("thinnest", "thickest")], [min(thickness), max(thickness)])

    def test_what_a_machine_can_do(self):
        """Order of the columns: start, planar, planar with other layers, smooth, binary."""
        layers, building, stress = (self.page.rows_after("results", name)
                                    for name in ("Layers", "Building", "Residual stress"))
        self.assertEqual(layers["local thickness, largest"][:5], [0.1] * 5)
        self.assertEqual(layers["local thickness outside 0.0833 to 0.25, share of the part"][:5], [0.25] * 5)
        self.assertEqual(building["elements that begin in the air"][:5], [0, 6, 6, 0, 0])
        self.assertEqual(building["build time, hours"][1], 1.5)
        self.assertEqual(stress["share of the part above the yield stress 250"][1], 0.125)
        self.assertIn("Residual stress, without plastic flow: up to 300, above the yield stress 250 in 3.12 % of the part.",
                      self.page.text)

    def test_torch(self):
        """Reach and tilt in the table, in sentences and below the views; no word where there is no torch."""
        rows, found = self.page.rows_after("results", "Torch"), self.summary["binary"]["checks"]
        self.assertEqual(rows["elements out of its reach"][:5], [0, 0, 0, 4, 4])
        self.assertEqual(rows["deepest collision"][4], 0.4)
        self.assertEqual(rows["their share of the part"][4], found["blocked"]["share"])
        self.assertEqual(rows["largest tilt, degrees"][4], found["tilt"]["largest"])
        self.assertEqual(rows["tilted by more than 30 degrees, share of the part"][4], found["tilt"]["share"])
        self.assertGreater(found["tilt"]["share"], 0)
        for sentences in (self.summary["binary"]["words"][check] for check in ("blocked", "tilt")):
            self.assertIn(f"{sentences[0]}.", self.page.text)
        views = json.loads(self.page.source.split('type="application/json">')[1].split("</script>")[0])["scene"]["views"]
        self.assertEqual([view["notes"]["blocked"].split()[0] for view in views], ["0", "0", "4"])
        self.assertEqual(views[2]["notes"]["tilt"], "up to 33.3 degrees")
        self.assertEqual(views[2]["notes"]["local_thickness"], "0.1 mm")
        self.assertEqual([view["ranges"]["blocked"][1] for view in views], [0.0, 0.0, 0.4])
        self.assertNotIn("torch", Page(self.flat / "report.html").text)

    def test_headline_is_a_ratio_of_lengths_of_binary_layers(self):
        self.assertIn("The top edge moves 2.0 times less than in planar layers, 4.0 times less than the unoptimized start "
                      "(binary layers, nominal deposition).", self.page.text)
        self.assertIn("Under the worst of the changes that were tried, 5.0 times less than in planar layers (void quiet).",
                      self.page.text)

    def test_sensitivity(self):
        rows = self.page.tables["sensitivity-table"]
        self.assertEqual([title for _, title in rows[2][1:]], ["0.5", "0.1", "5.0", "1.5"])
        self.assertEqual(rows[3][1][0], "left out: the part is <too> large")

    def test_torch_paths(self):
        layer = {"layer": 1, "starts": 2, "waypoints": 9, "length": 31.5, "travel": 4.25, "height": [0.5, 1.25],
                 "angle": [0.0, 31.0], "feed": [0.9, 1.1], "wire": 19.9, "volume": 20.0, "missed": 0.03}
        other = {**layer, "layer": 2, "starts": 3, "height": [0.25, 1.0], "angle": [2.0, 47.0]}
        record = {"of": "optimized", "unit": "mm", "bead_width": 2.0, "starts": 5, "waypoints": 18, "length": 63.0, "travel": 8.5,
                  "wire": 39.8, "volume": 40.0, "layers": [layer, other], "verdict": {"words": "buildable but for <two> places"},
                  "ways": {"count": 4, "crossing": [{}]}}
        self.assertNotIn("Torch paths", self.page.text)
        with tempfile.TemporaryDirectory() as folder:
            shutil.copytree(self.flat, folder, dirs_exist_ok=True)
            (Path(folder) / "paths").mkdir()
            (Path(folder) / "paths/paths_summary.json").write_text(json.dumps(record), encoding="utf-8")
            self.assertEqual(report(folder).returncode, 0)
            page = Page(Path(folder) / "report.html")
        rows = [[text for text, _ in row] for row in page.tables["paths"]]
        self.assertIn("Buildable but for <two> places. 1 of 4 straight rapid ways between passes cross what stands.",
                      page.text)
        self.assertEqual(rows[0][:4], ["", "starts", "length, mm", "travel, mm"])
        self.assertEqual(rows[1][:4], ["all layers", "5", "63.0", "8.50"])
        self.assertEqual(rows[1][4:], ["0.250 to 1.25", "0 to 47.0", "0.900 to 1.10", "0.995", "–"])
        self.assertEqual([rows[3][k] for k in (0, 1, 4, 5, 8)], ["layer 2", "3", "0.250 to 1.00", "2.00 to 47.0", "3.00"])

    def test_page_of_a_hundred_thousand_triangles_is_small(self):
        with tempfile.TemporaryDirectory() as folder:
            write_run(Path(folder), np.ones((91, 91, 91)), (1.0, 1.0, 1.0), noise=1e-2)
            self.assertEqual(report(folder).returncode, 0)
            page = Page(Path(folder) / "report.html")
            self.assertLess(len(page.source.encode()), 5e6)
            self.assertIn("coarser grid", page.text)

    def test_comparison(self):
        done = report(self.solid, self.flat)
        self.assertEqual(done.returncode, 0, done.stderr)
        page = Page(self.solid / "report_compare.html")
        header = [text for text, _ in page.tables["results"][0]]
        self.assertEqual(header, ["", "solid", "flat"])
        lengths = page.rows_after("results", "Nominal deposition")["first distortion term, length"]
        self.assertEqual(lengths, [self.summary["binary"]["deposition"]["nominal"]["distortion"][0]["length"], None])
        self.assertEqual(report(self.solid, self.flat, "-o", self.flat / "both.html").stdout, f"{self.flat}/both.html\n")

    def test_runs_without_a_result(self):
        with tempfile.TemporaryDirectory() as folder:
            run = Path(folder)
            fake_results.write_run(run, "arm", np.ones((4, 4, 4)), (1.0, 1.0, 1.0))
            (run / "result.h5").unlink()
            fake_results.change(run, "summary.json", lambda summary: (summary.pop("optimized"), summary.pop("binary"),
                                                                      summary.update(status="stopped")))
            self.assertEqual(report(run).returncode, 0)
            self.assertIn("Arm: stopped.", Page(run / "report.html").text)
            (run / "summary.json").unlink()
            self.assertEqual(report(run).returncode, 0)
            self.assertIn("going on or interrupted", Page(run / "report.html").text)
            done = report(run / "nothing")
            self.assertEqual((done.returncode, done.stderr.count("\n")), (2, 1))
            self.assertIn("config.json is missing", done.stderr)

    def test_simulation(self):
        with tempfile.TemporaryDirectory() as folder:
            run = Path(folder)
            fake_results.write_run(run, "arm", np.ones((4, 4, 4)), (1.0, 1.0, 1.0))
            fake_results.add_checks(run)
            fake_results.make_simulation(run)
            fake_results.change(run, "summary.json", lambda summary: summary["checks"].update(
                blocked=None, tilt=None))  # no torch
            self.assertEqual(report(run).returncode, 0)
            page = Page(run / "report.html")
            scene = json.loads(page.source.split('type="application/json">')[1].split("</script>")[0])["scene"]
            (view,) = scene["views"]
            self.assertEqual([view["ranges"]["stress"], view["released"]["ranges"]["stress"]], [[0.0, 3.0], [0.0, 1.0]])
            self.assertAlmostEqual(view["released"]["ranges"]["displacement"][1], 0.5 * view["ranges"]["displacement"][1])
            self.assertIn("Residual stress, without plastic flow: up to 300, above", page.text)
            self.assertNotIn("torch", page.text)
            self.assertRegex(page.text, r"Arm, as built: displaced by \S+ mm root mean square, \S+ mm at most\.")

    def test_bundle_is_of_these_sources(self):
        folder = PROJECT / "scripts/fabseq_tools/report/page"
        names = sorted([*(f"src/{path.name}" for path in (folder / "src").glob("*.js")), "package-lock.json"])
        expected = hashlib.sha256(b"".join((folder / name).read_bytes() for name in names)).hexdigest()
        self.assertIn(expected, report_page.bundle().splitlines()[0], f"{folder}/build.sh has to make the bundle again")
        self.assertNotIn("resolved", (folder / "package-lock.json").read_text(encoding="utf-8"))

    def test_damaged_bundle(self):
        packed = (PROJECT / "scripts/fabseq_tools/report/page/bundle.js.xz").read_bytes()
        middle = len(packed) // 2
        turned = packed[:middle] + bytes([packed[middle] ^ 1]) + packed[middle + 1:]
        for damaged in (turned, packed[:middle]):
            with tempfile.TemporaryDirectory() as folder, mock.patch.object(report_page, "PARTS", folder):
                (Path(folder) / "bundle.js.xz").write_bytes(damaged)
                self.assertRaisesRegex(RunError, r"bundle\.js\.xz is damaged", report_page.bundle)


class Fields(unittest.TestCase):
    def test_local_thickness(self):
        """Five layers in a time that rises with the square of the height: the thickness falls with it."""
        with tempfile.TemporaryDirectory() as folder:
            fake_results.write_run(folder, "bar", np.ones((10, 2, 2)), (0.2, 0.2, 1.0), count=5, planar_count=10)
            z = fake_results.node_coordinates((2, 2, 10), (0.2, 0.2, 1.0))[2]
            fake_results.change(folder, "config.json", lambda config: config.update(layers={"type": "curved", "count": 5}))
            height = fake_results.element_centres((2, 2, 10), (0.2, 0.2, 1.0))[2]
            for dataset, values in (("temperature", 1.0 - z**2), ("nodal_time", z**2)):
                with h5py.File(Path(folder) / "result.h5", "r+") as file:
                    file.pop("temperature", None)
                    file[dataset] = values
                run = ReportRun(folder)
                np.testing.assert_allclose(report_views.local_thickness(run, "binary", "")["local_thickness"], 0.2 / (2 * height))
                np.testing.assert_allclose(report_views.local_thickness(run, "baseline", "planar/")["local_thickness"], 0.1)

    def test_temperature_is_shown_where_it_is_known(self):
        with tempfile.TemporaryDirectory() as folder:
            fake_results.write_run(folder, "bar", np.ones((10, 2, 2)), (0.2, 0.2, 1.0), count=5, planar_count=10)
            labels = {"baseline": "planar", "binary": "optimized"}
            scenes = []
            for warm in (False, True):
                if warm:
                    fake_results.add_temperatures(folder)
                run = ReportRun(folder)
                scenes.append(report_views.packed_scene([(run, report_views.views_of(run, labels))])[0])
            cold, warm = scenes
            self.assertNotIn("interpass_temperature", cold["fields"])
            self.assertEqual(warm["fields"]["interpass_temperature"]["unit"], "°C")
            self.assertEqual([view["ranges"]["interpass_temperature"] for view in warm["views"]], [[60.0, 240.0], [60.0, 140.0]])
            self.assertEqual(warm["views"][1]["notes"]["interpass_temperature"], "between 60 and 140 °C")

    def test_coarser_grids(self):
        values = np.array([[1.0, 3.0, np.nan], [np.nan, 2.0, 5.0]])
        np.testing.assert_array_equal(report_views.coarsened(values, 2, np.mean), [[2.0, 5.0]])
        np.testing.assert_array_equal(report_views.coarsened(values, 2, np.max), [[3.0, 5.0]])
        part = np.array([[True, True, False], [True, False, False]])
        nodes = np.arange(12.0).reshape(3, 4)
        # The last node has none of its own: the mean of those around it that belong to the part.
        np.testing.assert_allclose(report_views.coarsened_nodes(nodes, part, 2)[0], [0.0, 2.0, (2.0 + 6.0) / 2])


if __name__ == "__main__":
    unittest.main(verbosity=2, testRunner=Runner)
