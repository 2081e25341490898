# SPDX-License-Identifier: MIT
"""What tests of fabseq-tools new have in common."""

import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from run_fabseq import PROGRAM

PROJECT = Path(__file__).resolve().parents[2]
TOOLS = PROJECT / "scripts/fabseq-tools"


class NewConfigCase(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def path(self, name):
        return os.path.join(self.folder, name)

    def run_new(self, part, *words, status=0):
        """What it prints, in the folder; with another status than 0 its one line."""
        done = subprocess.run([sys.executable, TOOLS, "new", part, *words], capture_output=True, text=True, check=False,
                              cwd=self.folder, env=os.environ | {"FABSEQ_PROGRAM": PROGRAM})
        self.assertEqual(done.returncode, status, done.stderr)
        self.warnings = "".join(line for line in done.stderr.splitlines(True) if not line.startswith("new: "))  # no progress
        if status:
            self.assertEqual((done.stdout, self.warnings.count("\n")), ("", 1), done.stderr)
            return self.warnings
        return done.stdout

    def check(self, config):
        """What the program says of a config."""
        return subprocess.run([PROGRAM, "-config", config, "-task", "check"], capture_output=True, text=True, check=False,
                              cwd=self.folder)
