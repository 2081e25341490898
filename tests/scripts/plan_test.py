#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""fabseq-tools plan: what it concludes from figures, and what it keeps."""

import io
import os
import subprocess
import sys
import types
import unittest
from unittest import mock

from fabseq_tools.paths import posts
from fabseq_tools.plan import plan, steps
from fabseq_tools.plan.layers import judged
from fabseq_tools.plan.page import rows_of
from fabseq_tools.plan.orientation import clearly_better, rotation_of

from new_config_case import NewConfigCase, TOOLS
from run_fabseq import PROGRAM
from small_meshes import box_triangles, write_stl


def row(layers, length, kind="buildable"):
    return {"layers": layers, "skin": length, "skin_released": None, "class": kind, "verdict": kind.replace("_", " ")}


class Conclusions(unittest.TestCase):
    def test_whether_optimizing_pays(self):
        planar, tilted, guided = row("planar", 1.0), row("tilted planar, 30 degrees", 0.55), row("guided", 0.5)
        for simplest, best, share, pays, words in (
                (tilted, guided, 0.89, False, "build it in tilted planar, 30 degrees: 90% of the gain"),
                (tilted, guided, 0.95, True, "guided layers distort 1.1 times less than the best others"),
                (tilted, row("guided", 0.54), 1.0, False, "build it in tilted planar"),
                (planar, row("guided", 1.2), 0.9, False, "build it in planar, where 1 mm are left, optimized 1.2 mm"),
                (row("planar", 0.1, "not_buildable"), guided, 0.9, True, "guided layers are buildable"),
                (tilted, row("guided", 0.1, "not_buildable"), 0.9, False, "guided layers are not buildable"),
                (tilted, None, 0.9, False, "No optimized layers")):
            found = judged(planar, simplest, best, share)
            self.assertEqual(found[1], pays, found)
            self.assertIn(words, found[0])

    def test_which_way_up(self):
        def record(length, verdict, contact=100.0):
            kind = "buildable_but_for_places" if " but " in verdict else verdict.replace(" ", "_")
            start = {"verdict": verdict, "class": kind, "as_built": {"rms": length}}
            return {"turn": [], "start": start, "planar": {}, "contact_area": contact}

        drawn = record(1.0, "buildable but for 2 places")
        self.assertTrue(clearly_better(record(3.0, "buildable"), drawn))
        self.assertFalse(clearly_better(record(0.1, "not buildable"), drawn))
        self.assertFalse(clearly_better(record(0.85, "buildable but for 1 place"), drawn))
        self.assertTrue(clearly_better(record(0.75, "buildable but for 1 place"), drawn))
        self.assertFalse(clearly_better(record(0.1, "buildable but for 1 place", contact=40.0), drawn))  # on one foot
        self.assertTrue(clearly_better(record(0.1, "buildable", contact=40.0), drawn))
        self.assertEqual(rotation_of([["x", 90.0], ["x", 90.0]]), [180.0, 0, 0])

    def test_what_is_welded(self):
        """Stands last: the moved drawing, unless its layers can be built less well."""
        def whole(folder, length):
            return row(folder, length) | {"folder": folder, "spread": 0.1, "hours": None, "mass": None, "places": []}

        built, moved = {"planar": whole("planar", 1.0), "other": None, "built": whole("guided", 0.5)}, whole("moved", 0.1)
        for drawing, expected in (({"row": moved}, ["planar", "guided", "moved"]),
                                  ({"refused": moved}, ["planar", "moved", "guided"]), ({}, ["planar", "guided"])):
            found = rows_of(built, drawing, {"starts": {"welded": 7}}, True)
            self.assertEqual([one["layers"] for one in found], expected)
            self.assertEqual(found[-1]["starts"], 7)


class Kept(NewConfigCase):
    def steps(self, *words):
        write_stl(self.path("bar.stl"), box_triangles((0.0, 0.0, 0.0), (20.0, 10.0, 30.0)))
        words = [self.path("bar.stl"), "--machine", "robot_fixed_plate", "-o", self.path("plan"), "--program", PROGRAM, *words]
        return steps.Steps(plan.parsed(words))

    def take(self, made, name, value, *given):
        with mock.patch("sys.stdout", new=io.StringIO()) as printed:
            found = made.take(name, lambda _, *others: {"line": f"{value}", "value": value, "given": others}, *given)
        return found["value"], "as before" in printed.getvalue()

    def test_what_is_done_stays(self):
        """Until an option, the part, or a step before has changed."""
        for words, first, expected in (((), 1, [False, False]), ((), 1, [True, True]), (("--ranks", "1"), 1, [True, True]),
                                       (("--minutes", "9"), 1, [False, False]), (("--minutes", "9"), 2, [True, True])):
            made = self.steps(*words)
            self.assertEqual([self.take(made, "part", first)[1], self.take(made, "holes", 5)[1]], expected, words)
        os.remove(self.path("plan/steps.json"))
        made = self.steps()
        self.take(made, "part", 1)
        again = self.steps()
        again.kept["part"]["asked"] = "other"
        self.assertEqual(self.take(again, "part", 3), (3, False))
        with open(self.path("plan/steps.json"), "w", encoding="utf-8") as file:
            file.write("{")
        self.assertEqual(self.steps().kept, {})

    def test_options_of_the_programs_go_on(self):
        given = "--post=gcode", "--post=rapid", "--rotary=BC", "--table-signs", "--rapid-arc=arc_2"
        self.assertEqual(sorted(posts.words_of(self.steps(*given).arguments)), sorted(given))
        self.assertEqual(posts.words_of(self.steps().arguments), [])

    def test_questions(self):
        made = self.steps()
        terminal = types.SimpleNamespace(isatty=lambda: True, write=lambda _: None, flush=lambda: None)
        with mock.patch("sys.stderr", terminal), mock.patch("sys.stdin", io.StringIO("miles\nin\n\n")) as answers:
            self.assertEqual(made.choose("unit?", ("mm", "in"), "mm"), "mm")  # nobody is there
            answers.isatty = lambda: True
            self.assertEqual(made.choose("unit?", ("mm", "in"), "mm"), "in")
            self.assertEqual(made.choose("unit?", ("mm", "in"), "mm"), "mm")
            self.assertRaisesRegex(Exception, "no answer to: unit", made.choose, "unit?", ("mm", "in"), "mm")

    def test_mistakes(self):
        write_stl(self.path("bar.stl"), box_triangles((0.0, 0.0, 0.0), (20.0, 10.0, 30.0)))
        for words, reason in ((["none.stl", "--machine", "large_bead"], "none.stl: no such file"), (["bar.stl"], "--machine"),
                              (["bar.stl", "--machine", "none"], "none"),
                              (["bar.stl", "--machine", "large_bead", "--share", "2"], "--share: found 2")):
            done = subprocess.run([sys.executable, TOOLS, "plan", *words], capture_output=True, text=True, check=False,
                                  cwd=self.folder, env=os.environ | {"FABSEQ_PROGRAM": PROGRAM})
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertIn(reason, done.stderr)
            self.assertFalse(os.path.exists(self.path("output")))


if __name__ == "__main__":
    unittest.main()
