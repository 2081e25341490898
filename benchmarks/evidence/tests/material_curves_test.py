# SPDX-License-Identifier: MIT
"""The pictures of docs/materials.md are those that figures/material_curves.py draws of the material files."""

import subprocess
import sys
import tempfile
import unittest
from pathlib import Path
from xml.etree import ElementTree

PROJECT = Path(__file__).resolve().parents[3]
SCRIPT = PROJECT / "benchmarks/evidence/figures/material_curves.py"
PICTURES = [PROJECT / "docs" / name for name in ("material_curves.svg", "material_heat_curves.svg")]
SVG = "{http://www.w3.org/2000/svg}"


class MaterialCurvesTest(unittest.TestCase):
    def shapes_and_texts(self, path):
        root = ElementTree.parse(path).getroot()
        return [shape.get("d") for shape in root.iter(SVG + "path")], [text.text for text in root.iter(SVG + "text")]

    def test_the_pictures_are_those_of_the_files(self):
        with tempfile.TemporaryDirectory() as folder:
            drawn = [Path(folder) / path.name for path in PICTURES]
            subprocess.run([sys.executable, SCRIPT, "--picture", drawn[0], "--heat", drawn[1]], check=True,
                           stdout=subprocess.DEVNULL)
            for path, picture in zip(drawn, PICTURES, strict=True):
                self.assertEqual(self.shapes_and_texts(path), self.shapes_and_texts(picture))

    def test_each_file_has_a_panel(self):
        for picture in PICTURES:
            texts = self.shapes_and_texts(picture)[1]
            for path in (PROJECT / "configs/materials").glob("*.json"):
                self.assertIn(path.stem, texts)


if __name__ == "__main__":
    unittest.main()
