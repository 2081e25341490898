# SPDX-License-Identifier: MIT
"""The Python module: its values and gradients are the program's, and agree with differences, on one rank and
on several; MPI that somebody else has begun; the example with another optimizer."""

import json
import os
import re

import h5py
import numpy as np

import run_fabseq
from python_case import PythonModuleTest
from run_fabseq import ROOT
from small_parts import direct_2d, hook_3d, plate_2d

HERE = os.path.dirname(os.path.abspath(__file__))
LIMIT = 1e-6  # of a derivative, relative


def guided_2d():
    config = plate_2d()
    config["sequence"] = {"type": "guided", "stretch": [0.7, 1.5]}
    config["tool"] = {"profile": [[0.1, 0.05], [0.5, 0.3]], "max_tilt": 50, "thickness": [0.7, 1.5]}
    return config


class PythonTest(PythonModuleTest):
    def test_gradients_agree_with_differences(self):
        """Of diffusivities, of tilts and stretches, of times and time points, and in three dimensions."""
        for config in (plate_2d(), guided_2d(), direct_2d(), hook_3d()):
            path = self.write_config(config)
            found = {}
            for ranks in (1, 2):
                self.output_of(ranks, os.path.join(HERE, "check_python_module.py"), path)
                reports = []
                for rank in range(ranks):
                    with open(os.path.join(self.directory, f"report_{rank}.json"), encoding="utf-8") as file:
                        reports.append(json.load(file))
                self.assertEqual(sum(report.pop("share") for report in reports), reports[0]["whole"])
                self.assertTrue(all(report == reports[0] for report in reports))  # ranks may run an optimizer each
                found[ranks] = reports[0]
                for name, adjoint in reports[0]["adjoints"].items():
                    with self.subTest(case=config["name"], ranks=ranks, component=name):
                        self.assertAlmostEqual(reports[0]["differences"][name] / adjoint, 1, delta=LIMIT)
            for name, value in found[1]["values"].items():
                self.assertAlmostEqual(found[2]["values"][name], value, delta=1e-6 * abs(value), msg=name)

    def test_values_gradients_and_fields_are_the_programs(self):
        """Bit for bit on one rank."""
        config = direct_2d()
        evaluated = self.run_config(1, config, "-task", "evaluate")
        self.assert_done(evaluated)
        path = self.write_config(config)
        text = f"""
            import numpy as np
            problem = fabseq.Problem({path!r})
            values = problem.evaluate(problem.design)
            np.savez("values.npz", names=list(values), values=list(values.values()))
            np.savez("gradients.npz", **problem.gradients())
            np.savez("some.npz", **problem.gradients("constraint_1_0"))
            np.savez("fields.npz", **problem.fields())
        """
        self.assertEqual(self.run_lines(1, text), [])
        values, gradients, some, fields = (np.load(os.path.join(self.directory, name + ".npz"))
                                           for name in ("values", "gradients", "some", "fields"))
        expected = evaluated.json("evaluation.json")["responses"]
        self.assertEqual(list(values["names"]), [response["name"] for response in expected])
        self.assertEqual(list(values["values"]), [response["value"] for response in expected])
        self.assertEqual(list(some), ["constraint_1_0"])
        with h5py.File(evaluated.path("gradients.h5"), "r") as file:
            places = fields["design"].ravel() != 0
            for name, gradient in gradients.items():
                of_field, of_points = np.split(gradient, [places.sum()])
                np.testing.assert_array_equal(of_field, np.array(file[name]["design"]).ravel()[places], name)
                np.testing.assert_array_equal(of_points, np.array(file[name]["time_points"]), name)
        self.assertEqual(fields["time"].shape, (12, 20))
        self.assertEqual(fields["displacement"].shape, (13, 21, 2))
        self.assertEqual(fields["design"].shape, (13, 21))
        self.assertEqual(sorted(set(fields["layer"].ravel())), [0, 1, 2, 3, 4])

    def test_plastic_flow(self):
        """A second evaluation begins from the first one's state, and ends with the same."""
        config = hook_3d()
        config["process"] = {"model": "elastoplastic", "deposition": "nominal"}
        config["material"] = {"yield_stress": 0.002, "hardening": 0.02}
        evaluated = self.run_config(1, config, "-task", "evaluate")
        self.assert_done(evaluated)
        self.assertEqual(self.run_lines(1, f"""
            import numpy as np
            problem = fabseq.Problem({self.write_config(config)!r})
            problem.evaluate(0.9 * problem.design)
            values = problem.evaluate(problem.design)
            np.savez("values.npz", values=list(values.values()))
            np.savez("gradients.npz", **problem.gradients("objective_0"))
        """), [])
        expected = [response["value"] for response in evaluated.json("evaluation.json")["responses"]]
        np.testing.assert_allclose(np.load(os.path.join(self.directory, "values.npz"))["values"], expected, rtol=1e-7)
        gradient = np.load(os.path.join(self.directory, "gradients.npz"))["objective_0"]
        with h5py.File(evaluated.path("gradients.h5"), "r") as file:
            of_program = np.array(file["objective_0/design"]).ravel()
        self.assertAlmostEqual(np.linalg.norm(gradient) / np.linalg.norm(of_program), 1, delta=1e-6)

    def test_fields_do_not_depend_on_the_ranks(self):
        path = self.write_config(hook_3d())
        for ranks in (1, 2):
            self.assertEqual(self.run_lines(ranks, f"""
                import numpy as np
                problem = fabseq.Problem({path!r}, set={{"solver.tolerance": 1e-10}})
                problem.evaluate(problem.design)
                np.savez("fields_{ranks}.npz", **problem.fields())
            """), [])
        one, two = (np.load(os.path.join(self.directory, f"fields_{ranks}.npz")) for ranks in (1, 2))
        self.assertEqual(list(one), list(two))
        for name in one:
            np.testing.assert_allclose(two[name], one[name], atol=1e-7 * np.abs(one[name]).max(), err_msg=name)

    def test_dict_and_other_values_for_keys(self):
        config = plate_2d()
        (line,) = self.run_lines(1, f"""
            by_dict = fabseq.Problem({config!r}, set={{"layers.count": 3, "objective.1.weight": 0.5}})
            by_file = fabseq.Problem({self.write_config({**config, "layers": {"count": 3}})!r})
            values = [problem.evaluate(problem.design) for problem in (by_dict, by_file)]
            print(values[0] == values[1], len(values[0]))
        """)
        self.assertEqual(line, "True 5")

    def test_sharpness(self):
        """As -task evaluate with another projection.beta."""
        config = plate_2d()
        evaluated = self.run_config(1, config, "-task", "evaluate", "-set", "projection.beta=23")
        expected = [response["value"] for response in evaluated.json("evaluation.json")["responses"]]
        (line,) = self.run_lines(1, f"""
            problem = fabseq.Problem({config!r})
            print(list(problem.evaluate(problem.design, beta=23).values()))
        """)
        self.assertEqual(json.loads(line), expected)

    def test_mpi_of_others(self):
        """mpi4py before and after it: MPI goes on until who has begun it ends it."""
        for first, second in (("from mpi4py import MPI", "pass"), ("pass", "from mpi4py import MPI")):
            for ranks in (1, 2):
                lines = self.run_lines(ranks, f"""
                    {first}
                    problem = fabseq.Problem({plate_2d()!r})
                    {second}
                    from mpi4py import MPI
                    values = problem.evaluate(problem.design)
                    whole = problem.gather(problem.design)
                    total = MPI.COMM_WORLD.allreduce(len(problem.design))
                    if problem.rank == 0:
                        print(MPI.COMM_WORLD.size, total, len(whole))
                """)
                size, total, whole = map(int, lines[0].split())
                self.assertEqual((size, total), (ranks, whole))

    def test_another_optimizer(self):
        """docs/example/scipy_optimizer.py, which says what it has reached."""
        for ranks in (1, 2):
            text = self.output_of(ranks, os.path.join(ROOT, "docs", "example", "scipy_optimizer.py"))
            ((first, last),) = re.findall(r"distortion: ([-.\de]+) to ([-.\de]+)", text)
            self.assertLess(float(last), 0.7 * float(first), text)
            (worst,) = re.findall(r"worst thickness: ([-.\d]+) of the target", text)
            self.assertAlmostEqual(float(worst), 1.0, delta=0.17, msg=text)


if __name__ == "__main__":
    run_fabseq.main()
