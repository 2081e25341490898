#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""fabseq-tools new: what it chooses for small parts, and that the program takes what it writes."""

import math
import os
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

from fabseq_tools.run.read_run import read_config
from fabseq_tools.start.config_text import Entry, config_text, plain

from new_config_case import NewConfigCase
from small_meshes import box_triangles, wedge_triangles, write_box, write_stl


class NewConfigTest(NewConfigCase):
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
        self.assertEqual((config["layers"]["count"], config["sequence"]), (3, {"type": "guided", "filter_radius": 0}))
        self.assertEqual(config["tool"], {"thickness": [0.6, 1.6], "bead_width": 10.0, "axis": "normal", "max_tilt": 60.0})
        self.assertEqual([one["type"] for one in config["constraints"]],
                         ["layer_thickness", "last_layer", "local_thickness", "tilt", "supported"])
        self.assertFalse(any("limit" in one for one in config["constraints"]))  # they adapt to the exact checks
        self.assertEqual([one["type"] for one in config["objective"]], ["distortion"])
        self.assertEqual(config["baseline"], {"direction": "best"})
        self.assertEqual(config["projection"], {"interval": 13})
        self.assertEqual(config["solver"], {"tolerance": "auto"})
        self.assertIn("domain: {\"element\": 2.0, \"unit\": \"mm\"}: Edge of an element: a quarter of a layer of 8 mm.", printed)
        command = printed.splitlines()[-2]
        done = subprocess.run(["bash", "-c", command.replace(" -picture", "")], capture_output=True, text=True, check=False,
                              cwd=self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("3000 elements", done.stdout)
        self.assertIn("exists; allowed: another --output, or --overwrite",
                      self.run_new("it's a part/bar.stl", "-o", "it's a part/case.json", status=2))

    def test_tilt_and_sequence(self):
        """60 degrees unless asked for another tilt. Guided with a limit below 90, unless asked for heat."""
        write_box(self.path("bar.stl"), (60.0, 20.0, 20.0))
        for words, kind, tilt in (([], "guided", 60.0), (["--max-tilt", "45"], "guided", 45.0),
                                  (["--max-tilt", "90"], "heat", 90.0), (["--max-tilt", "180"], "heat", None),
                                  (["--sequence", "heat"], "heat", 60.0),
                                  (["--max-tilt", "180", "--sequence", "guided"], "guided", None)):
            printed = self.run_new("bar.stl", "--thickness", "8", "--overwrite", *words)
            config = read_config(self.path("bar.json"))
            self.assertEqual(config["sequence"]["type"], kind)
            self.assertEqual(config["sequence"].get("characteristic_length"), 24.0 if kind == "heat" else None)
            self.assertEqual((config["tool"].get("max_tilt"), config["tool"].get("axis")), (tilt, "normal" if tilt else None))
            types = [one["type"] for one in config["constraints"]]
            self.assertEqual(("tilt" in types, types[-1]), (tilt is not None, "supported"))
            self.assertEqual("layer_uniformity" in [one["type"] for one in config["objective"]], kind == "heat")
            self.assertEqual(sum(line.startswith("tilt: at most 60 degrees") for line in printed.splitlines()),
                             int("--max-tilt" not in words))
            self.assertEqual(self.warnings, "")

    def test_holes(self):
        """A portal's roof that upright layers do not carry is named; --fill-holes closes the portal."""
        write_stl(self.path("portal.stl"), [*box_triangles((0, 0, 0), (10, 30, 30)), *box_triangles((50, 0, 0), (60, 30, 30)),
                                            *box_triangles((0, 0, 30), (60, 30, 40))])
        self.run_new("portal.stl", "--max-tilt", "20")
        hole = r"a hole of (40|40\.\d) x (30|29\.\d) x (30|29\.\d) mm near \[30,15,1[45].*\], whose roof spans (29|30)"
        self.assertRegex(self.warnings, hole)
        self.assertIn("no layers within 20 degrees carry it; --fill-holes closes it", self.warnings)
        self.assertNotIn("stock", read_config(self.path("portal.json")))
        printed = self.run_new("portal.stl", "--max-tilt", "20", "--fill-holes", "--overwrite")
        self.assertRegex(printed, f"closed, to be drilled: {hole}")
        self.assertEqual(self.warnings, "")
        done = self.check("portal.json")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stdout, r"machining stock: (49|50|51)(\.\d)? % of the part")
        self.assertNotIn("hole:", done.stdout)
        printed = self.run_new("portal.stl", "--fill-holes", "--overwrite")
        self.assertIn("holes: layers within 60 degrees carry every roof, or a bead bridges it: none is closed", printed)

    def test_rotate(self):
        """The grid is that of the turned surface; degrees may begin with a minus."""
        write_box(self.path("bar.stl"), (60.0, 20.0, 10.0))
        for words, turns, size in ((["--rotate", "0,90,0"], [["y", 90.0]], [10.0, 20.0, 60.0]),
                                   (["--rotate", "-90,0,90"], [["x", -90.0], ["z", 90.0]], [10.0, 60.0, 20.0]),
                                   (["--rotate=-33,12,0"], [["x", -33.0], ["y", 12.0]], None)):
            self.run_new("bar.stl", "--thickness", "4", "--overwrite", *words)
            config = read_config(self.path("bar.json"))
            self.assertEqual(config["part"]["mesh"]["rotate"], turns)
            done = self.check("bar.json")
            self.assertEqual(done.returncode, 0, done.stderr)
            if size:
                self.assertEqual(config["layers"]["count"], math.ceil(1.05 * size[2] / 4))
                (box,) = re.findall(r"^placed in \[(.*)\] to \[(.*)\]$", done.stdout, re.MULTILINE)
                low, high = ([float(x) for x in end.split(",")] for end in box)
                self.assertEqual([b - a for a, b in zip(low, high)], size)
        self.run_new("bar.stl", "--rotate", "0,0,0", "--overwrite")
        self.assertNotIn("rotate", read_config(self.path("bar.json"))["part"]["mesh"])

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
        self.assertNotIn("rotate", read_config(self.path("wedge.json"))["part"]["mesh"])
        self.run_new("wedge.stl", "--unit", "m", "--bead-height", "0.008", "--bead-width", "0.01", "--rotate", "0,90,0",
                     "--overwrite")
        config = read_config(self.path("wedge.json"))
        self.assertEqual((config["constraints"][0]["target"], config["tool"]["bead_width"], config["tool"]["max_tilt"]),
                         (0.008, 0.01, 60.0))
        self.assertGreaterEqual(config["layers"]["count"], 6)  # of 40 mm
        self.assertEqual(self.check("wedge.json").returncode, 0)
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
                                     ("bar.stl", ["--max-tilt", "181"], "--max-tilt: found 181; allowed: degrees above 0,"),
                                     ("bar.stl", ["--rotate", "-1,x,3"], "--rotate: found -1,x,3; allowed: degrees about x"),
                                     ("bar.stl", ["--rotate", "90,0"], "--rotate: found 90,0; allowed: degrees about x"),
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
