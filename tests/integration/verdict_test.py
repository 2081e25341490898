# SPDX-License-Identifier: MIT
"""What the end of a run concludes: which sequences the machine can build, what is compared with what, which
constraint is missed; and the baselines beside the planar layers."""

import math

import numpy as np

import run_fabseq
from read_outputs import read_result
from run_fabseq import BAD_INPUT, FabseqTest, distinct

# A column with an arm: planar layers begin in the air, tilted ones do not, those along the part tilt too far.
CRANE = {"name": "crane", "domain": {"size": [8, 2, 6], "elements": [16, 4, 12], "unit": "mm"},
         "part": {"union": [{"box": {"min": [0, 0, 0], "max": [2, 2, 4]}}, {"box": {"min": [0, 0, 4], "max": [8, 2, 6]}}]},
         "node_sets": {"tip": {"box": {"min": [8, 0, 4], "max": [8, 2, 6]}}},
         "sequence": {"type": "heat", "characteristic_length": 8}, "layers": {"count": 6}, "tool": {"max_tilt": 60},
         "objective": [{"type": "distortion", "nodes": "tip", "after_release": True}],
         "constraints": [{"type": "layer_thickness", "target": 1.5}, {"type": "tilt", "limit": 1e-3}],
         "baseline": {"direction": "best"}}
PLATE = {"name": "plate", "domain": {"size": [4, 2], "elements": [8, 4]}, "part": {"box": {"min": [0, 0], "max": [4, 2]}},
         "sequence": {"type": "heat"}, "layers": {"count": 4}, "objective": [{"type": "distortion", "measure": "layerwise"}]}
BASELINES = ("baseline", "baseline_matched", "baseline_tilted", "baseline_even")


CLASSES = ("buildable", "buildable_but_for_places", "not_buildable")


