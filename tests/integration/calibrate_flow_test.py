# SPDX-License-Identifier: MIT
"""fabseq-tools calibrate finds one factor on a material that flows, with which a synthetic measurement was
made."""

import os

import numpy as np

import run_fabseq
from calibration_case import CalibrationCase
from plastic_test import flowing
from run_fabseq import BAD_INPUT
from small_parts import plate_2d

FACTOR = 0.9
YIELD_STRESS = 0.002


def part(heated=True):
    """The hook of a material that flows, built in planar layers."""
    config = flowing(YIELD_STRESS, heated) | {"sequence": {"type": "planar"}, "constraints": []}
    config["material"]["strain_scale"] = [1.0, 1.2, 0.8]
    return config


def with_factor(config, *keys, factor=FACTOR):
    """The same part of a material with the factor."""
    changed = {key: (factor * np.array(config["material"][key])).tolist() for key in keys}
    return config | {"name": "measured", "material": config["material"] | changed}


class CalibrateFlowTest(CalibrationCase):
    def measured(self, config, *keys, released=False):
        """Nodes and displacements of the part with the factor on these keys."""
        run = self.run_config(1, with_factor(config, *keys), "-task", "simulate", "-binary", "-tolerance", "1e-10")
        self.assert_done(run)
        return self.moved_nodes(run, "released_displacement" if released else "displacement")

    def assert_found(self, run, config, *keys, rtol=1e-3):
        """The factor, and the config with it."""
        self.assertEqual((run.returncode, run.stderr), (0, ""))
        record = self.read("calibration.json")
        self.assertAlmostEqual(record["factor"] / FACTOR, 1.0, delta=rtol)
        self.assertEqual(record["factored"], [f"material.{key}" for key in keys])
        self.assertLess(record["rms_difference"], 0.02 * record["rms_difference_before"])
        self.assertLessEqual(len(record["simulated"]), 6)
        for key, value in with_factor(config, *keys, factor=record["factor"])["material"].items():
            np.testing.assert_allclose(self.read("config.json")["material"][key], value, rtol=1e-9, err_msg=key)
        self.assertIn("factor on " + " and ".join(record["factored"]), run.stdout)
        with open(os.path.join(self.directory, "calibrated", "calibration.png"), "rb") as file:
            self.assertEqual(file.read(8), b"\x89PNG\r\n\x1a\n")

    def test_elongation(self):
        config = part()
        positions, displacements = self.measured(config, "elongations", released=True)
        turned = displacements + np.cross([0.02, -0.03, 0.04], positions) + [0.5, 0.3, -0.2]
        run = self.calibrate(config, self.write_points(positions, turned), "--released", "--rigid", "--isotropic")
        self.assert_found(run, config, "elongations")

    def test_yield_stress_and_hardening(self):
        for heated in (True, False):
            with self.subTest(heated=heated):
                config, keys = part(heated), ("yield_stress", "hardening")
                run = self.calibrate(config, self.write_points(*self.measured(config, *keys)), "--factor", "yield")
                self.assert_found(run, config, *keys)

    def test_strain_without_heat(self):
        """The axes keep their proportions."""
        config = part(False)
        run = self.calibrate(config, self.write_points(*self.measured(config, "strain_scale")), "--factor", "elongation")
        self.assert_found(run, config, "strain_scale")

    def test_scan_of_a_run(self):
        """Of the run's binary layers."""
        config = part() | {"name": "built"}
        config["sequence"] = {"type": "heat", "characteristic_length": 1.6}
        optimized = self.run_config(1, config, "-max_iterations", 2)
        self.assert_done(optimized)
        run = self.run_config(1, with_factor(config, "elongations"), "-task", "simulate", "-binary",
                              "-design", optimized.path("result.h5"), "-tolerance", "1e-10")
        self.assert_done(run)
        positions, displacements = self.moved_nodes(run, "displacement")
        ends = (positions == positions.min(0)) | (positions == positions.max(0))
        skin = ends[:, :2].any(1)  # the lowest of these nodes are inside, one element above the plate
        scan = self.write_table((positions + displacements)[skin], "x,y,z", "scan.csv")
        run = self.calibrate_parts([optimized.path(""), scan])
        self.assertEqual((run.returncode, run.stderr), (0, ""))
        self.assertAlmostEqual(self.read("calibration.json")["factor"] / FACTOR, 1.0, delta=1e-3)

    def test_two_parts_have_one_factor(self):
        words = []
        for number, dwell in enumerate((20, 200)):
            config = part()
            config["process"]["dwell"] = dwell
            words += [self.write_config(config, f"part_{number}.json"),
                      self.write_points(*self.measured(config, "elongations"), name=f"measured_{number}.csv")]
        run = self.calibrate_parts(words)
        self.assertEqual((run.returncode, run.stderr), (0, ""))
        self.assertAlmostEqual(self.read("calibration.json")["factor"] / FACTOR, 1.0, delta=1e-3)
        self.assertEqual(self.read("part_2/config.json")["material"]["elongations"],
                         self.read("part_1/config.json")["material"]["elongations"])

    def assert_warned(self, run, *words):
        self.assertEqual((run.returncode, run.stderr.count("\n")), (0, 1), run.stderr)
        for its in words:
            self.assertIn(its, run.stderr)

    def test_what_no_factor_explains(self):
        """The wrong moment, and a material that does not flow."""
        config = part()
        positions, displacements = self.measured(config, "elongations")
        self.assert_warned(self.calibrate(config, self.write_points(positions, displacements), "--released"),
                           "of the measurement", "a part before its release (without --released) would leave")
        rigid = part(False)
        rigid["material"] |= {"yield_stress": 0.02, "inherent_strain": [-1e-4, -1e-4, -1e-4, 0, 0, 0]}
        positions, displacements = self.measured(rigid)
        run = self.calibrate(rigid, self.write_points(positions, displacements), "--factor", "yield")
        self.assert_warned(run, "the points say nothing about the factor on material.yield_stress and material.hardening")
        self.assertEqual(self.read("calibration.json")["factor"], 1.0)

    def test_a_factor_that_no_material_has(self):
        config = part(False)
        config["domain"]["unit"] = "mm"
        positions, displacements = self.measured(config, "strain_scale")
        run = self.calibrate(config, self.write_points(positions, 1000 * displacements), "--tolerance", "1")
        self.assertEqual(run.returncode, 0, run.stderr)
        outside = self.read("calibration.json")["warnings"][0]
        self.assertIn("factor on material.strain_scale: found 5, an end of what is tried, 0.05 to 5", outside)
        self.assertIn("with displacements in µm beside points in mm these would be 0.9", outside)
        self.assertIn("these factors do not explain it", run.stderr)

    def test_refusals(self):
        config = part()
        positions, displacements = self.measured(config, "elongations")
        measured = self.write_points(positions, displacements)
        flow, cold, flat = (self.write_config(its, f"{name}.json") for name, its in
                            (("flow", config), ("cold", part(False)), ("flat", plate_2d())))
        for words, options, reason in (
                ([flow, measured, flow, measured], ["--vanishing"], "--vanishing: found process.model elastoplastic in"),
                ([flow, measured, cold, measured], [], "cold.json: found process.model elastoplastic without thermal; allowed:"),
                ([flat, self.write_table(np.zeros((1, 2)), "x,y", "flat.csv")], ["--factor", "yield"],
                 "--factor: found process.model linear in"),
                ([flow, measured], ["--factor", "modulus"], "--factor: invalid choice: 'modulus'"),
                ([flow, self.write_points(positions, -displacements, name="opposite.csv")], [],
                 "displacement, over the simulated one: found 0; allowed: above 0")):
            run = self.calibrate_parts(words, *options)
            self.assertEqual((run.returncode, run.stderr.count("\n")), (BAD_INPUT, 1), run.stderr)
            self.assertIn(reason, run.stderr)
            self.assertFalse(os.path.exists(os.path.join(self.directory, "calibrated")))


if __name__ == "__main__":
    run_fabseq.main()
