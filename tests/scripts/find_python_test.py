# SPDX-License-Identifier: MIT
"""Scripts that are started with a Python without NumPy and the rest find one that has them, or say what is
missing."""

import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

PROJECT = Path(__file__).resolve().parents[2]
PACKAGES = ("numpy", "h5py", "matplotlib", "PIL", "vtkmodules")


def scripts():
    """All that are started by themselves and use packages."""
    found = [path for folder in ("use", "figures", "slurm") for path in sorted((PROJECT / "scripts" / folder).glob("*.py"))
             if os.access(path, os.X_OK)]
    return [path for path in found if path.name not in ("virtual_display.py", "study_table.py")]  # these use none


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

    def start(self, python, script, *arguments, **environment):
        inherited = {key: value for key, value in os.environ.items() if key not in ("FABSEQ_PYTHON", "PYTHONPATH")}
        return subprocess.run([python, script, *arguments], capture_output=True, text=True, check=False, cwd=PROJECT,
                              env={**inherited, **environment})

    def test_the_bare_python_is_bare(self):
        for package in PACKAGES:
            self.assertNotEqual(self.start(self.bare, "-c", f"import {package}").returncode, 0)

    def test_every_script_asks_for_another(self):
        """Before it does anything else, even for --help."""
        named = self.python("named", 'echo started "$@"')
        for script in scripts():
            name = str(script.relative_to(PROJECT))
            done = self.start(self.bare, name, "--help", FABSEQ_PYTHON=str(named))
            self.assertEqual((done.returncode, done.stdout, done.stderr), (0, f"started {name} --help\n", ""))
            self.assertEqual(script.read_text(encoding="utf-8").splitlines()[0], "#!/usr/bin/python3")

    def test_the_other_python_runs_the_script(self):
        done = self.start(self.bare, "scripts/use/coarsen_part.py", "no such file.h5", "out.h5", "2", "0.5")
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, r"^coarsen_part.py: .*no such file\.h5")

    def test_none_that_will_do(self):
        for other, words in ((self.bare, f"in {sys.executable}"), (self.folder / "none", "none does not start")):
            done = self.start(self.bare, "scripts/use/report.py", "run", FABSEQ_PYTHON=str(other))
            self.assertEqual((done.returncode, done.stdout), (1, ""))
            self.assertEqual(len(done.stderr.splitlines()), 1)
            for word in ("report.py: ", words, "python3-h5py", "FABSEQ_PYTHON", *PACKAGES):
                self.assertIn(word, done.stderr)

    def test_a_module_of_another_program(self):
        """It gets the error of any import, and is not started again."""
        done = self.start(self.bare, "-c", "import sys; sys.path.insert(0, 'scripts/use')\nimport read_run")
        self.assertIn("No module named 'h5py'", done.stderr)


if __name__ == "__main__":
    unittest.main()
