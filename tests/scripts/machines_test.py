# SPDX-License-Identifier: MIT
"""The files of configs/machines: that each value has a source, and that the page on them says the same."""

import json
import re
import unittest
from pathlib import Path

PROJECT = Path(__file__).resolve().parents[2]
PAGE = PROJECT / "docs" / "how-to" / "machine-and-heat.md"
TEXTS = "name", "comment"
ADDRESS = re.compile(r", [a-z0-9.-]+\.[a-z]+/\S+$")  # behind a title
DENSITY = 7.85e-6   # kg/mm³, of steel
SECONDS = 3600.0


def machines():
    return {path.stem: json.loads(path.read_text(encoding="utf-8"))
            for path in sorted((PROJECT / "configs" / "machines").glob("*.json"))}


def values(machine):
    return {key: entry["value"] for key, entry in machine.items() if key not in TEXTS}


class MachinesTest(unittest.TestCase):
    def test_every_value_has_a_source(self):
        self.assertGreaterEqual(len(machines()), 5)
        for name, machine in machines().items():
            for key, entry in machine.items():
                with self.subTest(machine=name, entry=key):
                    if key in TEXTS:
                        self.assertGreater(len(entry), 10)
                        continue
                    self.assertLessEqual(set(entry), {"value", "unit", "source"})
                    source = entry["source"]
                    self.assertTrue(source.startswith("assumed") or ADDRESS.search(source), source)

    def test_rate_is_that_of_bead_and_speed(self):
        for name, machine in machines().items():
            found = values(machine)
            made = DENSITY * found["bead_height"] * found["bead_width"] * found["travel_speed"] * SECONDS
            self.assertAlmostEqual(made / found["deposition_rate"], 1.0, delta=0.1, msg=name)

    def test_the_table_says_the_same(self):
        rows = re.findall(r"^\| `(\w+)` \| (\d+)°(?:, [a-z ]+)? \| (.*) \|$", PAGE.read_text(encoding="utf-8"), re.MULTILINE)
        said = {name: [float(tilt), *map(float, re.findall(r"[\d.]+", rest))] for name, tilt, rest in rows}
        held = {}
        for name, machine in machines().items():
            found = values(machine)
            held[name] = [found["tilt"], found["bead_height"], *found["bead_heights"], found["bead_width"],
                          found["deposition_rate"], found["travel_speed"], found["interpass_limit"], *found["plate"]]
        self.assertEqual(said, held)


if __name__ == "__main__":
    unittest.main()
