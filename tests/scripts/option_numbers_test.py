#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""No tool takes a number that its option cannot mean."""

import contextlib
import io
import re
import sys
import unittest
from pathlib import Path
from unittest import mock

from fabseq_tools import entry

PROJECT = Path(__file__).resolve().parents[2]
PACKAGE = PROJECT / "scripts/fabseq_tools"
OPTIONS = {  # words before, and values that are refused
    "paths run --bead-width": ("0", "-1", "nan", "inf", "1e999", "wide"), "paths run --outlines": ("-1", "0", "1.5", "101"),
    "paths run --at": ("-0.1", "1.1", "nan"), "paths run --hatch": ("nan", "inf"), "paths run --speed": ("0", "-1", "inf"),
    "paths run --nominal-height": ("0", "nan"), "import-paths a.csv config --at": ("2", "nan"),
    "import-paths a.csv config --finer": ("0", "9", "1.5"),
    "layers run --finer": ("0", "9", "1.5"), "thickness run --points": ("0", "-5", "99999999"),
    "thickness run --target": ("0", "nan"), "thickness run --seed": ("-1",), "compensate run --factor": ("0", "nan", "3"),
    "compensate run --fill": ("0", "nan", "2"), "compensate run --tolerance": ("0", "inf"),
    "compensate run --iterations": ("0",), "compensate run --ranks": ("0", "-1"),
    "coarsen a b": ("0 0.5", "-2 0.5", "2 0", "2 nan"), "render a b --exaggeration": ("nan", "-1"),
    "render a b --pixels": ("0", "-5"), "scaling a --warm_up": ("-1",), "tradeoff a --points": ("1", "1000"),
    "tradeoff a --iterations": ("0",), "tradeoff a --ranks": ("0",), "compare-families a --step": ("0", "nan"),
    "compare-families a --azimuths": ("0",), "compare-families a --subparts": ("0",), "orient a --output b --ranks": ("0",),
    "calculix a --layer": ("0",), "compare-calculix a b --tolerance": ("0", "nan"), "new a --thickness": ("0", "nan"),
    "new a --iterations": ("0", "2.5")}


class OptionNumbersTest(unittest.TestCase):
    def test_refused_in_a_line(self):
        for words, values in OPTIONS.items():
            for value in values:
                status, text = self.ended([*words.split(), *value.split()])
                self.assertEqual(status, 2, words)
                self.assertRegex(text, r"^fabseq-tools .*: found .*; allowed: .*\n$", words)

    @staticmethod
    def ended(words):
        """Exit status of a command and what it prints to stderr."""
        with mock.patch.object(sys, "argv", ["fabseq-tools", *words]), contextlib.redirect_stderr(io.StringIO()) as text:
            try:
                entry.main()
            except SystemExit as end:
                return end.code, text.getvalue()
        return 0, text.getvalue()

    def test_no_option_takes_any_number(self):
        """Types of options are those of run/command_line.py."""
        for path in PACKAGE.rglob("*.py"):
            if path.parent.name != "calibration":
                found = re.findall(r"add_argument\([^)]*type=(?:float|int)\b", path.read_text(encoding="utf-8"))
                self.assertEqual(found, [], path)


if __name__ == "__main__":
    unittest.main()
