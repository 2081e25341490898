#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""fabseq-tools new, of parts in several pieces, of which not all stand on the plate, or none at first."""

import unittest

from fabseq_tools.run.read_run import read_config

from new_config_case import NewConfigCase
from small_meshes import box_triangles, cone_triangles, write_stl

BAR = (0.0, 0.0, 0.0), (60.0, 20.0, 20.0)
CUT = r"The part begins {} mm above the mesh's lowest point \(domain.origin\)\. {}.* cut off, {} % of the volume\n"


class NewConfigPiecesTest(NewConfigCase):
    def test_several_pieces_on_the_plate(self):
        """They have no release."""
        low, high = box_triangles((0.0, 0.0, 0.0), (20.0, 20.0, 20.0)), box_triangles((40.0, 0.0, 0.0), (60.0, 20.0, 30.0))
        write_stl(self.path("posts.stl"), [*low, *high])
        for words in ([], ["--max-tilt", "180"]):
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
        """They are left out with a word on their volume."""
        for name, height, share in (("stray", 4.0, "0.3"), ("half", 20.0, "25.0")):
            write_stl(self.path(name + ".stl"), [*box_triangles(*BAR), *box_triangles((0, 0, 40), (height, height, 40 + height))])
            for words in ([], ["--keep", "connected"]):
                printed = self.run_new(f"{name}.stl", "--thickness", "8", "--overwrite", *words)
                self.assertRegex(self.warnings, r"^fabseq-tools new: warning: /part: 1 piece is not connected to .*; dropped "
                                                rf"\(part.keep\): {share} % of the volume[^\n]*\n$")
                self.assertEqual("smaller elements" in self.warnings, name == "half")
                self.assertIn(f"keep leaves out 1 piece off the plate, {share} % of the volume", printed)
                self.assertEqual(read_config(self.path(name + ".json"))["part"]["keep"], "connected")
                self.assertEqual(self.check(name + ".json").returncode, 0)
            line = self.run_new(f"{name}.stl", "--thickness", "8", "--overwrite", "--keep", "all", status=2)
            self.assertIn(f"1 piece of the part, {share} % of its volume, stands neither on the plate nor on the rest", line)
            self.assertIn("allowed: --keep connected", line)

    def test_most_of_the_part_off_the_plate(self):
        """The plate is moved up to it, unless what stands shall be kept."""
        loose = box_triangles((20.0, 5.0, -20.0), (30.0, 15.0, -10.0))
        write_stl(self.path("loose.stl"), [*box_triangles(*BAR), *loose])
        self.run_new("loose.stl", "--elements", "8000")
        self.assertRegex(self.warnings, CUT.format("(19|20)[.0-9]*", "The pieces below, on the plate, are the smaller ones",
                                                   "[34]\\.[0-9]"))
        domain = read_config(self.path("loose.json"))["domain"]
        self.assertAlmostEqual(domain["origin"][2] + domain["size"][2], 40.0, 5)
        self.assertNotIn("keep", read_config(self.path("loose.json"))["part"])
        done = self.check("loose.json")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("pieces: 1\n", done.stdout)
        self.run_new("loose.stl", "--elements", "8000", "--keep", "connected", "--overwrite")
        self.assertRegex(self.warnings, r"dropped \(part.keep\): (95.9|96.0) % of the volume")

    def test_point_on_the_plate(self):
        """It is cut off, as no element there is half full."""
        write_stl(self.path("cone.stl"), cone_triangles(20.0, 40.0))
        self.run_new("cone.stl", "--elements", "4000")
        self.assertRegex(self.warnings, CUT.format("[.0-9]+", "Below, no element is half full: what lies there", "less than 1"))
        config = read_config(self.path("cone.json"))
        self.assertLess(config["domain"]["origin"][2], 4.0)
        for size, elements in zip(config["domain"]["size"], config["domain"]["elements"]):
            self.assertAlmostEqual(size / elements, 1.6, delta=0.2)
        self.assertEqual(self.check("cone.json").returncode, 0)
        self.run_new("cone.stl", "--elements", "4000", "--rotate", "180,0,0", "--overwrite")
        self.assertEqual(set(read_config(self.path("cone.json"))["domain"]), {"element", "unit"})

    def test_thin_legs(self):
        """Elements of a quarter of a layer would break them; smaller ones hold the part together."""
        legs = [box_triangles((x, y, 0), (x + 3, y + 3, 30)) for x in (0, 47) for y in (0, 27)]
        write_stl(self.path("table.stl"), [*box_triangles((0, 0, 28), (50, 30, 40)), *(one for leg in legs for one in leg)])
        self.run_new("table.stl", "--thickness", "24")
        config = read_config(self.path("table.json"))
        self.assertNotIn("origin", config["domain"])
        self.assertLess(config["domain"]["element"], 3.0)
        self.assertNotIn("dropped", self.warnings)
        self.assertIn("pieces: 1\n", self.check("table.json").stdout)


if __name__ == "__main__":
    unittest.main()
