# SPDX-License-Identifier: MIT
"""The picture of docs/materials.md is the one that figures/material_curves.py draws of the material files."""

import subprocess
import sys
import tempfile
import unittest
from pathlib import Path
from xml.etree import ElementTree

PROJECT = Path(__file__).resolve().parents[3]
SCRIPT = PROJECT / "benchmarks/evidence/figures/material_curves.py"
PICTURE = PROJECT / "docs/material_curves.svg"
SVG = "{http://www.w3.org/2000/svg}"


class MaterialCurvesTest(unittest.TestCase):
    def shapes_and_texts(self, path):
        root = ElementTree.parse(path).getroot()
        return [shape.get("d") for shape in root.iter(SVG + "path")], [text.text for text in root.iter(SVG + "text")]

    def test_the_picture_is_that_of_the_files(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "curves.svg"
            subprocess.run([sys.executable, SCRIPT, "--picture", path], check=True, stdout=subprocess.DEVNULL)
            self.assertEqual(self.shapes_and_texts(path), self.shapes_and_texts(PICTURE))

    def test_each_file_has_a_panel(self):
        texts = self.shapes_and_texts(PICTURE)[1]
        for path in (PROJECT / "configs/materials").glob("*.json"):
            self.assertIn(path.stem, texts)


if __name__ == "__main__":
    unittest.main()
