#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""scripts/dev/reference_table.py with a stand-in for the program."""

import subprocess
import tempfile
import unittest
from pathlib import Path

SCRIPT = Path(__file__).resolve().parents[2] / "scripts/dev/reference_table.py"
GUIDE = "# Guide\n<!-- reference table -->\n{}\n<!-- end of reference table -->\nThe rest.\n"
TABLE = "| key | default |\n| --- | --- |\n| `a` | 1 |"


class ReferenceTable(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.guide = Path(folder.name) / "guide.md"
        self.program = Path(folder.name) / "program"
        self.program.write_text(
            f'#!/bin/sh\n[ "$1" = -help_markdown ] || exit 2\ncat <<\'END\'\n{TABLE}\nEND\n', encoding="utf-8")
        self.program.chmod(0o755)

    def run_script(self, *options):
        return subprocess.run(["/usr/bin/python3", SCRIPT, *options, self.program, self.guide], capture_output=True, text=True)

    def test_an_equal_table_passes(self):
        self.guide.write_text(GUIDE.format(TABLE), encoding="utf-8")
        self.assertEqual(self.run_script().returncode, 0)

    def test_a_stale_table_fails_with_a_diff_and_write_mends_it(self):
        self.guide.write_text(GUIDE.format(TABLE.replace("1", "2")), encoding="utf-8")
        stale = self.run_script()
        self.assertEqual(stale.returncode, 1)
        self.assertIn("+| `a` | 1 |", stale.stdout)
        self.assertEqual(self.run_script("--write").returncode, 0)
        self.assertEqual(self.guide.read_text(encoding="utf-8"), GUIDE.format(TABLE))
        self.assertEqual(self.run_script().returncode, 0)

    def test_missing_marks_and_a_failing_program_are_named(self):
        self.guide.write_text("# Guide\n", encoding="utf-8")
        self.assertIn("once each", self.run_script().stderr)
        self.guide.write_text(GUIDE.format(TABLE), encoding="utf-8")
        self.program.write_text("#!/bin/sh\nexit 3\n", encoding="utf-8")
        failing = self.run_script()
        self.assertEqual(failing.returncode, 1)
        self.assertIn("status 3", failing.stderr)


if __name__ == "__main__":
    unittest.main()
