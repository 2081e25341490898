# SPDX-License-Identifier: MIT
"""A run's own binary layers, read back from its result, get the run's own verdict, element by element."""

import os

import h5py
import numpy as np

import run_fabseq
from multi_planar_test import tee_2d
from read_outputs import read_result
from run_fabseq import FabseqTest, distinct
from small_parts import direct_2d, hook_3d, plate_2d

TOOL = {"profile": [[0.05, 0.02], [0.6, 0.4]], "max_tilt": 20, "thickness": [0.8, 1.2], "bead_width": 0.3}
CHECKED = "layer", "hanging", "blocked", "tilt", "local_thickness", "build_direction"


def cases():
    heat, guided = hook_3d(), hook_3d() | {"name": "guided", "sequence": {"type": "guided", "max_tilt": 50}}
    guided["objective"] = guided["objective"][:1]
    nodes, elements = direct_2d("nodes"), direct_2d("elements")
    elements["constraints"] = elements["constraints"][1:]
    planes = tee_2d()
    for config in (heat, guided, nodes, elements):
        config["tool"] = TOOL
    planes["tool"] = {"profile": [[0.5, 0.2], [6, 4]], "max_tilt": 20, "bead_width": 3}
    return heat, guided, nodes, elements, planes


class JudgedAgainTest(FabseqTest):
    def judged_again(self, ranks, run, file="result.h5", *options):
        again = self.run_config(ranks, run.path("config.json"), "-task", "simulate", "-sequence", run.path(file),
                                "-binary", *options)
        self.assert_done(again)
        return again, again.json("summary.json"), read_result(again)

    @staticmethod
    def comparable(name):
        """Multi-planar layers are counted with those that only smooth ones have."""
        return lambda fields: np.unique(fields[name], return_inverse=True)[1] if name == "layer" else fields[name]

    def test_verdict_of_every_element(self):
        for config in cases():
            for ranks in distinct(1, 2):
                with self.subTest(config=config["name"], ranks=ranks):
                    run = self.optimize(config, ranks, 2)
                    expected, fields = run.json("summary.json")["binary"], read_result(run)
                    again, found, found_fields = self.judged_again(3 - ranks, run)
                    self.assertEqual(found["verdict"], expected["verdict"])
                    for name in CHECKED:
                        self.assertEqual(name in found_fields, name in fields, name)
                        if name in fields:
                            np.testing.assert_array_equal(*map(self.comparable(name), (found_fields, fields)), name)
                    for name, values in expected["checks"].items():
                        if name != "gradient":
                            self.assertEqual(found["checks"][name], values, name)
                    for time in ("as_built", "released"):
                        if expected["finished"][time]:
                            ours, theirs = (one["finished"][time]["skin"]["rms"] for one in (found, expected))
                            self.assertAlmostEqual(ours / theirs, 1, delta=1e-4)
                    source = {"direct_elements": "differences", "tee": "sequence"}.get(config["name"], "file")
                    self.assertEqual(found["checks"]["gradient"], source)
                    self.assertEqual("checks of direction and thickness: by" in again.stdout, source != "sequence")

    def test_baselines_of_a_run(self):
        run = self.optimize(cases()[0], 1, 1)
        planar = run.json("summary.json")["baseline"]
        _, found, fields = self.judged_again(2, run, "result.h5", "-set", "sequence.dataset=planar/time", "-layers",
                                             len(planar["layers"]))
        self.assertEqual(found["verdict"], planar["verdict"])
        np.testing.assert_array_equal(fields["hanging"], read_result(run)["planar/hanging"])

    def test_a_simulation_is_a_run_too(self):
        """Its config.json repeats it, with the time points and print directions that it has read."""
        variable = cases()[2]
        for config in (variable, cases()[4]):
            _, found, fields = self.judged_again(1, self.optimize(config, 1, 2))
            again = self.run_config(2, os.path.join(self.directory, f"output_{self.runs}", "config.json"), "-task", "simulate")
            self.assert_done(again)
            self.assertEqual(again.json("summary.json")["verdict"], found["verdict"], config["name"])
            np.testing.assert_array_equal(read_result(again)["layer"], fields["layer"], config["name"])

    def test_gradient_of_other_times(self):
        run = self.optimize(cases()[0], 1, 1)
        with h5py.File(run.path("result.h5"), "r") as file, h5py.File(run.path("other.h5"), "w") as other:
            other["time"] = 1.0 - file["time"][()]
            other["time_gradient"] = file["time_gradient"][()]
            alone = file["time"][()]
        again, _, _ = self.judged_again(2, run, "other.h5")
        self.assertIn("warning: /sequence/file: the gradient recorded beside the times points elsewhere", again.stderr)
        for factor, status in ((1.04, run_fabseq.DONE), (3.0, run_fabseq.BAD_INPUT)):
            with h5py.File(run.path("alone.h5"), "w") as file:
                file["time"] = factor * alone / alone.max()
            again = self.run_config(1, run.path("config.json"), "-task", "simulate", "-sequence", run.path("alone.h5"))
            self.assertEqual(again.status, status, str(again))
        self.assertIn("holds values outside the part's time range, from 0 to 3; allowed: 0 to 1", again.stderr)

    def test_times_alone(self):
        """Upright layers from times alone: what differences say is what the planes say."""
        config = plate_2d()
        config["tool"] = TOOL
        config["layers"]["count"] = 6
        planar = self.run_config(1, config | {"sequence": {"type": "planar"}}, "-task", "simulate")
        self.assert_done(planar)
        expected, data = planar.json("summary.json"), read_result(planar)
        path = os.path.join(self.directory, "times.h5")
        with h5py.File(path, "w") as file:
            file["time"] = data["time"]
        again = self.run_config(2, config, "-task", "simulate", "-sequence", path)
        self.assert_done(again)
        found, fields = again.json("summary.json"), read_result(again)
        for name in ("hanging", "tilt", "blocked"):
            np.testing.assert_allclose(fields[name], data[name], atol=1e-5, err_msg=name)
        np.testing.assert_allclose(fields["local_thickness"], data["local_thickness"], rtol=1e-6)
        self.assertEqual(found["verdict"]["buildable"], expected["verdict"]["buildable"])
        self.assertIn("differences of the", again.stdout)
        self.assertNotIn("time_gradient", fields)


if __name__ == "__main__":
    run_fabseq.main()
