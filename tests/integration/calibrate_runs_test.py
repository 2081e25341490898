# SPDX-License-Identifier: MIT
"""fabseq-tools calibrate of a run's folder simulates what was built: the binary layers that the run has
found."""

import os

import h5py
import numpy as np

import run_fabseq
from calibration_case import CalibrationCase
from multi_planar_test import tee_2d
from read_outputs import read_result
from repair_test import leaning
from run_fabseq import BAD_INPUT
from small_parts import direct_2d, plate_2d, v_2d, write_voxels

START = "the start design of this config was simulated"


class CalibrateRunsTest(CalibrationCase):
    def assert_factors(self, run, factors, rtol=1e-4):
        self.assertEqual(run.returncode, 0, run.stderr)
        np.testing.assert_allclose(self.read("calibration.json")["strain_scale"], factors, rtol=rtol)
        self.assertNotIn(START, run.stderr)

    def test_optimized_layers_of_every_kind(self):
        """The run's own displacement with binary layers, 1.3 times as large. Their start designs are
        others."""
        guided = v_2d() | {"sequence": {"type": "guided"}}
        uneven = plate_2d()
        uneven["layers"]["time_points"] = "variable"
        for name, config in (("guided", guided), ("uneven", uneven), ("direct", direct_2d()), ("multi", tee_2d())):
            with self.subTest(name):
                optimized = self.run_config(2, config | {"name": name}, "-max_iterations", 12, "-tolerance", "1e-8")
                self.assert_done(optimized)
                data = read_result(optimized)
                self.assertGreater(np.abs(data["binary/displacement"] - data["start/displacement"]).max(),
                                   0.01 * np.abs(data["start/displacement"]).max(), "the optimized part is another one")
                positions, displacements = self.moved_nodes(optimized, "binary/displacement")
                measured = self.write_points(positions, 1.3 * displacements)
                run = self.calibrate_parts([optimized.path(""), measured], "--isotropic")
                self.assert_factors(run, [1.3, 1.3])
                self.assertLess(self.read("calibration.json")["left_of_measurement"], 1e-3)
                config = self.read("config.json")
                self.assertEqual((config["sequence"]["type"], config["projection"]["binary"], "run" in config),
                                 (optimized.json("config.json")["sequence"]["type"], False, False))
        # The config of a run's folder stands for the run.
        self.assert_factors(self.calibrate_parts([optimized.path("config.json"), measured], "--isotropic"), [1.3, 1.3])
        # Not the layers that result.h5 has.
        with h5py.File(optimized.path("result.h5"), "r+") as file:
            file["layer"][...] = file["layer"][()][:, ::-1]
        run = self.calibrate_parts([optimized.path(""), measured], "--isotropic")
        self.assertEqual(run.returncode, BAD_INPUT)
        self.assertIn("of the elements in other layers than result.h5 has", run.stderr)
        self.assertFalse(os.path.exists(os.path.join(self.directory, "calibrated", "simulation_1_1")))

    def test_repaired_layers(self):
        """Those of a run that ended with a repair, of its design no others."""
        optimized = self.run_config(1, leaning(repair_iterations=1, repair_share=0.1),
                                    "-max_iterations", 10, "-tolerance", "1e-8")
        self.assert_done(optimized)
        self.assertIn("repair", optimized.json("summary.json"))
        positions, displacements = self.moved_nodes(optimized, "binary/displacement")
        run = self.calibrate_parts([optimized.path(""), self.write_points(positions, 1.3 * displacements)], "--isotropic")
        self.assert_factors(run, [1.3, 1.3])
        self.assertLess(self.read("calibration.json")["left_of_measurement"], 1e-3)

    def test_simulated_and_evaluated_sequences(self):
        """Of a file, and of a design of the command line; what was evaluated has no result.h5."""
        time = os.path.join(self.directory, "time.h5")
        write_voxels(time, np.fromfunction(lambda y, x: (x + 3 * y + 1) / 54, (12, 20)), dataset="time")
        given = plate_2d() | {"name": "given", "constraints": []}
        given["objective"] = given["objective"][:1]
        of_file = self.run_config(1, given, "-task", "simulate", "-sequence", time, "-binary", "-tolerance", "1e-10")
        self.assert_done(of_file)
        positions, displacements = self.moved_nodes(of_file, "displacement")
        run = self.calibrate_parts([of_file.path(""), self.write_points(positions, 0.8 * displacements)], "--isotropic")
        self.assert_factors(run, [0.8, 0.8], 1e-6)

        config = direct_2d()
        optimized = self.run_config(1, config, "-max_iterations", 2)
        self.assert_done(optimized)
        positions, displacements = self.moved_nodes(optimized, "binary/displacement")
        measured = self.write_points(positions, 0.8 * displacements)
        for task in ("simulate", "evaluate"):
            again = self.run_config(1, config | {"name": task}, "-task", task, "-design", optimized.path("result.h5"))
            self.assert_done(again)
            self.assert_factors(self.calibrate_parts([again.path(""), measured], "--isotropic"), [0.8, 0.8])

    def test_configs(self):
        """That of a sequence with a design says which one it has; a folder without a result is refused."""
        config = plate_2d()
        measured = self.write_points(*self.measure(config, [1.2, 1.2]))
        run = self.calibrate(config, measured, "--isotropic")
        self.assertEqual(run.returncode, 0)
        self.assertIn(START, run.stderr)
        config["sequence"] = {"type": "planar"}
        run = self.calibrate(config, self.write_points(*self.measure(config, [1.2, 1.2])), "--isotropic")
        self.assert_factors(run, [1.2, 1.2])
        self.assertEqual(run.stderr, "")
        for place, words in ((self.directory, "config.json is missing"), (os.path.join(self.directory, "none"), "none")):
            run = self.calibrate_parts([place, measured])
            self.assertEqual((run.returncode, run.stderr.count("\n")), (BAD_INPUT, 1), run.stderr)
            self.assertIn(words, run.stderr)


if __name__ == "__main__":
    run_fabseq.main()
