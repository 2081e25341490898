# SPDX-License-Identifier: MIT
"""fabseq-tools calibrate finds the factors that synthetic measurements were made with."""

import os

import numpy as np

import run_fabseq
from calibration_case import CalibrationCase
from mesh_test import HIGH, LOW, bar, box_triangles, stl_text
from small_parts import plate_2d, post_on_substrate
from thermal_test import warmed


class CalibrateTest(CalibrationCase):
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

    def test_points_off_the_elements(self):
        """Of the top and the left face; the others are inside or on the surface."""
        config = plate_2d()
        positions, displacements = self.measure(config, [1.4, 0.7])
        off = np.random.default_rng(1).uniform(0, 0.09, len(positions))  # an element is 0.1
        positions[:, 1] += off * (positions[:, 1] > 1.19)
        positions[:, 0] -= off * (positions[:, 0] < 0.01)
        run = self.calibrate(config, self.write_points(positions, displacements))
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn("outside of the elements moved by up to 0.0", run.stdout)
        np.testing.assert_allclose(self.read("calibration.json")["strain_scale"], [1.4, 0.7], rtol=1e-5)

    def test_points_far_from_the_part(self):
        """All are named, before any simulation."""
        path = os.path.join(self.directory, "far.csv")
        for header, more, tolerance, words in (("x,y,ux,uy", ",0,0", [], "farther than 0.1 from the elements"),
                                               ("x,y", "", ["--tolerance", "0.4"], "farther than 0.4 from the surface")):
            with open(path, "w", encoding="utf-8") as file:
                file.write("\n".join([header, "0.1,0.1" + more, "-1,1.2" + more, "0,1.7" + more, ""]))
            run = self.calibrate(plate_2d(), path, *tolerance)
            self.assertEqual(run.returncode, 2)
            self.assertIn(words, run.stderr)
            self.assertIn("2 of 3 points lie", run.stderr)
            self.assertIn("point 2 at [-1,1.2], 1 away; point 3 at [0,1.7], 0.5 away", run.stderr)
            self.assertFalse(os.path.exists(os.path.join(self.directory, "calibrated")), "nothing is left")

    def test_scan(self):
        """Points of the surface of the finished part: nobody knows where they were in the drawing."""
        config = plate_2d()
        positions, displacements = self.measure(config, [1.4, 0.7])
        skin = (np.abs(positions - (1, 0.6)) > (0.99, 0.59)).any(1)
        path = os.path.join(self.directory, "scan.csv")
        np.savetxt(path, (positions + displacements)[skin], delimiter=",", header="x,y", comments="")
        run = self.calibrate(config, path)
        self.assertEqual(run.returncode, 0, run.stderr)
        record = self.read("calibration.json")
        np.testing.assert_allclose(record["strain_scale"], [1.4, 0.7], rtol=1e-4)
        self.assertEqual((record["measured"], record["points"]), ("scan", skin.sum()))

    def test_scan_of_a_mesh_in_a_frame_of_its_own(self):
        """A cloud of points around a bar that was turned and put on the plate."""
        with open(os.path.join(self.directory, "bar.stl"), "w", encoding="utf-8") as file:
            file.write(stl_text(box_triangles(LOW, HIGH)))
        config = bar(rotate=[["x", 90]], least_elements=0)
        config["domain"]["element"] = 5
        positions, displacements = self.measure(config, [1.3, 1.3, 1.3], released=True)
        skin = ((positions == positions.min(0)) | (positions == positions.max(0))).any(1)
        points = positions[skin] + displacements[skin] + np.cross([0.002, -0.003, 0.004], positions[skin]) + [0.5, 0.3, -0.2]
        path = os.path.join(self.directory, "scan.ply")
        np.savetxt(path, points, comments="", header=f"""ply
format ascii 1.0
element vertex {len(points)}
property double x
property double y
property double z
end_header""")
        run = self.calibrate(config, path, "--released", "--rigid", "--isotropic")
        self.assertEqual((run.returncode, run.stderr.count("\n")), (0, 1), run.stderr)
        self.assertIn("the start design of this config was simulated", run.stderr)
        record = self.read("calibration.json")
        np.testing.assert_allclose(record["strain_scale"], [1.3, 1.3, 1.3], rtol=1e-3)
        self.assertLess(record["rms_difference"], 1e-3 * record["rms_measured"])

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

    def two_parts(self, dwells=(60, 1000), enlarged=(1, 1), shift=0, **thermal):
        """Words of the plate with two pauses, and what would be measured with a factor of 1.3."""
        words = []
        for number, dwell in enumerate(dwells):
            config = warmed(plate_2d(), **thermal)
            config["process"]["dwell"] = dwell
            positions, displacements = self.measure(config, [1.3, 1.3])
            displacements = displacements * enlarged[number] + shift
            config["thermal"]["vanishing"] = 1500  # does not count
            words += [self.write_config(config, f"part_{number}.json"),
                      self.write_points(positions, displacements, name=f"measured_{number}.csv")]
        return words

    def test_strain_and_where_it_vanishes(self):
        """Measured in a frame that lies much farther off than the part distorts."""
        run = self.calibrate_parts(self.two_parts(vanishing=1100, shift=1), "--vanishing", "--isotropic", "--rigid")
        self.assertEqual(run.returncode, 0, run.stderr)
        record = self.read("calibration.json")
        np.testing.assert_allclose(record["vanishing"], 1100, rtol=1e-3)
        np.testing.assert_allclose(record["strain_scale"], [1.3, 1.3], rtol=1e-4)
        self.assertLess(record["rms_difference"], 1e-3 * record["rms_difference_constant"])
        hot, cold = record["parts"]
        self.assertGreater(hot["highest_interpass"], cold["highest_interpass"])
        self.assertLess(hot["own_strain_scale"][0], cold["own_strain_scale"][0])
        self.assertEqual(record["measured_values"], hot["measured_values"] + cold["measured_values"])
        for folder, dwell in (("part_1", 60), ("part_2", 1000)):
            config = self.read(os.path.join(folder, "config.json"))
            self.assertEqual((config["thermal"]["vanishing"], config["material"]["strain_scale"], config["process"]["dwell"]),
                             (record["vanishing"], record["strain_scale"], dwell))
        self.assertIn("better than the constant one", run.stdout)

    def test_a_constant_strain_stays_constant(self):
        run = self.calibrate_parts(self.two_parts(vanishing=1e30), "--vanishing", "--isotropic")
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn("the constant strain is as good, and is kept", run.stdout)
        np.testing.assert_allclose(self.read("calibration.json")["strain_scale"], [1.3, 1.3], rtol=1e-5)
        self.assertEqual(self.read("part_1/config.json")["thermal"]["vanishing"], 1e30)

    def test_no_vanishing_fits_a_hot_part_of_larger_strain(self):
        run = self.calibrate_parts(self.two_parts(vanishing=1e30, enlarged=(1.2, 1.0)), "--vanishing", "--isotropic")
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn("no vanishing fits, since the hotter layers have the larger strain", run.stdout)
        self.assertEqual(self.read("calibration.json")["vanishing"], 1e30)

    def test_parts_that_tell_no_vanishing(self):
        measured = self.write_points(np.array([[0.5, 0.5]]), np.array([[0.0, 0.0]]))
        hot, cold = self.write_config(warmed(plate_2d()), "hot.json"), self.write_config(plate_2d(), "cold.json")
        for words, reason in (([hot, measured], "found one part, which cannot tell a small strain from a hot part"),
                              ([hot, measured, cold, measured], "cold.json: /thermal: found none"),
                              ([hot, measured, hot], "found a config without a measurement")):
            run = self.calibrate_parts(words, "--vanishing")
            self.assertEqual((run.returncode, run.stderr.count("\n")), (2, 1), run.stderr)
            self.assertIn(reason, run.stderr)
        self.assertFalse(os.path.exists(os.path.join(self.directory, "calibrated")))

    def test_layers_of_one_temperature_tell_no_vanishing(self):
        run = self.calibrate_parts(self.two_parts(vanishing=1100, heat_input=0, ambient=60), "--vanishing", "--isotropic")
        lines = run.stderr.splitlines()
        self.assertEqual((run.returncode, len(lines)), (2, 3), run.stderr)
        for line in lines[:2]:
            self.assertIn("warning: ", line)
            self.assertIn("/thermal/heat_input: found 0", line)
        self.assertIn("the parts are too much alike", lines[2])

    def test_errors(self):
        config = plate_2d()
        for text, words in (("x,y,ux\n0,0,0\n", ["uy"]), ("x,y,ux,uy\n", ["no points"]),
                            ("x,y,ux,uy\n0,0.1,0,a\n", ["line 2", "uy", "'a'"]),
                            ("x,y,ux,uy\n5,0.1,0,0\n", ["point 1", "part"])):
            path = os.path.join(self.directory, "wrong.csv")
            with open(path, "w", encoding="utf-8") as file:
                file.write(text)
            run = self.calibrate(config, path)
            self.assertEqual(run.returncode, 2)
            self.assertTrue(run.stderr.startswith("fabseq-tools calibrate: "), run.stderr)
            for word in words:
                self.assertIn(word, run.stderr)


if __name__ == "__main__":
    run_fabseq.main()
