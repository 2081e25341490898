#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""What report and overview say of the program's verdicts: headline, who can be built, what is missed, and
where thicknesses are out of range."""

import os
import tempfile
import unittest
from unittest import mock

import h5py
import numpy as np

from fabseq_tools.plot import overview, render_part
from fabseq_tools.plot.overview_pictures import CHEQUERED, Pictures
from fabseq_tools.report.report import ReportRun, page_of
from fabseq_tools.report.views import views_of
from fabseq_tools.report.words import violation
from fabseq_tools.run.check_words import out_of_thickness
from fabseq_tools.run.misses import worst_misses
from fabseq_tools.run.read_run import Run

import fake_results

WORDS = ["the skin distorts 2.1 times less than in the best buildable baseline (even layers)",
         "skin, rms after the best rigid fit, as built: optimized 0.1 mm, even layers 0.21 mm"]
NO = "no: 25 % of the part is out of thickness (worst 3.1 times the target near [1,1])"


def add_verdicts(folder):
    """Made-up conclusions of the program; elements of the first half of the part are too thick."""
    fake_results.write_run(folder, "plate", np.ones((8, 12)), (3.0, 2.0))
    fake_results.add_checks(folder)

    def conclude(summary):
        summary["baseline_even"] = summary["baseline"]
        for block in ("baseline", "baseline_even", "optimized", "binary"):
            summary[block] = {**summary[block], "verdict": {"buildable": block == "baseline_even",
                                                            "words": "yes" if block == "baseline_even" else NO, "reasons": []}}
        thickness = summary["binary"]["checks"]["local_thickness"]
        thickness.update(largest=9.0, largest_at=[1.5, 0.5], largest_is_meeting=True)
        summary.update(headline={"words": WORDS}, feasible=False,
                       violated={"words": "tilt is 27 % of the part, smoothly counted, allowed at most 0.1 %"})

    fake_results.change(folder, "summary.json", conclude)
    with h5py.File(os.path.join(folder, "result.h5"), "r+") as file:
        file["local_thickness"][:4] = 9.0


class VerdictWords(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        add_verdicts(self.folder)

    def test_report(self):
        page = page_of([ReportRun(self.folder)])
        self.assertIn(f'<p class="headline">{WORDS[0].capitalize()}.</p>', page)
        for words in (f"{WORDS[1].capitalize()}.", f"Buildable on this machine, planar: {NO}.",
                      "Buildable on this machine, even layers: yes.",
                      "Constraint tilt is 27 % of the part, smoothly counted, allowed at most 0.1 %.",
                      "The largest local thickness is 9 mm near [1.5, 0.5]: fronts meet there"):
            self.assertIn(words, page)
        self.assertNotIn("flatters", page)
        self.assertIn('<th scope="row">buildable on this machine</th>', page)

    def test_a_thick_layer_is_none_of_fronts(self):
        def edit(summary):
            summary["binary"]["checks"]["local_thickness"]["largest_is_meeting"] = False

        fake_results.change(self.folder, "summary.json", edit)
        self.assertIn("near [1.5, 0.5]: a thick layer.", page_of([ReportRun(self.folder)]))

    def test_overview(self):
        with mock.patch.object(overview, "draw_sheet") as sheet, mock.patch.object(overview, "Pictures") as pictures:
            pictures.return_value.largest_each = [0.1, 0.2]
            overview.draw_optimization(Run(self.folder), "none.png")
        _, title, sentences, *_ = sheet.call_args.args
        self.assertEqual(title, f"Plate: {WORDS[0]}")
        told = " ".join(sentences)
        for words in (f"{WORDS[1].capitalize()}.", f"Buildable on this machine, optimized: {NO}.", "Constraint tilt is 27 %"):
            self.assertIn(words, told)
        self.assertEqual([elements.sum() for elements in pictures.call_args.args[4]], [0, 48])

    def test_chequers_and_marks(self):
        run = Run(self.folder)
        fake_results.change(self.folder, "config.json", lambda config: config.update(tool={"thickness": [0.01, 500.0]}))
        within, outside = Run(self.folder), out_of_thickness(run, "")
        self.assertTrue(outside.any())
        self.assertFalse(out_of_thickness(within, "").any())
        nothing = np.zeros(outside.shape, bool)
        image = np.pad(np.zeros((4, 4, 3), np.uint8), ((9, 9), (9, 9), (0, 0)), constant_values=255)
        for marked, found in ((outside, True), (nothing, False)):
            with mock.patch.object(render_part, "render", return_value=image) as render:
                drawn = Pictures(run, [run.fields["layer"]], [run.fields["displacement"]], [nothing], [marked])
            colours = render.call_args_list[0].kwargs["face_colours"]
            self.assertEqual(drawn.chequers, found)
            self.assertEqual((colours == CHEQUERED).all(axis=1).any(), found)
        view = next(view for view in views_of(run, {"binary": "optimized"}))
        np.testing.assert_array_equal(view["fields"]["out_of_range"] > 0, outside)
        self.assertIn("% of the part's elements", view["notes"]["out_of_range"])

    def test_misses_of_counts_are_shares(self):
        run = Run(self.folder)
        run.summary["constraints"] = [
            {"type": "tilt", "bounds": [{"sign": 1.0, "bound": 0.001, "scale": 1.0}]},
            {"type": "layer_thickness", "bounds": [{"sign": 1.0, "bound": 1.1, "scale": 1.0},
                                                   {"sign": -1.0, "bound": 0.9, "scale": 1.0}]}]
        run.history = [{"worst_constraint": 5.6, "constraints": [[0.271], [1.05, 0.95]]},
                       {"worst_constraint": 0.1, "constraints": [[0.0001], [1.2, None]]}]
        np.testing.assert_allclose(worst_misses(run), [0.27, 0.1])
        run.summary["constraints"][0]["bounds"][0]["scale"] = 0.01
        np.testing.assert_allclose(worst_misses(run), [27.0, 0.1])
        run.history[0] |= {"iteration": 1, "binary": {"worst_constraint": 4.6, "constraints": [[0.002], [1.0, 1.0]]}}
        run.config["constraints"] = run.summary["constraints"]
        run.summary |= {"best_iteration": 1}
        self.assertAlmostEqual(violation(run, binary=True), 0.1)
        del run.summary["constraints"]
        np.testing.assert_allclose(worst_misses(run), [5.6, 0.1])


if __name__ == "__main__":
    unittest.main()
