# SPDX-License-Identifier: MIT
"""The end of an optimization mends the layers where they still fail checks, and judges them again."""

import numpy as np

import run_fabseq
from read_outputs import read_result
from run_fabseq import BAD_INPUT, FabseqTest, distinct
from small_parts import v_2d


def leaning(**optimizer):
    """Guided layers, a few elements of which are too thick after so few iterations."""
    config = v_2d()
    del config["objective"][1], config["constraints"][0]["tolerance"]
    return config | {"sequence": {"type": "guided", "max_tilt": 50}, "tool": {"thickness": [0.2, 1.2]},
                     "optimizer": {"binary_iterations": 1, **optimizer}}


class RepairTest(FabseqTest):
    def test_end_of_an_optimization(self):
        """The block `repair` tells what was there; all else is of the mended layers. On any ranks alike."""
        left = self.optimize(leaning(), 1, 10)
        before = left.json("summary.json")["binary"]
        self.assertFalse(before["verdict"]["buildable"])
        moved = []
        for ranks in distinct(1, 2):
            run = self.optimize(leaning(repair_iterations=1, repair_share=0.1), ranks, 10)
            summary, fields = run.json("summary.json"), read_result(run)
            repair, binary = summary["repair"], summary["binary"]
            self.assertEqual(repair["before"]["places_in_all"], before["places_in_all"])
            self.assertAlmostEqual(repair["before"]["rms"] / before["finished"]["as_built"]["skin"]["rms"], 1, delta=1e-3)
            self.assertTrue(binary["verdict"]["buildable"])
            self.assertEqual((summary["answer"]["class"], summary["answer"]["repaired"]), ("buildable", repair["repaired"]))
            self.assertGreaterEqual(repair["repaired"], len(repair["moved"]))
            self.assertFalse(np.any(fields["hanging"]) or np.any(fields["fault"]))
            for one in repair["moved"]:
                self.assertEqual(fields["layer"][tuple(one["element"][::-1])], one["to"])
            self.assertIn("repair: ", run.stdout)
            moved.append(repair["moved"])
            again = self.run_config(ranks, run.path("config.json"), "-task", "simulate", "-sequence", run.path("result.h5"),
                                    "-binary")
            self.assert_done(again)
            self.assertEqual(again.json("summary.json")["verdict"], binary["verdict"])
            np.testing.assert_array_equal(read_result(again)["layer"], fields["layer"])
        self.assertEqual(moved[0], moved[-1])

    def test_nothing_is_repaired_unasked_or_beyond_its_share(self):
        for optimizer in ({}, {"repair_iterations": 1, "repair_share": 0.0}):
            run = self.optimize(leaning(**optimizer), 1, 10)
            summary = run.json("summary.json")
            self.assertNotIn("repair", summary)
            self.assertEqual(summary["answer"]["repaired"], 0)

    def test_simulation_that_keeps_its_layers(self):
        """All that it tells is as without the option."""
        run = self.optimize(leaning(), 1, 10)
        design = "-design", run.path("result.h5"), "-set", "optimizer.repair_share=0"
        plain, asked = (self.simulate(leaning(), *design, *option) for option in ([], ["-repair"]))
        expected, found = (one.json("summary.json") for one in (plain, asked))
        for name in ("residual_stress", "layer_displacement_norms", "verdict", "finished"):
            self.assertEqual(found[name], expected[name], name)
        np.testing.assert_array_equal(read_result(asked)["residual_stress"], read_result(plain)["residual_stress"])

    def test_option_without_simulation(self):
        run = self.run_config(1, leaning(), "-task", "check", "-repair")
        self.assertEqual(run.status, BAD_INPUT)
        self.assertIn("-repair: it mends the layers of what -task simulate simulates; allowed: with -task simulate", run.stderr)


if __name__ == "__main__":
    run_fabseq.main()
