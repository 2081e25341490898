# SPDX-License-Identifier: MIT
"""The scaling model counts the messages that the program sends, and says what an iteration is made of."""

import os

import run_fabseq
from run_fabseq import DONE, PROGRAM, ROOT, FabseqTest, only_release, run_command


@only_release
class ScalingModelTest(FabseqTest):
    def run_model(self, *arguments):
        plan = os.path.join(os.path.dirname(PROGRAM), "benchmarks", "scaling_plan")
        command = ["env", "PYTHONPATH=scripts", "/usr/bin/python3", "-m", "benchmarks.evidence.scaling", *map(str, arguments),
                   "--plan", plan]
        status, stdout, stderr = run_command(command, ROOT, 300)
        self.assertEqual(status, DONE, stdout + stderr)
        return stdout

    def test_messages_are_those_of_the_model(self):
        """Between neighbours, on coarse levels that all hold, and between groups."""
        printed = self.run_model("check", "--program", PROGRAM, "--cases", "v_shape", "--splits", "1x3", "2x2")
        self.assertEqual(printed.count("as the model says"), 2)
        self.assertNotIn("NOT", printed)

    def test_what_an_iteration_is_made_of(self):
        """A network that takes no time spends less on messages; twice the ranks compute less each."""
        free = [word for name in ("latency", "overhead") for word in ("--" + name, "0")]

        def totals(*options):
            lines = self.run_model("parts", "--case", "v_shape", "--splits", "1x1", "1x2", *options).splitlines()
            self.assertRegex(lines[0], "^Measured on .* assumed")
            return [[float(word) for word in line.split()[1:]] for line in lines if line.split()[:1] == ["total"]]

        (alone, pair), (_, quick) = totals(), totals(*free)
        self.assertEqual(alone[2:4], [0.0, 0.0])
        self.assertGreater(pair[2], quick[2])
        self.assertLess(pair[0], 0.7 * alone[0])
        for line in (alone, pair, quick):
            self.assertAlmostEqual(sum(line[:4]), line[4], places=4)


if __name__ == "__main__":
    run_fabseq.main()
