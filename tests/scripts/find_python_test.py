# SPDX-License-Identifier: MIT
"""Tools and scripts that are started with a Python without NumPy and the rest find one that has them, or say
what is missing."""

import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from fabseq_tools.entry import find_commands
from fabseq_tools.find_python import PACKAGES

PROJECT = Path(__file__).resolve().parents[2]
TOOLS = "scripts/fabseq-tools"
WITHOUT_PACKAGES = ["virtual-display"]  # commands


def starts():
    """The words that start all tools and scripts which use packages."""
    for command in find_commands():
        if command not in WITHOUT_PACKAGES:
            yield [TOOLS, command]
    for folder in ("scripts/use", "benchmarks/evidence/figures"):
        for path in sorted((PROJECT / folder).glob("*.py")):
            if os.access(path, os.X_OK):
                yield [str(path.relative_to(PROJECT))]


class FindPythonTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.bare = self.python("bare", f'exec {sys.executable} -S "$@"')  # without the folder of Debian's packages

    def python(self, name, line):
        path = self.folder / name
        path.write_text(f"#!/bin/sh\n{line}\n", encoding="utf-8")
        path.chmod(0o755)
        return path

    def start(self, python, *words, **environment):
        inherited = {key: value for key, value in os.environ.items() if key not in ("FABSEQ_PYTHON", "PYTHONPATH")}
        return subprocess.run([python, *words], capture_output=True, text=True, check=False, cwd=PROJECT,
                              env={**inherited, **environment})

    def test_the_bare_python_is_bare(self):
        for package in PACKAGES:
            self.assertNotEqual(self.start(self.bare, "-c", f"import {package}").returncode, 0)

    def test_every_tool_asks_for_another(self):
        """Before it does anything else, even for --help."""
        named = self.python("named", 'echo started "$@"')
        for words in starts():
            done = self.start(self.bare, *words, "--help", FABSEQ_PYTHON=str(named))
            self.assertEqual((done.returncode, done.stdout, done.stderr), (0, f"started {' '.join(words)} --help\n", ""))
            self.assertEqual((PROJECT / words[0]).read_text(encoding="utf-8").splitlines()[0], "#!/usr/bin/python3")

    def test_the_list_of_commands_needs_no_packages(self):
        done = self.start(self.bare, TOOLS, "--help", FABSEQ_PYTHON=str(self.folder / "none"))
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        for command in find_commands():
            self.assertRegex(done.stdout, rf"(?m)^  {command} +\w")

    def test_tools_without_packages_stay_in_this_python(self):
        for command in WITHOUT_PACKAGES:
            done = self.start(self.bare, TOOLS, command, "--help", FABSEQ_PYTHON=str(self.folder / "none"))
            self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_the_other_python_runs_the_tool(self):
        done = self.start(self.bare, TOOLS, "coarsen", "no such file.h5", "out.h5", "2", "0.5")
        self.assertEqual(done.returncode, 2)
        self.assertRegex(done.stderr, r"^fabseq-tools coarsen: .*no such file\.h5")

    def test_the_other_python_runs_the_package(self):
        done = self.start(self.bare, "-m", "fabseq_tools", "coarsen", "no such file.h5", "out.h5", "2", "0.5",
                          PYTHONPATH=str(PROJECT / "scripts"))
        self.assertRegex(done.stderr, r"^fabseq-tools coarsen: .*no such file\.h5")

    def test_none_that_will_do(self):
        for other, words in ((self.bare, f"in {sys.executable}"), (self.folder / "none", "none does not start")):
            done = self.start(self.bare, TOOLS, "report", "run", FABSEQ_PYTHON=str(other))
            self.assertEqual((done.returncode, done.stdout), (1, ""))
            self.assertEqual(len(done.stderr.splitlines()), 1)
            for word in ("fabseq-tools: ", words, "FABSEQ_PYTHON", *PACKAGES, *PACKAGES.values()):
                self.assertIn(word, done.stderr)

    def test_a_module_of_another_program(self):
        """It gets the error of any import, and is not started again."""
        done = self.start(self.bare, "-c", "from fabseq_tools.run import read_run", PYTHONPATH=str(PROJECT / "scripts"))
        self.assertIn("No module named 'h5py'", done.stderr)


if __name__ == "__main__":
    unittest.main()
