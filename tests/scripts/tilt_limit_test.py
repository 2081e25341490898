#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""A machine that may tilt as far as it likes: no table or picture shows a limit that it keeps."""

import os
import tempfile
import unittest

import numpy as np

from fabseq_tools.report.report import ReportRun, page_of
from fabseq_tools.report.tables import check_rows
from fabseq_tools.run.check_words import check_figures, check_sentences
from fabseq_tools.study.figures import columns_of, row_of

import fake_results


class TiltLimitTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        self.limited, self.free = self.run_with("limited", {"max_tilt": 30.0}), self.run_with("free", {"max_tilt": 180.0})

    def run_with(self, name, tool):
        path = os.path.join(self.folder, name)
        os.mkdir(path)
        fake_results.write_run(path, "plate", np.ones((8, 12)), (3.0, 2.0))
        fake_results.add_checks(path)
        fake_results.add_torch(path)
        fake_results.change(path, "config.json", lambda config: config.update(tool=tool))
        return ReportRun(path)

    def rows(self, head, *runs):
        """Of the torch, as HTML."""
        return {words: "".join(cells) for words, cells in check_rows(head["Torch"], [(run, "binary") for run in runs])}

    def test_table_of_a_run(self):
        beyond = "tilted by more than {}, share of the part".format
        rows = self.rows(check_figures(self.limited), self.limited)
        self.assertIn(">33.3<", rows["largest tilt, degrees"])
        self.assertIn(" %<", rows[beyond("30 degrees")])
        rows = self.rows(check_figures(self.free), self.free)
        self.assertEqual(rows["largest tilt, degrees"], "<td>33.3 (no limit)</td>")
        self.assertNotIn(beyond("its limit"), rows)
        self.assertEqual(self.rows(check_figures(), self.run_with("default", {})), self.rows(check_figures(), self.free))

    def test_runs_side_by_side(self):
        rows = self.rows(check_figures(), self.limited, self.free)
        self.assertTrue(rows["largest tilt, degrees"].endswith("<td>33.3 (no limit)</td>"))
        self.assertTrue(rows["tilted by more than its limit, share of the part"].endswith(" %</td><td>–</td>"))

    def test_words(self):
        self.assertIn("is tilted beyond the limit (33.3 of 30 degrees near [1,2]).", " ".join(check_sentences(self.limited)))

    def test_views_of_a_report(self):
        for run, words in ((self.limited, "up to 33.3 degrees\""), (self.free, "up to 33.3 degrees, no limit\"")):
            self.assertIn(words, page_of([run]))

    def test_table_of_a_study(self):
        for run in (self.limited, self.free):
            run.summary["binary"]["verdict"] = {"buildable": True, "class": "buildable", "words": "buildable", "reasons": []}
        limited, free = (row_of(run, 0.2) for run in (self.limited, self.free))
        self.assertGreater(limited["beyond_tilt"], 0.0)
        self.assertIsNone(limited["largest_tilt"])
        self.assertIsNone(free["beyond_tilt"])
        heading, show = columns_of([free])["largest_tilt"]
        self.assertEqual((heading, show(free["largest_tilt"])), ("tilt, no limit", "33.3°"))
        self.assertNotIn("beyond_tilt", columns_of([free]))


if __name__ == "__main__":
    unittest.main()
