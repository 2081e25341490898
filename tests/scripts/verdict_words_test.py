#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""What tools say of the program's verdicts: who can be built, at which places not, what is gained, missed."""

import os
import tempfile
import unittest

import h5py
import numpy as np

from fabseq_tools.geometry.judged import Judged
from fabseq_tools.report.report import ReportRun, page_of
from fabseq_tools.report.words import violation
from fabseq_tools.run import verdict_words as verdicts
from fabseq_tools.run.answer_figures import figures_of
from fabseq_tools.run.check_words import check_figures, check_sentences, thickness_limits
from fabseq_tools.run.misses import worst_misses
from fabseq_tools.run.read_run import Run

import fake_places
import fake_results

WORDS = ["the skin distorts 2.1 times less than in even layers",
         "skin, rms after the best rigid fit, as built: optimized 0.1 mm, even layers 0.21 mm"]
MANY = "buildable but for 2 places"
AIR = "25 % of the part begins in the air (first near [1,1])"
OUTSIDE = "25 % of the part is out of thickness (worst where fronts meet near [1.5,0.5])"
MEETING = "the largest local thickness is 9 mm near [1.5,0.5]: fronts meet there"
EVEN = {"block": "baseline_even", "title": "even layers", "class": "buildable", "rms": 0.2, "largest": 2.0}
PLACE = {"kind": "hanging", "words": "a roof of 12 x 3 mm near [1,2] begins in the air in layer 7: close it and drill"}


def finished(rms, largest):
    return {"as_built": {"skin": {"rms": rms, "max": largest}}, "released": None}


def add_verdicts(folder):
    """Made-up conclusions of the program: planar layers are not buildable, even ones are, optimized ones are
    but for two places."""
    fake_results.write_run(folder, "plate", np.ones((8, 12)), (3.0, 2.0))
    fake_results.add_checks(folder)

    def conclude(summary):
        summary["baseline_even"] = dict(summary["baseline"])
        told = {"baseline": ("not_buildable", f"not buildable: {AIR}"), "baseline_even": ("buildable", "buildable"),
                "binary": ("buildable_but_for_places", MANY)}
        for number, (block, (kind, words)) in enumerate(told.items()):
            reasons = [{"name": "hanging", "words": AIR}] if kind == "not_buildable" else []
            verdict = {"buildable": kind == "buildable", "class": kind, "words": words, "reasons": reasons}
            summary[block].update(verdict=verdict, places=[], places_in_all=0,
                                  finished=finished([0.3, 0.2, 0.1][number], 3.0 - number))
        summary["binary"].update(places=[PLACE], places_in_all=2)
        summary["answer"] = {
            "class": "buildable_but_for_places", "gain": 2.0, "rms": 0.1, "largest": 1.0, "unit": "mm", "released": False,
            "places": [PLACE], "repaired": 0,
            "best_alternative": EVEN}
        summary["binary"]["verdict"]["reasons"] = [{"name": "local_thickness", "words": OUTSIDE}]
        summary["binary"]["words"] |= {"local_thickness": [OUTSIDE, MEETING], "late_sets": [WORDS[1]]}
        summary.update(headline={"words": WORDS}, feasible=False,
                       violated={"words": "tilt is 27 % of the part, smoothly counted, allowed at most 0.1 %"})

    fake_results.change(folder, "summary.json", conclude)


