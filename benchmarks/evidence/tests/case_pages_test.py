#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""The pages of the published cases are those that the table of figures gives, and what the table says stands
on them."""

import csv
import json
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

PROJECT = Path(__file__).resolve().parents[3]
SCRIPT = PROJECT / "benchmarks/evidence/figures/reproduce.py"
CASES = {"arm": {"config": "arm.json", "source": "X25 §2.1", "what": "an arm", "published": {"planar": 2.0, "optimized": 0.5}},
         "foot": {"config": "foot.json", "source": "X25 §3", "what": "a foot"}}
FIGURES = [{"case": "foot", "planar": "3", "smooth": "1.5", "smooth_factor": "2.0", "run": "30 iterations"},
           {"case": "arm", "planar": "1", "smooth": "1e-7", "smooth_factor": "1e7", "binary": "0.1", "binary_factor": "10",
            "constraints": "satisfied", "thickness_in": "lengths", "thickness_geometric": "1 to 2", "run": "20 iterations"}]


class CasePagesTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)
        self.folder = self.root / "results" / "cases"

    def write_again(self, *words):
        return subprocess.run([SCRIPT, "--pages", "--results", self.root / "results.md", *words],
                              capture_output=True, text=True, check=False)

    def test_pages_of_the_repository(self):
        shutil.copytree(PROJECT / "benchmarks/evidence/results/cases", self.folder)
        shutil.copy(PROJECT / "benchmarks/evidence/cases.md", self.root / "results.md")
        pages = [self.root / "results.md", *sorted(self.folder.glob("*.md")), self.folder / "cases.csv"]
        before = [page.read_text(encoding="utf-8") for page in pages]
        self.assertEqual(len(pages), 1 + 8 + 1)
        done = self.write_again()
        self.assertEqual(done.returncode, 0, done.stderr)
        for page, text in zip(pages, before, strict=True):
            self.assertEqual(page.read_text(encoding="utf-8"), text, f"{page.name}: reproduce.py --pages")

    def make_up(self, marks=("X25 §2", "X25 §3")):
        """Two pages of two cases; their table is not in the order of the cases."""
        self.folder.mkdir(parents=True)
        (self.root / "cases.json").write_text(json.dumps(CASES), encoding="utf-8")
        (self.root / "results.md").write_text("Before.\n<!-- cases -->\nold\n<!-- end of cases -->\nAfter.\n", encoding="utf-8")
        for name, sources in zip("ab", marks):
            (self.folder / f"{name}.md").write_text(f"Before.\n<!-- cases of {sources} -->\n<!-- end of cases -->\nAfter.\n",
                                                    encoding="utf-8")
        with open(self.folder / "cases.csv", "w", encoding="utf-8", newline="") as file:
            writer = csv.DictWriter(file, list(dict.fromkeys(key for row in FIGURES for key in row)), restval="")
            writer.writeheader()
            writer.writerows(FIGURES)

    def test_what_stands_on_them(self):
        self.make_up()
        (self.folder / "foot.png").write_bytes(b"")
        done = self.write_again("--cases", self.root / "cases.json")
        self.assertEqual(done.returncode, 0, done.stderr)
        overview = (self.root / "results.md").read_text(encoding="utf-8")
        self.assertEqual(overview, """Before.
<!-- cases -->
| case | published | smooth | binary | nominal | constraints |
| --- | --- | --- | --- | --- | --- |
| [arm](results/cases/a.md) | 4.0 | > 1e6 | 10 | – | satisfied |
| [foot](results/cases/b.md) | – | 2.0 | – | – | – |
<!-- end of cases -->
After.
""")
        arm, foot = ((self.folder / name).read_text(encoding="utf-8") for name in ("a.md", "b.md"))
        self.assertIn("- `arm`: an arm [X25 §2.1]; 20 iterations.\n", arm)
        self.assertIn("| arm | 2 → 0.5: 4.0 | 1 | 1e-7: > 1e6 | 0.1: 10 |\n", arm)
        self.assertIn("the distortion has vanished", arm)
        self.assertIn("| case | geometric |\n| --- | --- |\n| arm | 1 to 2 |\n", arm)
        self.assertNotIn("![", arm)
        self.assertNotIn("vanished", foot)
        self.assertNotIn("Thickness", foot)
        self.assertIn("](foot.png)\n<!-- end of cases -->\nAfter.\n", foot)

    def test_mistakes(self):
        """Nothing is written."""
        for marks, words in ((("X25 §2", "X26"), "foot: no page of"), (("X25 §2", "X25"), "b.md: arm is on another page"),
                             (("X25 §2 -->", "X25 §3"), "a.md: has no line"), (("X25 §20, X25 §3", "X26"), "arm: no page of")):
            with self.subTest(marks):
                shutil.rmtree(self.root / "results", ignore_errors=True)
                self.make_up(marks)
                before = {path: path.read_bytes() for path in self.folder.iterdir()}
                done = self.write_again("--cases", self.root / "cases.json")
                self.assertEqual(done.returncode, 2)
                self.assertIn(words, done.stderr)
                self.assertEqual({path: path.read_bytes() for path in self.folder.iterdir()}, before)
                self.assertIn("old", (self.root / "results.md").read_text(encoding="utf-8"))


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], "--verbose"])
