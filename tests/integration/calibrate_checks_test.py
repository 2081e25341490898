# SPDX-License-Identifier: MIT
"""fabseq-tools calibrate says what cannot be meant: factors of 0 and of 800, what no factor explains, and
what else the measurement may be."""

import os

import numpy as np

import run_fabseq
from calibration_case import CalibrationCase
from run_fabseq import BAD_INPUT
from small_parts import plate_2d


def planar(config):
    return config | {"sequence": {"type": "planar"}}


class CalibrateChecksTest(CalibrationCase):
    def setUp(self):
        super().setUp()
        self.config = planar(plate_2d())
        self.config["domain"]["unit"] = "mm"

    def moved(self):
        """Every seventh node, and its displacement for a factor of 0.8."""
        positions, displacements = self.measure(self.config, [0.8, 0.8])
        return positions[::7], displacements[::7]

    def run_table(self, *columns, header="x,y,ux,uy", name="measured.csv", options=("--isotropic",)):
        return self.calibrate(self.config, self.write_table(np.hstack(columns), header, name), *options)

    def assert_nothing(self, run, *words):
        self.assertEqual((run.returncode, run.stderr.count("\n")), (BAD_INPUT, 1), run.stderr)
        self.assertFalse(os.path.exists(os.path.join(self.directory, "calibrated")))
        for its in words:
            self.assertIn(its, run.stderr)

    def assert_warned(self, run, *words):
        """In the last lines, and in calibration.json."""
        self.assertEqual((run.returncode, run.stderr.count("\n")), (0, len(words)), run.stderr)
        warnings = self.read("calibration.json")["warnings"]
        for line, warning, its in zip(run.stderr.splitlines(), warnings, words, strict=True):
            self.assertEqual(line, "fabseq-tools calibrate: warning: " + warning)
            for text in its:
                self.assertIn(text, warning)

    def test_factors_that_no_material_has(self):
        x, u = self.moved()
        run = self.run_table(x, 1000 * u, header="X [mm],Y [mm],Dev X,Dev Y")
        self.assert_warned(run, ["strain_scale: found 800 along x, 800 along y; usual: 0.05 to 5",
                                 "with displacements in µm beside points in mm it would be 0.8, 0.8"],
                           ["inherent strain with these factors: found up to 8; usual: up to 0.1"])
        self.assert_warned(self.run_table(x, 0.05 * u), ["found 0.04 along x, 0.04 along y"])
        self.assert_warned(self.run_table(x, u))
        with open(os.path.join(self.directory, "calibrated", "calibration.png"), "rb") as file:
            self.assertEqual(file.read(8), b"\x89PNG\r\n\x1a\n")

    def test_no_factor_at_all(self):
        x, u = self.moved()
        self.assert_nothing(self.run_table(x, -u), "strain_scale along x, y: found 0; allowed: above 0",
                            "displacements of the opposite sign would leave")
        self.assert_nothing(self.run_table(x, u[:, ::-1] * [1, -1]), "found 0",
                            "displacements whose axes -y, x are the part's x, y would leave")
        self.assert_nothing(self.run_table(x, 0 * u), "found 0", "do not differ from the drawing")
        skin = x[(x[:, 0] < 1e-9) | (x[:, 1] > 1.2 - 1e-9)]
        self.assert_nothing(self.run_table(skin, header="x,y"), "found 0", "do not differ from the drawing, as nominal ones do")

    def test_what_no_factor_explains(self):
        x, u = self.moved()
        self.assert_warned(self.run_table(x, u + 0.6 * np.abs(u[:, ::-1])),
                           ["% of the measurement; usual: up to 20 %; these factors do not explain it"])
        lost = u.copy()
        lost[::3] = 0
        self.assert_warned(self.run_table(x, lost), ["usual: up to 20 %", "without the points whose displacement is exactly 0"])

    def test_before_and_after_the_release(self):
        for released, options, words in ((True, (), "a part after its release (--released) would leave"),
                                         (False, ("--released",), "a part before its release (without --released) would leave")):
            x, u = self.measure(self.config, [0.8, 0.8], released)
            self.assert_warned(self.run_table(x, u, options=("--isotropic", *options)), ["% of the measurement", words])

    def test_units(self):
        x, u = self.moved()
        self.assert_nothing(self.run_table(1e-3 * x, u), "measured.csv: found points that reach over 0.002",
                            "lengths 1000 times theirs would fit, as if they were in m", "--unit m")
        run = self.run_table(1e-3 * x, 1e-3 * u, options=("--isotropic", "--unit", "m"))
        self.assert_warned(run)
        np.testing.assert_allclose(self.read("calibration.json")["strain_scale"], [0.8, 0.8], rtol=1e-5)

    def test_options(self):
        measured = self.write_table(np.zeros((1, 2)), "x,y")
        for option, value, words in (("--tolerance", "0", "--tolerance: found 0; allowed: a number > 0"),
                                     ("--tolerance", "nan", "--tolerance: found nan"), ("--ranks", "0", "--ranks: found 0"),
                                     ("--unit", "ell", "--unit: found the unit 'ell'; allowed: mm")):
            self.assert_nothing(self.calibrate(self.config, measured, option, value), words)

    def test_what_the_program_says_of_the_physics(self):
        """Its warnings are passed on, and those about optimizations are not."""
        x, u = self.moved()
        warned = self.run_config(1, self.config, "-task", "check").stderr.splitlines()
        self.assertTrue(any("/objective" in line for line in warned), warned)
        run = self.run_table(x, u)
        self.assertEqual([line for line in run.stderr.splitlines() if "/objective" in line], [])


if __name__ == "__main__":
    run_fabseq.main()
