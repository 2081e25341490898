#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Words about how far a command has come: one line on a terminal, one every ten seconds elsewhere."""

import io
import unittest

from fabseq_tools.run.progress import Progress


class Terminal(io.StringIO):
    def isatty(self):
        return True


class Clock:
    """It goes on by `step` seconds with every look."""

    def __init__(self, step):
        self.now, self.step = 0.0, step

    def __call__(self):
        self.now += self.step
        return self.now


class ProgressTest(unittest.TestCase):
    def said(self, stream, step, count):
        with Progress("layers", stream, Clock(step)) as progress:
            self.assertEqual(list(progress.steps("abcdefghijkl"[:count], "layer")), list("abcdefghijkl"[:count]))
        return stream.getvalue()

    def test_file(self):
        self.assertEqual(self.said(io.StringIO(), 0.5, 12), "")
        self.assertEqual(self.said(io.StringIO(), 4.0, 6), "layers: layer 3 of 6\nlayers: layer 6 of 6\n")

    def test_terminal(self):
        """The line is gone in the end."""
        self.assertEqual(self.said(Terminal(), 0.05, 12), "")
        text = self.said(Terminal(), 0.5, 12)
        self.assertIn("\rlayers: layer 12 of 12", text)
        self.assertTrue(text.endswith("\r" + " " * len("layers: layer 12 of 12") + "\r"), repr(text))
        self.assertNotIn("\n", text)


if __name__ == "__main__":
    unittest.main()