class VerdictWords(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        add_verdicts(self.folder)

    def edited(self, **answer):
        fake_results.change(self.folder, "summary.json", lambda summary: summary["answer"].update(answer))
        return Run(self.folder)

    def test_in_short(self):
        run = Run(self.folder)
        self.assertEqual([verdicts.buildable(run, state) for state in ("baseline", "baseline_even", "binary", "optimized")],
                         ["not buildable", "buildable", MANY, None])
        self.assertEqual(verdicts.answer_words(run), MANY.capitalize())
        self.assertEqual(sorted(["x", "not_buildable", None, "buildable", "buildable_but_for_places"], key=verdicts.rank)[:3],
                         list(verdicts.CLASSES))

    def test_lines_begin_with_the_verdict(self):
        run = Run(self.folder)
        for of, lines in (("optimized", [MANY, f"  {PLACE['words']}", "  and 1 more place"]),
                          ("planar", [f"not buildable: {AIR}"]), ("start", ["not judged by this run"])):
            with h5py.File(os.path.join(self.folder, "result.h5")) as file:
                group = {"planar": "planar/"}.get(of, "")
                self.assertEqual(Judged(run, file, group, of).words().splitlines(), lines)

    def test_gain(self):
        for answer, words in (
                ({}, "The skin distorts 2.0 times less than in the best alternative, even layers (buildable)."),
                ({"gain": 0.5}, "The skin distorts 2.0 times more than in the best alternative, even layers (buildable)."),
                ({"gain": 1.01, "class": "buildable"},
                 "The skin distorts about as much as in the best alternative, even layers."),
                ({"gain": None}, "No alternative of this class."),
                ({"gain": None, "best_alternative": None}, "No alternative of this class.")):
            self.assertEqual(verdicts.gain_words(self.edited(**answer)), words)
        run = Run(self.folder)
        run.summary.pop("answer")
        self.assertEqual(verdicts.gain_words(run), "")

    def test_figures(self):
        planar, best, ours = figures_of(Run(self.folder))
        self.assertEqual([(one.rms, one.largest, one.verdict) for one in (planar, best, ours)],
                         [(0.3, 3.0, "not buildable"), (0.2, 2.0, "buildable"), (0.1, 1.0, MANY)])
        self.assertEqual(best.title, "Best alternative: even layers")
        self.assertIn(("build time", "1.5 h"), planar.more)
        self.assertTrue(ours.is_ours)
        planar = {"block": "baseline", "title": "planar layers", "class": "not_buildable", "rms": 0.3, "largest": 3.0}
        self.assertEqual([one.title for one in figures_of(self.edited(best_alternative=planar))],
                         ["Planar layers, as today, and the best alternative", "Optimized layers"])
        _, none, _ = figures_of(self.edited(best_alternative=None))
        self.assertEqual((none.title, none.rms, none.more), ("No alternative of this class", None,
                                                             [("even layers:", "buildable, 0.2 mm")]))

    def test_released_figures(self):
        def release(summary):
            summary["answer"]["released"] = True
            summary["baseline"]["finished"]["released"] = {"skin": {"rms": 7.0, "max": 8.0}}

        fake_results.change(self.folder, "summary.json", release)
        self.assertEqual(figures_of(Run(self.folder))[0].rms, 7.0)

    def test_sentences_of_the_report(self):
        page = page_of([ReportRun(self.folder)])
        self.assertIn(f'<p class="headline">{WORDS[0].capitalize()}.</p>', page)
        for words in (f"{WORDS[1].capitalize()}.", f"Planar: not buildable: {AIR}.", "Even layers: buildable.",
                      "Constraint tilt is 27 % of the part, smoothly counted, allowed at most 0.1 %.",
                      f"{MEETING.capitalize()}.", "Residual stress, without plastic flow: up to 300, above"):
            self.assertIn(words, page)
        self.assertEqual(page.count(WORDS[1].capitalize()), 1)
        self.assertIn('<th scope="row">verdict</th>', page)

    def test_sentences_of_findings(self):
        """Those that neither headline nor verdict tell; of stress where the config asks for it."""
        meeting, stress = sorted(check_sentences(Run(self.folder)), reverse=True)
        self.assertEqual(meeting, f"{MEETING.capitalize()}.")
        self.assertTrue(stress.startswith("Residual stress, without plastic flow"))
        fake_results.change(self.folder, "config.json", lambda config: config.update(output={"stress": False}))
        self.assertEqual(check_sentences(Run(self.folder)), [meeting])
        fake_results.change(self.folder, "summary.json", lambda summary: summary["binary"]["words"].update(other=["found new"]))
        self.assertEqual(check_sentences(Run(self.folder)), [meeting, "Found new."])

    def test_real_layers(self):
        """What the verdict goes by comes first; the range of thickness is a bead's, as the figures are."""
        real = {"words": "judged by 12 real layers", "lumping": {"words": "spread by lumping: 1 mm"}}
        fake_results.change(self.folder, "summary.json", lambda summary: summary["binary"].update(real_layers=real))
        fake_results.change(self.folder, "config.json", lambda config: config.update(
            layers={"count": 4, "passes": 3, "target": 2.0}, tool={"thickness": [0.5, 1.5]}))
        run = Run(self.folder)
        self.assertEqual(check_sentences(run)[:2], ["Judged by 12 real layers.", "Spread by lumping: 1 mm."])
        self.assertIn("local thickness outside 1 to 3, share of the part", check_figures(run)[""])
        self.assertEqual(thickness_limits(run), [3.0, 9.0])

    def test_faults_are_named_as_in_the_files(self):
        """Numbers in the field, names in summary.json."""
        self.assertEqual(fake_places.KINDS, ["hanging", "local_thickness", "tilt", "blocked"])

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
