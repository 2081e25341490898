#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""docs/fabseq.1 and scripts/dev/man_page.py, which makes it."""

import os
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SCRIPT, PAGE = ROOT / "scripts/dev/man_page.py", ROOT / "docs/fabseq.1"
PROGRAM = os.environ.get("FABSEQ_PROGRAM", ROOT / "build/release/fabseq")


class ManPage(unittest.TestCase):
    def run_script(self, *arguments):
        return subprocess.run([sys.executable, SCRIPT, *arguments], capture_output=True, text=True)

    def test_every_option_of_help_is_there(self):
        text = subprocess.run([PROGRAM, "-help"], stdout=subprocess.PIPE, text=True, check=True).stdout
        options = re.findall(r"^  (-\w+)", text.split("\nConfig keys:")[0], flags=re.MULTILINE)
        self.assertGreater(len(options), 50)
        page = PAGE.read_text(encoding="utf-8").replace("\\-", "-")
        self.assertEqual([option for option in [*options, "-version", "-help_markdown"] if f"\\fB{option}\\fP" not in page], [])

    def test_a_stale_page_fails_with_a_diff_and_write_mends_it(self):
        with tempfile.TemporaryDirectory() as folder:
            page = Path(folder) / "fabseq.1"
            text = PAGE.read_text(encoding="utf-8")
            page.write_text(text.replace("\\-layers", "\\-levels"), encoding="utf-8")
            stale = self.run_script(PROGRAM, page)
            self.assertEqual(stale.returncode, 1)
            self.assertIn("+\\fB\\-layers\\fP", stale.stdout)
            self.assertIn("--write", stale.stderr)
            self.assertEqual(self.run_script("--write", PROGRAM, page).returncode, 0)
            self.assertEqual(page.read_text(encoding="utf-8"), text)


if __name__ == "__main__":
    unittest.main()
