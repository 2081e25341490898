# SPDX-License-Identifier: MIT
"""fabseq-tools plan: all steps of a small part, and what is left to do when it is given again."""

import io
import json
import os
from unittest import mock

from fabseq_tools.plan import configs, plan
from fabseq_tools.run.verdict_words import rank

import run_fabseq
from run_fabseq import PROGRAM, FabseqTest
from small_meshes import box_triangles, write_stl


@run_fabseq.only_release  # the tools are the same for all
class PlanTest(FabseqTest):
    """Of a post with an arm, on few elements."""

    def path_of(self, name):
        return os.path.join(self.directory, name)

    def plan(self, *words):
        arguments = [self.path_of("arm.stl"), "--machine", "large_bead", "-o", self.path_of("plan"), "--yes", "--rotate=0,0,0",
                     "--elements", "900", "--iterations", "3", "--minutes", "0.2", "--ranks", "1", "--program", PROGRAM, *words]
        with (mock.patch("sys.stdout", new=io.StringIO()) as printed, mock.patch("sys.stderr", new=io.StringIO()),
              mock.patch.multiple(configs, COARSE_ELEMENTS=500, COARSE_LAYERS=5, COARSE_ITERATIONS=2)):
            plan.main(arguments)
        return printed.getvalue().splitlines()

    def test_from_the_drawing_to_the_cell(self):
        triangles = [*box_triangles((0.0, 0.0, 0.0), (40.0, 40.0, 60.0)), *box_triangles((0.0, 0.0, 60.0), (100.0, 40.0, 100.0))]
        write_stl(self.path_of("arm.stl"), triangles)
        lines = self.plan("--optimize", "--post", "gcode")
        self.assertEqual([line.split()[1].rstrip(":") for line in lines[:7]],
                         ["part", "orientation", "holes", "layers", "build", "drawing", "paths"], lines)
        self.assertRegex(lines[-1], r"plan\.html: (Weld this|Not to be welded).*: guided.*mm, .*buildable.*; in \d+ s")
        with open(self.path_of("plan/plan.json"), encoding="utf-8") as file:
            record = json.load(file)
        rows, welded = {row["title"]: row for row in record["rows"]}, record["rows"][-1]
        moved = rows.get("optimized, drawing compensated") or rows["not welded: drawing compensated"]
        self.assertLess(moved["rms"], rows["optimized"]["rms"])
        self.assertIs(welded, moved if rank(moved["class"]) <= rank(rows["optimized"]["class"]) else rows["optimized"])
        for title, row in rows.items():
            for key in ("rms", "largest", "spread", "hours", "kg", *["starts"] * (not title.startswith("not welded"))):
                self.assertGreater(row[key], 0, f"{title}: {key}")
        self.assertTrue(all(layer["pause"] is None or layer["pause"] >= 0 for layer in record["layers"]))
        with open(self.path_of("plan/plan.html"), encoding="utf-8") as file:
            page = file.read()
        for words in ("guided, compensated drawing", "spread, mm", "<svg", "data:image/png"):
            self.assertIn(words, page)
        self.assertEqual(os.path.exists(self.path_of("plan/compensated.stl")), welded is moved)
        self.assertEqual("compensated.stl" in page, welded is moved)
        for name in ("report.html", "arm.json", "paths/gcode", "paths/paths.csv"):
            self.assertTrue(os.path.exists(self.path_of(f"plan/{name}")), name)
        again = self.plan("--optimize", "--post", "gcode")
        self.assertEqual(sum("(as before)" in line for line in again), 7, again)


if __name__ == "__main__":
    run_fabseq.main()
