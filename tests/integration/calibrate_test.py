# SPDX-License-Identifier: MIT
"""scripts/use/calibrate.py finds the factors that synthetic measurements were made with."""

import json
import os
import subprocess
import sys

import numpy as np

import run_fabseq
from read_outputs import read_result
from run_fabseq import ENVIRONMENT, FabseqTest, PROGRAM, ROOT
from small_parts import plate_2d, post_on_substrate

SCRIPT = os.path.join(ROOT, "scripts", "use", "calibrate.py")


class CalibrateTest(FabseqTest):
    def measure(self, config, scale, released=False):
        """Nodes of part and substrate and their displacements for these factors."""
        config.setdefault("material", {})["strain_scale"] = scale
        run = self.run_config(1, config, "-task", "simulate", "-tolerance", "1e-10")
        self.assert_done(run)
        data = read_result(run)
        field = data["displacement"] + (data["release_displacement"] if released else 0)
        there = np.abs(field).max(-1) > 0
        axes = [np.linspace(0, edge, n + 1) for edge, n in zip(config["domain"]["size"], config["domain"]["elements"])]
        positions = np.stack([grid[there] for grid in np.meshgrid(*axes[::-1], indexing="ij")[::-1]], 1)
        config["material"]["strain_scale"] = [1.0] * len(axes)
        return positions, field[there]

    def write_points(self, positions, displacements, gaps=0):
        """Every seventh of them; the first `gaps` without displacement along x."""
        names = "xyz"[:positions.shape[1]]
        path = os.path.join(self.directory, "measured.csv")
        with open(path, "w", encoding="utf-8") as file:
            file.write("# made up\n" + ", ".join([*names, *("u" + name for name in names)]) + "\n")
            for number, (x, u) in enumerate(zip(positions[::7], displacements[::7], strict=True)):
                values = ["" if number < gaps and i == 0 else repr(float(value)) for i, value in enumerate(u)]
                file.write(",".join([*(repr(float(value)) for value in x), *values]) + "\n")
        return path

    def calibrate(self, config, measured, *options):
        command = [sys.executable, SCRIPT, self.write_config(config), measured, "--program", PROGRAM, "--output",
                   os.path.join(self.directory, "calibrated"), *options, "--", "-tolerance", "1e-10"]
        return subprocess.run(command, capture_output=True, text=True, cwd=self.directory, check=False,
                              env={**ENVIRONMENT, **os.environ})

    def read(self, name):
        with open(os.path.join(self.directory, "calibrated", name), encoding="utf-8") as file:
            return json.load(file)

    def expect(self, config, scale, *options, released=False, disturbance=None):
        positions, displacements = self.measure(config, scale, released)
        if disturbance is not None:
            displacements = disturbance(positions, displacements)
        run = self.calibrate(config, self.write_points(positions, displacements, gaps=3), *options)
        self.assertEqual(run.returncode, 0, run.stderr)
        record = self.read("calibration.json")
        np.testing.assert_allclose(record["strain_scale"], scale, rtol=1e-5)
        self.assertLess(record["rms_difference"], 1e-5 * record["rms_measured"])
        self.assertEqual(self.read("config.json")["material"]["strain_scale"], record["strain_scale"])
        return record

    def test_strain_with_shear(self):
        config = plate_2d()
        config["material"] = {"inherent_strain": [-0.01, -0.006, 0.004]}
        record = self.expect(config, [1.4, 0.7])
        self.assertEqual(record["determined"], [True, True])

    def test_turning_strain_after_the_release_in_a_frame_of_its_own(self):
        def move(positions, displacements):
            turn = np.zeros_like(displacements)
            turn[:, 0], turn[:, 1] = -0.3 * positions[:, 1], 0.3 * positions[:, 0]
            return displacements + turn + 0.5

        self.expect(post_on_substrate(2), [0.8, 1.3], "--released", "--rigid", released=True, disturbance=move)

    def test_solid(self):
        self.expect(post_on_substrate(3), [0.8, 1.3, 0.6])

    def test_one_factor(self):
        self.expect(plate_2d(), [1.2, 1.2], "--isotropic")

    def test_config_found_runs(self):
        config = plate_2d()
        self.expect(config, [1.4, 0.7])
        run = self.run_program(1, "-config", os.path.join(self.directory, "calibrated", "config.json"), "-task", "simulate")
        self.assert_done(run)

    def test_what_cannot_be_measured(self):
        """A strain of nothing along y has no factor there."""
        config = plate_2d()
        config["material"] = {"inherent_strain": [-0.01, 0, 0]}
        positions, displacements = self.measure(config, [1.4, 1.0])
        run = self.calibrate(config, self.write_points(positions, displacements))
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn("along y", run.stderr)
        np.testing.assert_allclose(self.read("calibration.json")["strain_scale"], [1.4, 1.0], rtol=1e-5)

    def test_errors(self):
        config = plate_2d()
        for text, words in (("x,y,ux\n0,0,0\n", ["uy"]), ("x,y,ux,uy\n", ["no points"]),
                            ("x,y,ux,uy\n0,0.1,0,a\n", ["point 1", "uy", "'a'"]),
                            ("x,y,ux,uy\n5,0.1,0,0\n", ["point 1", "part"])):
            path = os.path.join(self.directory, "wrong.csv")
            with open(path, "w", encoding="utf-8") as file:
                file.write(text)
            run = self.calibrate(config, path)
            self.assertEqual(run.returncode, 1)
            self.assertTrue(run.stderr.startswith("calibrate.py: "), run.stderr)
            for word in words:
                self.assertIn(word, run.stderr)


if __name__ == "__main__":
    run_fabseq.main()
