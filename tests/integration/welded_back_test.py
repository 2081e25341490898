# SPDX-License-Identifier: MIT
"""The torch paths of a run, read back by import-paths and simulated, are the run again: its layers, its
verdict and its distortion."""

import os
import shlex
import subprocess
import sys

import h5py
import numpy as np

import run_fabseq
from run_fabseq import FabseqTest, ROOT, only_release

WIDE = {"thickness": [0.4, 2.5]}  # or single elements would decide, smaller than any bead
SAME_LAYER = 0.97  # least share of the elements that come back in their layer
TOOLS = os.path.join(ROOT, "scripts", "fabseq-tools")
SKIN = {"node_sets": {"skin": {"all": True, "surface": True}},
        "objective": [{"type": "distortion", "measure": "shape", "nodes": "skin"}, {"type": "layer_uniformity", "weight": 0.05}],
        "projection": {"interval": 2, "factor": 2.5}}
LAYERS = [{"type": "layer_thickness", "target": 4}, {"type": "last_layer"}]


def elbow(folder):
    """The flanged elbow from its mesh, in elements of 5 mm."""
    mesh = os.path.join(folder, "elbow.stl")
    subprocess.run([sys.executable, os.path.join(ROOT, "scripts/use/flanged_elbow.py"), mesh], check=True)
    return {"name": "elbow", "domain": {"element": 5, "unit": "mm"}, "part": {"mesh": {"file": mesh, "least_elements": 2}},
            "sequence": {"type": "heat"}, "layers": {"count": 27}, **SKIN,
            "constraints": [{"type": "layer_thickness", "target": 10}, {"type": "local_thickness"}, {"type": "supported"},
                            {"type": "last_layer"}], "optimizer": {"final_move_limit": 0.004}}


def l_shape(_):
    """A column that carries a long arm."""
    part = {"union": [{"box": {"min": [0, 0, 0], "max": [16, 20, 40]}}, {"box": {"min": [0, 0, 24], "max": [60, 20, 40]}}]}
    return {"name": "l_shape", "domain": {"size": [60, 20, 40], "elements": [30, 10, 20], "unit": "mm"}, "part": part,
            "sequence": {"type": "heat"}, "layers": {"count": 20}, **SKIN, "constraints": LAYERS}


def sub_parts(_):
    """The column and its arm in two sub-parts: planar layers of the column, tilted ones of the arm."""
    config = l_shape(None)
    layers = {"type": "multi_planar", "subparts": 2, "thickness": 4.0, "angles": [[1.5, 0.0], [1.1, 0.0]],
              "angle_bounds": [[0.8, 1.5708], [-0.5, 0.5]]}
    return {**config, "layers": layers, "objective": SKIN["objective"][:1], "constraints": [{"type": "subpart_volume"}]}


def y_shape(_):
    """Two arms on a stem, all of them cylinders."""
    stem, end = [31.5, 12, 0], [31.5, 12, 26]
    arms = [{"cylinder": {"from": end, "to": [x, 12, 54], "radius": 7}} for x in (10, 53)]
    part = {"union": [{"cylinder": {"from": stem, "to": [31.5, 12, 28], "radius": 9}}, *arms]}
    return {"name": "y_shape", "domain": {"size": [63, 24, 60], "elements": [53, 20, 50], "unit": "mm"}, "part": part,
            "sequence": {"type": "heat"}, "layers": {"count": 16}, **SKIN, "constraints": LAYERS,
            "tool": WIDE}


@only_release
class WeldedBackTest(FabseqTest):
    def tool(self, *words):
        done = subprocess.run([sys.executable, TOOLS, *map(str, words)], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def welded_back(self, part, iterations, width):
        config = part(self.directory)
        run = self.optimize(config, 2, iterations)
        expected = run.json("summary.json")["binary"]
        paths, sequence = run.path("paths"), run.path("sequence.h5")
        printed = self.tool("paths", run.output, "--bead-width", width, "--no-picture", "--output", paths)
        self.assertTrue(printed.startswith(f"{expected['verdict']['words']}\n"), printed[:200])
        printed = self.tool("import-paths", os.path.join(paths, "paths.csv"), run.output, "--output", sequence)
        command = next(shlex.split(line) for line in printed.splitlines() if line.startswith("fabseq "))
        again = self.run_program(2, *command[1:command.index("-output")])
        self.assert_done(again)
        found = again.json("summary.json")
        with h5py.File(run.path("result.h5")) as first, h5py.File(again.path("result.h5")) as second:
            built = first["density"][()] > 0
            numbers = [np.unique(file["layer"][()][built], return_inverse=True)[1] for file in (first, second)]
        self.assertGreater((numbers[0] == numbers[1]).mean(), SAME_LAYER)
        self.assertEqual(found["verdict"]["buildable"], expected["verdict"]["buildable"])
        self.assertEqual([reason["name"] for reason in found["verdict"]["reasons"]],
                         [reason["name"] for reason in expected["verdict"]["reasons"]])
        ours, theirs = (one["checks"] for one in (found, expected))
        self.assertEqual(ours["hanging"]["elements"], theirs["hanging"]["elements"])
        if theirs["local_thickness"]:  # else slabs
            ours, theirs = (one["local_thickness"]["share_outside"] for one in (ours, theirs))
            self.assertAlmostEqual(ours, theirs, delta=0.01)
        for state in ("as_built", "released"):
            ours, theirs = (one["finished"][state]["skin"]["rms"] for one in (found, expected))
            self.assertAlmostEqual(ours / theirs, 1.0, delta=0.01, msg=state)

    def test_elbow(self):
        self.welded_back(elbow, 12, 8)

    def test_l_shape(self):
        self.welded_back(l_shape, 4, 6)

    def test_sub_parts(self):
        self.welded_back(sub_parts, 6, 4)

    def test_y_shape(self):
        self.welded_back(y_shape, 3, 3)


if __name__ == "__main__":
    run_fabseq.main()
