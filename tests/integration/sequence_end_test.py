# SPDX-License-Identifier: MIT
"""How a sequence ends: without slivers after the last layer, and judged by its binary layers."""

import run_fabseq
from run_fabseq import FabseqTest
from small_parts import plate_2d


def wedge():
    """A part that runs out in a tip, with more layers than it has room for."""
    config = plate_2d()
    config["part"] = {"polygon": {"points": [[0, 0], [2, 0], [0.5, 1.2], [0.4, 1.2]]}}
    config["node_sets"]["top"] = {"box": {"min": [0.3, 1.1], "max": [0.6, 1.2]}}
    config["domain"]["elements"] = [40, 24]
    config["sequence"]["characteristic_length"] = 1.4
    config["layers"]["count"] = 7
    config["constraints"] = [{"type": "layer_thickness", "target": 0.2, "least_volume": 0.1},
                             {"type": "last_layer", "least_volume": 0.1}]
    return config


class SequenceEndTest(FabseqTest):
    def test_binary_layers_judge(self):
        run = self.run_config(2, plate_2d(), "-max_iterations", 8, "-binary_iterations", 4, "-beta", 40, "-beta_max", 40)
        self.assert_done(run)
        lines, summary = run.history(), run.json("summary.json")
        self.assertEqual([line["iteration"] for line in lines if "binary" in line], [5, 6, 7, 8])
        judged = lines[4:]
        worst = {line["iteration"]: max(line["worst_constraint"], line["binary"]["worst_constraint"]) for line in judged}
        feasible = [line for line in judged if worst[line["iteration"]] <= 0]
        if not feasible:
            best = min(judged, key=lambda line: worst[line["iteration"]])
            self.assertEqual(summary["best_iteration"], best["iteration"])
        best = judged[summary["best_iteration"] - 5]
        self.assertEqual(summary["worst_constraint"], worst[best["iteration"]])
        binary = {r["name"]: r["value"] for r in summary["binary"]["responses"]}
        for term in (0, 1):
            self.assertLess(abs(binary[f"objective_{term}"] / best["binary"]["objective"][term] - 1), 1e-4)
        smooth = self.run_config(2, plate_2d(), "-max_iterations", 8, "-beta", 40, "-beta_max", 40)
        self.assertFalse(any("binary" in line for line in smooth.history()))
        # Who judges changes what is kept, not where the optimizer goes.
        for line, expected in zip(lines, smooth.history(), strict=True):
            self.assertLess(abs(line["objective"][0] / expected["objective"][0] - 1), 1e-3)

    def test_the_first_iterate_is_never_judged(self):
        run = self.run_config(1, plate_2d(), "-max_iterations", 3, "-binary_iterations", 9)
        self.assertEqual(["binary" in line for line in run.history()], [False, True, True])

    @run_fabseq.only_release
    def test_no_sliver(self):
        run = self.run_config(2, wedge(), "-max_iterations", 60, "-beta_interval", 8, timeout=600)
        self.assert_done(run)
        summary = run.json("summary.json")
        self.assertTrue(summary["feasible"], str(run))
        mean = sum(layer["volume"] for layer in summary["binary"]["layers"]) / 7
        volumes = [layer["volume"] / mean for layer in summary["binary"]["layers"]]
        used = [volume for volume in volumes if volume > 0]
        self.assertEqual(volumes[:len(used)], used)
        self.assertLess(len(used), 7)
        for layer in summary["binary"]["layers"][:len(used)]:
            self.assertLess(abs(layer["thickness"] / 0.2 - 1), 0.15)


if __name__ == "__main__":
    run_fabseq.main()