class VerdictTest(FabseqTest):
    def summary_of(self, config, *options, ranks=1):
        run = self.run_config(ranks, config, *options)
        self.assert_done(run)
        return run, run.json("summary.json")

    def test_one_verdict_for_each(self):
        for ranks in distinct(2, 1):
            run, summary = self.summary_of(CRANE, "-max_iterations", 3, ranks=ranks)
            for block in ("start", "optimized", "binary", *BASELINES):
                self.check_verdict(summary[block])
            self.assertEqual([summary[block]["verdict"]["buildable"] for block in BASELINES], [False, False, True, False])
            self.assertEqual(summary["baseline"]["verdict"]["words"],
                             "not buildable: 11 % of the part begins in the air (first near [2.75,0.25,4.25])")
            self.assertRegex(run.stdout, r"(?m)^  planar .* 0 .* not buildable$")
            self.check_headline(summary)
            for words in summary["headline"]["words"]:
                self.assertIn(words, run.stdout)
            for place in summary["answer"]["places"][:5]:
                self.assertIn(place["words"], run.stdout)
            end = run.stdout[run.stdout.index(summary["headline"]["words"][0]):]
            self.assertLessEqual(end.count("\n"), 20, end)
            self.check_answer(summary)
            self.check_places(run, summary)
            self.check_missed(summary, run)
            self.check_bounds(summary, run)
            data = read_result(run)
            for block, group in (("baseline_tilted", "tilted/"), ("baseline_even", "even/"), ("baseline", "planar/")):
                self.assertEqual(data[group + "layer"].max(), len(summary[block]["layers"]))
                length = np.linalg.norm(data[group + "displacement"], axis=-1).max()
                self.assertAlmostEqual(length / summary[block]["displacement"]["max"], 1)

    def check_verdict(self, block):
        """A reason for each check that finds something, with its share and place, and no other."""
        checks, verdict = block["checks"], block["verdict"]
        failing = {"tilt": checks["tilt"]["share"], "local_thickness": checks["local_thickness"]["share_outside"],
                   "hanging": checks["hanging"]["elements"] / 384}
        failing = {name: share for name, share in failing.items() if share}
        reasons = {reason["name"]: reason for reason in verdict["reasons"]}
        self.assertEqual(verdict["buildable"], not failing)
        self.assertEqual(set(reasons), set(failing))
        for name, share in failing.items():
            self.assertAlmostEqual(reasons[name]["share"], share)
            self.assertEqual(reasons[name]["at"], checks[name]["at"])
            self.assertIn(reasons[name]["words"], verdict["words"])
            self.assertEqual(reasons[name]["words"], block["words"][name][0])
        shares = [reason["share"] for reason in verdict["reasons"]]
        self.assertEqual(shares, sorted(shares, reverse=True))
        if "local_thickness" in reasons:
            worst = checks["local_thickness"]["worst"]
            self.assertIn(worst, (checks["local_thickness"]["least"], checks["local_thickness"]["largest"]))
            self.assertAlmostEqual(reasons["local_thickness"]["worst"], worst / 1.5)

    def check_headline(self, summary):
        headline = summary["headline"]
        skin = {block: summary[block]["finished"]["released"]["skin"]["rms"] for block in ("binary", "start", *BASELINES)}
        can = BASELINES  # the optimized sequence cannot be built: all are of its class or a better one
        self.assertTrue(headline["released"])
        self.assertAlmostEqual(headline["length"], skin["binary"])
        self.assertEqual(headline["baseline"]["block"], min(can, key=skin.get))
        self.assertAlmostEqual(headline["baseline"]["ratio"], min(skin[block] for block in can) / skin["binary"])
        self.assertAlmostEqual(headline["start"]["length"], skin["start"])
        self.assertTrue(headline["words"][0].startswith("not buildable: the skin distorts "), headline["words"][0])

    def check_answer(self, summary):
        answer, headline = summary["answer"], summary["headline"]
        self.assertEqual(answer["class"], summary["binary"]["verdict"]["class"])
        self.assertEqual((answer["gain"], answer["rms"]), (headline["baseline"]["ratio"], headline["length"]))
        self.assertEqual(answer["best_alternative"]["block"], headline["baseline"]["block"])
        self.assertEqual(answer["places"], summary["binary"]["places"])
        self.assertEqual((answer["unit"], answer["released"], answer["repaired"]), ("mm", True, 0))

    def check_places(self, run, summary):
        """They hold the elements that the field `fault` marks, and no other."""
        data = read_result(run)
        for block, group in (("binary", ""), ("baseline", "planar/"), ("start", "start/")):
            places, fault = summary[block]["places"], data[group + "fault"]
            self.assertEqual(summary[block]["places_in_all"], len(places))
            hanging = sum(place["elements"] for place in places if place["kind"] == "hanging")
            self.assertEqual(hanging, summary[block]["checks"]["hanging"]["elements"])
            self.assertEqual(np.count_nonzero(fault == 1), hanging)
            self.assertAlmostEqual(sum(place["share"] for place in places),
                                   sum(reason["share"] for reason in summary[block]["verdict"]["reasons"]))
            self.assertEqual(np.any(fault > 0), not summary[block]["verdict"]["buildable"])
            begins = [place["begins"] for place in places]
            self.assertEqual(begins, sorted(begins, reverse=True))

    def check_bounds(self, summary, run):
        """With them the values of an iterate give its worst violation."""
        thickness, tilt = summary["constraints"]
        self.assertEqual((thickness["type"], thickness["unit"]), ("layer_thickness", "times the target"))
        self.assertEqual([(b["sign"], round(b["bound"], 12), b["scale"]) for b in thickness["bounds"]],
                         [(1.0, 1.1, 1.0), (-1.0, 0.9, 1.0)])
        self.assertEqual((tilt["type"], tilt["unit"]), ("tilt", "share of the part"))
        self.assertEqual(tilt["bounds"], [{"sign": 1.0, "bound": 1e-3, "scale": 1.0}])
        for line in run.history():
            misses = [math.log(line["constraints"][1][0] / 1e-3),
                      max(abs(value - 1) - 0.1 for value in line["constraints"][0])]
            self.assertAlmostEqual(max(misses), line["worst_constraint"])

    def check_missed(self, summary, run):
        missed = summary["violated"]
        self.assertEqual(missed["type"], "tilt")
        value = next(r["value"] for r in summary["optimized"]["responses"] if r["name"] == missed["name"])
        self.assertAlmostEqual(missed["value"], value)
        self.assertAlmostEqual(math.log(value / missed["bound"]), summary["worst_constraint"])
        self.assertIn(f"; constraint {missed['words']}", run.stdout)
        self.assertIn("% of the part, smoothly counted, allowed at most 0.1 %", missed["words"])

    def test_tilted_and_even_layers(self):
        def key(entry):
            return CLASSES.index(entry["class"]), entry["length"]

        thin = {**CRANE, "domain": {**CRANE["domain"], "elements": [16, 3, 12]}}  # too few elements to be halved
        for config, options, elements in ((CRANE, ("-coarse_iterations", 2), [8, 2, 6]), (CRANE, (), [8, 2, 6]),
                                          (thin, (), [16, 3, 12])):
            run, summary = self.summary_of(config, "-max_iterations", 2, *options)
            tilted, tried = summary["baseline_tilted"], summary["baseline_tilted"]["scan"]["directions"]
            self.assertEqual(tilted["scan"]["elements"], elements)
            self.assertEqual(len(tried), 1 + 4 * 8)  # by 15 degrees up to 60
            finalists = tilted["scan"].get("finalists", [])
            self.assertEqual([one["direction"] for one in sorted(tried, key=key)[:len(finalists)]],
                             [one["direction"] for one in finalists])
            self.assertEqual(len(finalists), 0 if config is thin else 3)
            best = min(finalists or tried, key=key)
            self.assertEqual(tilted["direction"], best["direction"])
            self.assertAlmostEqual(best["length"], tilted["finished"]["released"]["skin"]["rms"])
            np.testing.assert_allclose([np.degrees(np.arccos(t["direction"][2])) for t in tried], [t["tilt"] for t in tried],
                                       atol=1e-6)
            self.assertAlmostEqual(tilted["checks"]["tilt"]["largest"], best["tilt"])
        even, layers = summary["baseline_even"], summary["binary"]["layers"]
        thickness = np.average([layer["thickness"] for layer in layers], weights=[layer["volume"] for layer in layers])
        self.assertLess(abs(even["checks"]["local_thickness"]["least"] / thickness - 1), 0.3)
        self.assertEqual(even["checks"]["hanging"]["elements"], 0)
        self.assertEqual(summary["baseline"]["checks"]["tilt"]["largest"], 0)
        self.assertTrue(run.json("config.json")["baseline"]["even"])

    def test_they_are_left_out(self):
        _, summary = self.summary_of({**PLATE, "baseline": {"even": False}}, "-max_iterations", 2)
        self.assertNotIn("baseline_even", summary)
        self.assertNotIn("baseline_tilted", summary)
        self.assertTrue(summary["baseline"]["verdict"]["buildable"])  # only what hangs counts
        self.assertEqual(summary["baseline"]["verdict"]["words"], "buildable")
        self.assertNotIn("violated", summary)

    def test_iterates_that_are_judged(self):
        """By the exact checks of their binary layers, those that constraints of the config count."""
        for type_, check in (("tilt", "tilt"), ("supported", "hanging")):
            config = {**CRANE, "constraints": [CRANE["constraints"][0], {"type": type_}]}
            run, summary = self.summary_of(config, "-max_iterations", 3, "-set", "optimizer.binary_iterations=2")
            judged = [line.get("binary") for line in run.history()]
            self.assertIsNone(judged[0])
            shares = {reason["name"]: reason["share"] for reason in summary["binary"]["verdict"]["reasons"]}
            best = judged[summary["best_iteration"] - 1]
            self.assertAlmostEqual(best["beyond_limits"], shares.get(check, 0.0), places=12)
        run, _ = self.summary_of(PLATE, "-max_iterations", 2, "-set", "optimizer.binary_iterations=1")
        self.assertNotIn("beyond_limits", run.history()[1]["binary"])

    def test_a_scaled_drawing(self):
        """The drawing takes a part of the distortion away, and the headline says so where it does more."""
        process = {"deposition": "nominal", "void": "absent"}
        _, summary = self.summary_of({**PLATE, "process": process}, "-max_iterations", 2)
        for block in ("baseline", "binary"):
            built = summary[block]["finished"]["as_built"]
            self.assertLessEqual(built["scaled_drawing"]["rms"], built["skin"]["rms"])
            self.assertGreater(built["scaled_drawing"]["factor"], 1.0)  # the part shrinks
        found = summary["headline"].get("scaled_drawing")
        if found:
            self.assertLess(found["length"], summary["headline"]["length"])
            self.assertIn("a drawing that is scaled by", summary["headline"]["words"][-1])

    def test_the_displacement_of_a_simulation(self):
        """Skin and scaled drawing are those of the displacements in the file."""
        config = {**CRANE, "sequence": {"type": "planar"}, "constraints": [], "layers": {"count": 4}}
        run = self.run_config(1, config, "-task", "simulate")
        self.assert_done(run)
        self.assertIn("not buildable: ", run.stdout)
        data, built = read_result(run), run.json("summary.json")["finished"]["as_built"]
        part = np.pad(data["density"] > 0, 1)
        around = sum(part[tuple(slice(o, o + n + 1) for o, n in zip(offset, data["density"].shape))].astype(int)
                     for offset in np.ndindex(2, 2, 2))
        skin = np.argwhere((around > 0) & (around < 8))
        moved, x = data["displacement"][tuple(skin.T)], skin[:, ::-1] * 0.5
        x = x - x.mean(axis=0)
        rigid = np.array([np.tile(row, (len(x), 1)) for row in np.eye(3)] + [np.cross(row, x) for row in np.eye(3)])
        rigid = rigid.reshape(6, -1)
        left = moved.ravel() - rigid.T @ np.linalg.lstsq(rigid.T, moved.ravel(), rcond=None)[0]
        self.assertAlmostEqual(built["skin"]["rms"] / np.sqrt((left**2).sum() / len(x)), 1, places=6)
        growth = left @ x.ravel() / (x**2).sum()
        self.assertAlmostEqual(built["scaled_drawing"]["factor"], 1 - growth, places=9)
        rest = left - growth * x.ravel()
        self.assertAlmostEqual(built["scaled_drawing"]["rms"] / np.sqrt((rest**2).sum() / len(x)), 1, places=6)

    def test_bad_input(self):
        for value in ("worst", [0, 0], [1, 0, 0]):
            run = self.run_config(1, {**PLATE, "baseline": {"direction": value}})
            self.assertEqual(run.status, BAD_INPUT, run)
            self.assertIn("/baseline/direction", run.stderr)
        run = self.run_config(1, {**PLATE, "baseline": {"even": 3}})
        self.assertEqual(run.status, BAD_INPUT, run)
        self.assertIn("/baseline/even", run.stderr)


if __name__ == "__main__":
    run_fabseq.main()
