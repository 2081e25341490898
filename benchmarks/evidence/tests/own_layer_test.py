# SPDX-License-Identifier: MIT
"""figures/own_layer.py takes the distortion of a run apart: the sum is that of the run."""

import os
import subprocess
import sys

import numpy as np

import run_fabseq
from run_fabseq import ENVIRONMENT, FabseqTest, PROGRAM, ROOT
from small_parts import hook_3d, plate_2d

SCRIPT = os.path.join(ROOT, "benchmarks", "evidence", "figures", "own_layer.py")
BLOCKS = {"planar": "baseline", "start": "start", "binary": "binary"}


class OwnLayerTest(FabseqTest):
    def parts_of(self, config, directory):
        """Of each sequence: the length, and that of the own layer, of later layers, and of the release."""
        run = self.run_config(2, config, "-max_iterations", 2)
        self.assert_done(run)
        command = [sys.executable, SCRIPT, run.output, "--program", PROGRAM, "--output", os.path.join(self.directory, directory)]
        done = subprocess.run(command, capture_output=True, text=True, cwd=self.directory, check=False,
                              env={**ENVIRONMENT, **os.environ})
        self.assertEqual(done.returncode, 0, done.stderr)
        rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in done.stdout.splitlines()[2:]]
        parts = {row[1]: [float(cell) for cell in row[2:]] for row in rows}
        self.assertEqual(list(parts), list(BLOCKS))
        for sequence, block in BLOCKS.items():
            expected = np.sqrt(run.json("summary.json")[block]["responses"][0]["value"])
            self.assertAlmostEqual(parts[sequence][0] / expected, 1, delta=0.01)  # printed with three digits
        return parts

    def test_measures(self):
        hook, plate = hook_3d(), plate_2d()
        plate |= {"layers": {"count": "auto"}, "projection": {"max": 5}}
        hook["node_sets"]["skin"] = {"all": True, "surface": True}
        hook["objective"][0] = {"type": "distortion", "measure": "shape", "nodes": "skin", "after_release": True,
                                "fit": ["translation", "rotation", "scale"]}
        for parts in (self.parts_of(hook, "hook"), self.parts_of(plate, "plate")):
            for whole, *rest in parts.values():
                self.assertLessEqual(whole, 1.01 * sum(rest))
        plate["objective"][0] |= {"measure": "flatness", "axis": "y", "nodes": "corner"}
        plate["node_sets"]["corner"] = {"polygon": {"points": [[0, 1.2], [0, 0.8], [0.9, 1.2]]}, "within": 0.05}
        for _, own, later, release in self.parts_of(plate, "flat").values():
            self.assertGreater(own, 0)  # the last planar layer has none after it
            self.assertGreaterEqual(later, 0)
            self.assertEqual(release, 0)

    def test_one_layer_is_its_own(self):
        config = plate_2d()
        config["layers"]["count"] = 1
        config["constraints"] = []
        config["baseline"] = {"layers": 1}
        for whole, own, later, _ in self.parts_of(config, "one").values():
            self.assertEqual((own, later), (whole, 0))


if __name__ == "__main__":
    run_fabseq.main()
