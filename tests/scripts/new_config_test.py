#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""fabseq-tools new: what it chooses for small parts, and that the program takes what it writes."""

import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from fabseq_tools.run.read_run import read_config
from fabseq_tools.start.config_text import Entry, config_text, plain

from run_fabseq import PROGRAM
from small_meshes import box_triangles, wedge_triangles, write_box, write_stl

PROJECT = Path(__file__).resolve().parents[2]
TOOLS = PROJECT / "scripts/fabseq-tools"


class NewConfigTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def path(self, name):
        return os.path.join(self.folder, name)

    def run_new(self, part, *words, status=0):
        """What it prints, in the folder; with another status than 0 its one line."""
        done = subprocess.run([sys.executable, TOOLS, "new", part, *words], capture_output=True, text=True, check=False,
                              cwd=self.folder, env=os.environ | {"FABSEQ_PROGRAM": PROGRAM})
        self.assertEqual(done.returncode, status, done.stderr)
        self.warnings = "".join(line for line in done.stderr.splitlines(True) if not line.startswith("new: "))  # no progress
        if status:
            self.assertEqual((done.stdout, self.warnings.count("\n")), ("", 1), done.stderr)
            return self.warnings
        return done.stdout

    def test_box(self):
        """Its config is taken; the printed command runs it, from a path that needs quotes."""
        os.mkdir(self.path("it's a part"))
        write_box(self.path("it's a part/bar.stl"), (60.0, 20.0, 20.0))
        printed = self.run_new("it's a part/bar.stl", "--bead-height", "8", "--bead-width", "10", "--max-tilt", "60",
                               "--iterations", "60", "-o", "it's a part/case.json")
        config = read_config(self.path("it's a part/case.json"))
        self.assertEqual(self.warnings, "")
        self.assertEqual(config["domain"], {"element": 2.0, "unit": "mm"})
        self.assertEqual(config["part"]["mesh"], {"file": "bar.stl"})
        self.assertEqual((config["layers"]["count"], config["sequence"]), (3, {"type": "guided"}))
        self.assertEqual(config["tool"], {"thickness": [0.6, 1.6], "bead_width": 10.0, "axis": "normal", "max_tilt": 60.0})
        self.assertEqual([one["type"] for one in config["constraints"]],
                         ["layer_thickness", "last_layer", "local_thickness", "tilt", "supported"])
        self.assertFalse(any("limit" in one for one in config["constraints"]))  # they adapt to the exact checks
        self.assertEqual([one["type"] for one in config["objective"]], ["distortion"])
        self.assertEqual(config["baseline"], {"direction": "best"})
        self.assertEqual(config["projection"], {"interval": 13})
        self.assertIn("domain: {\"element\": 2.0, \"unit\": \"mm\"}: Edge of an element: a quarter of a layer of 8 mm.", printed)
        command = printed.splitlines()[-2]
        done = subprocess.run(["bash", "-c", command.replace(" -picture", "")], capture_output=True, text=True, check=False,
                              cwd=self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("3000 elements", done.stdout)
        self.assertIn("exists; allowed: another --output, or --overwrite",
                      self.run_new("it's a part/bar.stl", "-o", "it's a part/case.json", status=2))

    def test_kind_of_sequence(self):
        """Guided with a limit of the tilt, unless asked for heat or the limit is none."""
        write_box(self.path("bar.stl"), (60.0, 20.0, 20.0))
        for words, kind in (([], "heat"), (["--max-tilt", "90"], "heat"), (["--max-tilt", "45"], "guided"),
                            (["--max-tilt", "45", "--sequence", "heat"], "heat"), (["--sequence", "guided"], "guided")):
            self.run_new("bar.stl", "--thickness", "8", "--overwrite", *words)
            config = read_config(self.path("bar.json"))
            self.assertEqual(config["sequence"]["type"], kind)
            self.assertEqual(config["sequence"].get("characteristic_length"), 24.0 if kind == "heat" else None)
            types = [one["type"] for one in config["constraints"]]
            self.assertEqual(("tilt" in types, types[-1]), ("--max-tilt" in words, "supported"))
            self.assertEqual("layer_uniformity" in [one["type"] for one in config["objective"]], kind == "heat")
            self.assertEqual(self.warnings, "")

    def check(self, config):
        """What the program says of a config."""
        return subprocess.run([PROGRAM, "-config", config, "-task", "check"], capture_output=True, text=True, check=False,
                              cwd=self.folder)

    def test_several_pieces_on_the_plate(self):
        """They have no release."""
        low, high = box_triangles((0.0, 0.0, 0.0), (20.0, 20.0, 20.0)), box_triangles((40.0, 0.0, 0.0), (60.0, 20.0, 30.0))
        write_stl(self.path("posts.stl"), [*low, *high])
        for words in ([], ["--max-tilt", "45"]):
            printed = self.run_new("posts.stl", "--thickness", "8", "--overwrite", *words)
            self.assertEqual(self.warnings, "fabseq-tools new: warning: 2 pieces stand on the plate: they have no release, so "
                             "what is made small is the shape on the plate\n")
            config = read_config(self.path("posts.json"))
            self.assertEqual(config["objective"][0], {"type": "distortion", "measure": "shape", "nodes": "skin"})
            self.assertIn("2 pieces stand there", printed)
            done = self.check("posts.json")
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn("pieces: 2", done.stdout)

    def test_pieces_off_the_plate(self):
        """Small ones are left out with a word, large ones if asked for."""
        for name, height in (("stray", 4.0), ("half", 20.0)):
            bar = box_triangles((0.0, 0.0, 0.0), (60.0, 20.0, 20.0))
            piece = box_triangles((0.0, 0.0, 40.0), (height, height, 40.0 + height))
            write_stl(self.path(name + ".stl"), [*bar, *piece])
        for name, words in (("stray", []), ("half", ["--keep", "connected"])):
            printed = self.run_new(f"{name}.stl", "--thickness", "8", *words)
            self.assertRegex(self.warnings, r"^fabseq-tools new: warning: /part: 1 piece is not connected to .*; dropped\n$")
            self.assertIn("keep leaves out 1 piece off the plate", printed)
            self.assertEqual(read_config(self.path(name + ".json"))["part"]["keep"], "connected")
            self.assertEqual(self.check(name + ".json").returncode, 0)
        for name, words, share in (("stray", ["--keep", "all"], 0.27), ("half", [], 25)):
            line = self.run_new(f"{name}.stl", "--thickness", "8", "--overwrite", *words, status=2)
            self.assertIn(f"1 piece of the part, {share} % of it, stands neither on the plate nor on the rest", line)
            self.assertIn("allowed: --keep connected", line)

    def test_thin_wall(self):
        """Three elements across it where the bound allows, else a warning and a config that is taken."""
        write_stl(self.path("fin.stl"), [*box_triangles((0, 0, 0), (40, 20, 10)), *box_triangles((10, 0, 10), (13, 20, 30))])
        printed = self.run_new("fin.stl", "--thickness", "8")
        config = read_config(self.path("fin.json"))
        self.assertLessEqual(config["domain"]["element"], 1.0)
        self.assertNotIn("least_elements", config["part"]["mesh"])
        self.assertIn("3 or more across the thinnest wall, which is at [", printed)
        self.run_new("fin.stl", "--thickness", "8", "--elements", "1500", "-o", "few.json")
        config = read_config(self.path("few.json"))
        self.assertGreater(config["domain"]["element"], 1.5)
        self.assertLess(config["part"]["mesh"]["least_elements"], 3)
        self.assertIn("across the wall at [", self.warnings)

    def test_edge_memory_and_units(self):
        write_stl(self.path("wedge.stl"), wedge_triangles(0.04, 0.02, 0.02))
        self.run_new("wedge.stl", "--scale", "1000", "--memory", "0.15", "--material", "316l")
        config = read_config(self.path("wedge.json"))
        self.assertEqual(config["part"]["mesh"]["scale"], 1000.0)
        self.assertLess(config["part"]["mesh"]["least_elements"], 3)
        self.assertEqual(config["constraints"][0]["target"], 4 * config["domain"]["element"])
        self.assertTrue(config["material"]["file"].endswith("316L.json"))
        self.run_new("wedge.stl", "--unit", "m", "--thickness", "0.008", "--overwrite")
        self.assertNotIn("expected: ", self.warnings)  # of the program, in metres or inches
        material = read_config(self.path("wedge.json"))["material"]
        self.assertEqual((material["mass_density"], material["conductivity"]), (7850, 40.7))
        self.run_new("wedge.stl", "--unit", "inches", "--scale", "39.37", "--thickness", "0.3", "--overwrite")
        self.assertNotIn("expected: ", self.warnings)  # of the program, in metres or inches
        material = read_config(self.path("wedge.json"))["material"]
        self.assertEqual((material["mass_density"], material["conductivity"]), (0.128638, 1.03378))
        self.run_new("wedge.stl", "--unit", "ells", "--scale", "100", "--thickness", "0.8", "--overwrite")
        self.assertIn("--unit: found ells, whose length is not known", self.warnings)
        self.assertEqual(set(read_config(self.path("wedge.json"))["material"]), {"file"})
        self.run_new("wedge.stl", "--thickness", "0.008", "--overwrite")
        self.assertIn("the part would be 0.04 × 0.02 × 0.02 mm: is the file in another unit?", self.warnings)

    def test_refusals(self):
        write_box(self.path("bar.stl"), (60.0, 20.0, 20.0))
        with open(self.path("page.stl"), "w", encoding="utf-8") as file:
            file.write("<html>not found</html>\n")
        for part, words, message in (("none.stl", [], "none.stl: no such file"), ("page.stl", [], "/part/mesh/file: "),
                                     ("bar.stl", ["--material", "butter"], "--material: found butter; allowed: 308L, "),
                                     ("bar.stl", ["--thickness", "1e-4"], "one thick layer may stand for several"),
                                     ("bar.stl", ["--memory", "0.001"], "allowed: a larger bound"),
                                     ("bar.stl", ["--iterations", "0"], "--iterations: found 0; allowed: an integer >= 1"),
                                     ("bar.stl", ["--program", "no-such-program"], "no-such-program: no such program")):
            self.assertIn(message, self.run_new(part, *words, status=2))
            self.assertFalse(os.path.exists(self.path("bar.json")))


class ConfigTextTest(unittest.TestCase):
    def test_comments_are_no_content(self):
        two = [Entry("", {"a": 1}, "one"), Entry("", {"b": 2}, "two")]
        entries = [Entry("name", 'a "b" // c', "Why " * 60), Entry("objective", two, "All /* of */ it.")]
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "case.json"
            path.write_text(config_text("head", entries), encoding="utf-8")
            self.assertEqual(read_config(path), plain(entries))
            self.assertLessEqual(max(map(len, path.read_text(encoding="utf-8").splitlines())), 110)


if __name__ == "__main__":
    unittest.main()
