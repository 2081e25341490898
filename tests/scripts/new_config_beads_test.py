#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""fabseq-tools new --bead-height: how many real layers a simulated one stands for."""

import re
import types
import unittest

from fabseq_tools.run.read_run import read_config
from fabseq_tools.start.beads import Beads, minutes_of

from new_config_case import NewConfigCase
from small_meshes import write_box


class NewConfigBeadsTest(NewConfigCase):
    def beads(self, *words):
        """Its config, and what was chosen in a line."""
        printed = self.run_new("wall.stl", "--bead-height", "2", "--bead-width", "5", "--overwrite", *words)
        line = next(line for line in printed.splitlines() if line.startswith("beads "))
        return read_config(self.path("wall.json")), line

    def test_wall(self):
        """In minutes, layers of enough elements, thicknesses of beads; a longer run has thinner layers."""
        write_box(self.path("wall.stl"), (80.0, 20.0, 100.0))
        config, line = self.beads("--minutes", "5")
        passes, edge = config["layers"]["passes"], config["domain"]["element"]
        self.assertGreater(passes, 1)
        self.assertGreaterEqual(2 * passes / edge, 2.5)
        self.assertAlmostEqual(config["layers"]["count"] * 2 * passes, 1.05 * 100, delta=2 * passes)
        self.assertEqual((config["constraints"][0]["target"], config["tool"]["bead_width"]), (2, 5))
        self.assertNotIn("elements, needs", self.warnings)
        found = re.fullmatch(r"beads 2 mm high and 5 mm wide: a simulated layer of (\S+) mm stands for (\d+); (\d+) layers, "
                             r"elements of (\S+) mm, (about \S+ min|less than a minute) for 120 iterations on one rank "
                             r"\(--minutes\)", line)
        self.assertTrue(found, line)
        self.assertEqual([float(found[i]) for i in range(1, 5)], [2 * passes, passes, config["layers"]["count"], edge])
        done = self.check("wall.json")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn(f"beads: a layer stands for {passes} one above the other, 2 mm each", done.stdout)
        longer, _ = self.beads("--minutes", "500", "--elements", "200000")
        self.assertLess(longer["layers"]["passes"], passes)

    def test_high_beads_are_layers(self):
        write_box(self.path("wall.stl"), (40.0, 20.0, 40.0))
        printed = self.run_new("wall.stl", "--bead-height", "8")
        self.assertNotIn("passes", read_config(self.path("wall.json"))["layers"])
        self.assertIn("beads 8 mm high: each is a simulated layer; ", printed)

    def test_minutes_need_beads(self):
        write_box(self.path("wall.stl"), (40.0, 20.0, 40.0))
        self.assertIn("--minutes: found without --bead-height", self.run_new("wall.stl", "--minutes", "5", status=2))

    def test_passes_grow_until_the_run_takes_minutes(self):
        """Of a part whose elements can be no larger than half a millimetre, say, as its walls are thin."""
        def found(edge, seconds):
            return types.SimpleNamespace(edge=edge, seconds=seconds, geodesic=200.0, elements=3000, memory=1.0)

        tried = []

        def element_for(target):
            tried.append(target)
            return types.SimpleNamespace(found=found(0.5, 20.0 / target))

        look = types.SimpleNamespace(first=lambda: found(4.0, 0.1), layers=16, counted=lambda one: one.elements)
        arguments = types.SimpleNamespace(bead_height=2.0, bead_width=None, minutes=12.0, iterations=100, memory=None,
                                          elements=None, unit="mm")
        beads = Beads(arguments, look, element_for, 2.5)
        self.assertEqual(len(tried), len(set(tried)))
        self.assertLessEqual(minutes_of(arguments, beads.element.found), 12.0)
        self.assertIn(beads.target(), tried)
        arguments.minutes = 0.01  # never: thicker layers would be too few
        self.assertEqual(Beads(arguments, look, element_for, 2.5).passes, 12)


if __name__ == "__main__":
    unittest.main()
