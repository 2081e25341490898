# SPDX-License-Identifier: MIT
"""The files of configs/materials: what they hold, and that docs/materials.md says the same."""

import json
import re
import unittest
from pathlib import Path

PROJECT = Path(__file__).resolve().parents[2]
TEXTS = "name", "source", "comment"
RANGES = {"young": (5e4, 3e5), "poisson": (0.25, 0.4), "mass_density": (2e-6, 1e-5), "yield_stress": (50, 1500),
          "conductivity": (5e-3, 0.3), "heat_capacity": (300, 1500), "solidification": (400, 1700)}
FACTORS = "young_factors", "yield_factors"
HEAT_FACTORS = "conductivity_factors", "heat_capacity_factors"
CURVES = "temperatures", *FACTORS, "elongations", *HEAT_FACTORS
FLOOR = 0.01  # the least modulus that the solver takes, of the one at room temperature


def materials():
    return {path.stem: json.loads(path.read_text(encoding="utf-8"))
            for path in sorted((PROJECT / "configs" / "materials").glob("*.json"))}


class MaterialsTest(unittest.TestCase):
    def test_what_the_files_hold(self):
        self.assertIn("ER70S-6", materials())
        for name, material in materials().items():
            with self.subTest(material=name):
                self.assertEqual(set(material), {*TEXTS, *RANGES, *CURVES, "hardening", "cut_off", "inherent_strain"})
                for key in TEXTS:
                    self.assertGreater(len(material[key]), 10)
                for key, (low, high) in RANGES.items():  # mm, MPa and W, rather than another unit
                    self.assertTrue(low < material[key] < high, key)
                self.assertEqual(len(material["inherent_strain"]), 6)
                self.assertIn("inherent_strain: to be calibrated", material["comment"])

    def test_curves_go_from_room_temperature_to_the_solidus(self):
        for name, material in materials().items():
            with self.subTest(material=name):
                temperatures, elongations = material["temperatures"], material["elongations"]
                self.assertEqual({len(material[key]) for key in CURVES}, {len(temperatures)})
                self.assertEqual(temperatures, sorted(set(temperatures)))
                self.assertEqual((temperatures[0], elongations[0]), (20, 0))
                self.assertGreaterEqual(temperatures[-1], material["solidification"])
                self.assertEqual(elongations, sorted(elongations))
                for key in FACTORS:
                    self.assertEqual((material[key][0], material[key][-1]), (1, FLOOR))
                    self.assertEqual((min(material[key]), max(material[key])), (FLOOR, 1))
                for key in HEAT_FACTORS:
                    self.assertTrue(all(0.5 < factor < 3.5 for factor in material[key]), key)
                self.assertTrue(temperatures[0] < material["cut_off"] < material["solidification"])
                self.assertTrue(0 < material["hardening"] < material["young"] / 50)
                for key in (*CURVES[1:], "Hardening", "cut_off"):
                    self.assertRegex(material["source"], rf"\b{key}(, \w+)?: ")

    def test_mean_expansion_is_that_of_a_metal(self):
        """Strain per kelvin up to the last temperature: least for titanium, most for aluminium."""
        for name, material in materials().items():
            rise = material["elongations"][-1] / (material["temperatures"][-1] - 20)
            self.assertTrue(9e-6 < rise < 3e-5, f"{name}: {rise}")

    def test_the_table_says_the_same(self):
        text = (PROJECT / "docs" / "materials.md").read_text(encoding="utf-8")
        rows = {row[1]: row for row in re.findall(r"^(\| `([^`]+)` \|.*)$", text, re.MULTILINE)}
        self.assertEqual(set(rows), set(materials()))
        for name, material in materials().items():
            cells = [cell.strip() for cell in rows[name][0].split("|")[3:-1]]
            self.assertEqual([float(cell) for cell in cells[:-1]], [material[key] for key in RANGES], name)
            for source in re.split("[,;] ", cells[-1]):
                for word in source.split():
                    self.assertIn(word, material["source"] + " data", name)


if __name__ == "__main__":
    unittest.main()
