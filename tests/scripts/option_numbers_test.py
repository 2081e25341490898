#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""No tool takes a number that its option cannot mean."""

import re
import subprocess
import unittest
from pathlib import Path

PROJECT = Path(__file__).resolve().parents[2]
PACKAGE = PROJECT / "scripts/fabseq_tools"
OPTIONS = {  # words before, and values that are refused
    "paths run --bead-width": ("0", "-1", "nan", "inf", "1e999", "wide"), "paths run --outlines": ("-1", "0", "1.5", "101"),
    "paths run --at": ("-0.1", "1.1", "nan"), "paths run --hatch": ("nan", "inf"), "paths run --speed": ("0", "-1", "inf"),
    "paths run --nominal-height": ("0", "nan"), "import-paths a.csv config --at": ("2", "nan"),
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
        code = ("import contextlib, io, sys\nsys.path.insert(0, sys.argv[1])\nfrom fabseq_tools import entry\n"
                "for line in sys.stdin:\n    words, text = line.split(), io.StringIO()\n    sys.argv = ['fabseq-tools', *words]\n"
                "    try:\n        with contextlib.redirect_stderr(text):\n            entry.main()\n        status = 0\n"
                "    except SystemExit as ended:\n        status = ended.code\n"
                "    print(status, text.getvalue().count('\\n'), text.getvalue().replace('\\n', ' '))\n")
        asked = [f"{words} {value}" for words, values in OPTIONS.items() for value in values]
        done = subprocess.run(["/usr/bin/python3", "-c", code, PROJECT / "scripts"], input="\n".join(asked) + "\n",
                              capture_output=True, text=True, check=True).stdout
        for words, line in zip(asked, done.splitlines(), strict=True):
            self.assertRegex(line, r"^2 1 fabseq-tools .*: found .*; allowed: ", words)

    def test_no_option_takes_any_number(self):
        """Types of options are those of run/command_line.py."""
        for path in PACKAGE.rglob("*.py"):
            if path.parent.name != "calibration":
                found = re.findall(r"add_argument\([^)]*type=(?:float|int)\b", path.read_text(encoding="utf-8"))
                self.assertEqual(found, [], path)


if __name__ == "__main__":
    unittest.main()
