# SPDX-License-Identifier: MIT
"""What the tests of the Python module share: programs of Python that find it."""

import os
import textwrap
import unittest

import run_fabseq
from run_fabseq import DONE, FabseqTest, ROOT, launcher

BUILD = os.environ.get("FABSEQ_BUILD", os.path.join(ROOT, "build", "release"))
FOLDER = os.path.join(BUILD, "python")
WHICH_IS_BUILT = unittest.skipIf(os.environ.get("FABSEQ_PYTHON") == "0", run_fabseq.OF_THIS_BUILD + "it has no Python module")


@run_fabseq.only_release
@WHICH_IS_BUILT
class PythonModuleTest(FabseqTest):
    def run_python(self, ranks, *arguments):
        """Status, stdout and stderr of a program of Python that finds the module."""
        environment = {"PYTHONPATH": FOLDER}
        command = [*launcher(ranks), "/usr/bin/python3", *arguments]
        with run_fabseq.Process(command, self.directory, environment) as process:
            return process.wait(300)

    def output_of(self, ranks, *arguments):
        status, stdout, stderr = self.run_python(ranks, *arguments)
        self.assertEqual(status, DONE, f"{arguments}\n{stdout}{stderr}")
        return stdout

    def run_lines(self, ranks, text):
        """What a program prints, of which only its first rank does."""
        return self.output_of(ranks, "-c", "import fabseq\n" + textwrap.dedent(text)).splitlines()
