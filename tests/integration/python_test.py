# SPDX-License-Identifier: MIT
"""The Python module: its values and gradients are the program's, and agree with differences, on one rank and
on several; what it refuses; MPI that somebody else has begun; the example with another optimizer."""

import json
import os
import re
import textwrap
import unittest

import h5py
import numpy as np

import run_fabseq
from run_fabseq import BAD_INPUT, DONE, FabseqTest, ROOT, launcher
from small_parts import direct_2d, hook_3d, plate_2d

BUILD = os.environ.get("FABSEQ_BUILD", os.path.join(ROOT, "build", "release"))
FOLDER = os.path.join(BUILD, "python")
HERE = os.path.dirname(os.path.abspath(__file__))
LIMIT = 1e-6  # of a derivative, relative
WHICH_IS_BUILT = unittest.skipIf(os.environ.get("FABSEQ_PYTHON") == "0", run_fabseq.OF_THIS_BUILD + "it has no Python module")


def guided_2d():
    config = plate_2d()
    config["sequence"] = {"type": "guided", "stretch": [0.7, 1.5]}
    config["tool"] = {"profile": [[0.1, 0.05], [0.5, 0.3]], "max_tilt": 50, "thickness": [0.7, 1.5]}
    return config


@run_fabseq.only_release
@WHICH_IS_BUILT
class PythonTest(FabseqTest):
    def run_python(self, ranks, *arguments):
        """Status, stdout and stderr of a program of Python that finds the module."""
        environment = {"PYTHONPATH": FOLDER}
        command = [*launcher(ranks), "/usr/bin/python3", *arguments]
        with run_fabseq.Process(command, self.directory, environment) as process:
            return process.wait(300)

    def output_of(self, ranks, *arguments):
        status, stdout, stderr = self.run_python(ranks, *arguments)
        self.assertEqual(status, DONE, f"{arguments}\n{stdout}{stderr}")
        return stdout

    def run_lines(self, ranks, text):
        """What a program prints, of which only its first rank does."""
        return self.output_of(ranks, "-c", "import fabseq\n" + textwrap.dedent(text)).splitlines()

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

    def test_what_is_wrong_is_one_line(self):
        """The program's line for a config; then what calls expect."""
        path = self.write_config({**plate_2d(), "layer": {}})
        refused = self.run_program(1, "-config", path)
        self.assertEqual(refused.status, BAD_INPUT)
        for ranks in (1, 2):
            lines = self.run_lines(ranks, f"""
                import numpy as np
                def report(call, *arguments):
                    try:
                        call(*arguments)
                    except Exception as error:
                        print(type(error).__name__, error, flush=True)
                report(fabseq.Problem, {path!r})
                report(fabseq.Problem, "missing.json")
                report(fabseq.Problem, {{"domain": 3}})
                problem = fabseq.Problem({plate_2d()!r})
                report(problem.gradients)
                report(problem.evaluate, np.ones(3))
                report(problem.evaluate, np.nan * problem.design)
                for beta in (-1, 0, np.inf, np.nan, 1e300, 1e-300):
                    report(problem.evaluate, problem.design, beta)
                problem.evaluate(problem.design)
                report(problem.gradients, "objective_7")
                report(problem.share, np.ones(3))
                problem.close()
                report(problem.evaluate, np.ones(3))
            """)
            text = "\n".join(lines)  # mpirun may join lines of two ranks
            self.assertEqual((text.count("ValueError"), text.count("RuntimeError")), (14 * ranks, ranks), text)
            self.assertIn(refused.stderr.strip().removeprefix("fabseq: "), text)
            for expected in ("missing.json", "/domain", "after evaluate", "beta: found -1.0; allowed: a number > 0",
                             r"design: found 3 values; allowed: \d+", "not finite", 'found "objective_7"',
                             "whole: found 3 values", "RuntimeError the problem is closed"):
                self.assertRegex(text, expected)

    def reported(self, ranks, text):
        """What calls raise, each on a line of its own file for each rank."""
        head = """
            import os, traceback
            import numpy as np
            from mpi4py import MPI
            rank = MPI.COMM_WORLD.rank
            lines = open(f"report_{rank}.txt", "w")
            def report(call, *arguments, **named):
                try:
                    call(*arguments, **named)
                    print("done", file=lines, flush=True)
                except Exception as error:
                    print(type(error).__name__, error, file=lines, flush=True)
        """
        status, stdout, stderr = self.run_python(ranks, "-c", "import fabseq\n" + textwrap.dedent(head) + textwrap.dedent(text))
        found = []
        for rank in range(ranks):
            with open(os.path.join(self.directory, f"report_{rank}.txt"), encoding="utf-8") as file:
                found.append(file.read().splitlines())
        return status, found, stdout + stderr

    def test_ranks_with_other_arguments(self):
        """All of them raise the same, and none waits for the others."""
        status, found, text = self.reported(2, f"""
            config = {plate_2d()!r}
            report(fabseq.Problem, config, set={{"layers.count": 8 if rank else 3}})
            report(fabseq.Problem, config, set={{"layers.count": 3}} if rank else {{}})
            report(fabseq.Problem, {{**config, "layers": {{"count": 3 + rank}}}})
            report(fabseq.Problem, config if rank else "missing.json")
            problem = fabseq.Problem(dict(reversed(config.items())) if rank else config)
            report(problem.evaluate, problem.design, beta=4.0 if rank else None)
            report(problem.evaluate, problem.design)
            report(problem.gradients, "objective_0" if rank else "objective_1")
            report(problem.gradients if rank else problem.fields)
            other = fabseq.Problem(config)
            report((other if rank else problem).evaluate, problem.design)
            report(problem.evaluate, problem.design)
        """)
        self.assertEqual(status, DONE, text)
        same = "on rank 0; allowed: the same on all ranks"
        self.assertEqual(found[0], [
            f"ValueError Problem(): /set/layers.count: found 8 on rank 1 and 3 {same}",
            f"ValueError Problem(): /set/layers.count: found 3 on rank 1 and nothing {same}",
            f"ValueError Problem(): /config/layers/count: found 4 on rank 1 and 3 {same}",
            found[1][3],
            f"ValueError evaluate(): /beta: found 4.0 on rank 1 and null {same}",
            "done",
            f"ValueError gradients(): /names: found [\"objective_0\"] on rank 1 and [\"objective_1\"] {same}",
            "RuntimeError found gradients() of problem 1 on rank 1 and fields() of problem 1 on rank 0; allowed: the same "
            "call on all ranks",
            "RuntimeError found evaluate() of problem 2 on rank 1 and evaluate() of problem 1 on rank 0; allowed: the same "
            "call on all ranks",
            "done"])
        self.assertIn("and \"missing.json\" on rank 0", found[0][3])
        self.assertEqual(found[0], found[1])

    def test_what_one_rank_raises(self):
        """Designs of a wrong shape or kind, wrong names, configs that are none: all ranks raise it."""
        status, found, text = self.reported(2, f"""
            config = {plate_2d()!r}
            report(fabseq.Problem, {{**config, "name": object()}} if rank else config)
            report(fabseq.Problem, 3 if rank else config)
            report(fabseq.Problem, config, set=[] if rank else {{}})
            problem = fabseq.Problem(config)
            design = problem.design
            for wrong in (np.ones(3), design[:, None], design + 1j, "design", None, np.nan * design):
                report(problem.evaluate, wrong if rank else design)
            report(problem.evaluate, design, beta="four" if rank else 4)
            report(problem.evaluate, design)
            report(problem.gradients, 3 if rank else "objective_0")
            report(problem.share, np.ones(3))
            if rank:
                problem.close()
            report(problem.evaluate, design)
        """)
        self.assertEqual(status, DONE, text)
        expected = [
            "TypeError rank 1: Object of type object is not JSON serializable",
            "TypeError rank 1: expected str, bytes",
            r"TypeError rank 1: set: found \[\]; allowed: a dict",
            r"ValueError design: found 3 values; allowed: \d+",
            "ValueError rank 1: design: found an array with 2 axes; allowed: 1",
            r"TypeError rank 1: design: found array\(",
            "TypeError rank 1: design: found 'design'; allowed: an array of numbers",
            "ValueError rank 1: design: found an array with 0 axes; allowed: 1",
            "ValueError design: found a value that is not finite",
            "TypeError rank 1: beta: found 'four'; allowed: a number",
            "done",
            "TypeError rank 1: gradients: found 3; allowed: names",
            r"ValueError whole: found 3 values; allowed: \d+",
            "RuntimeError rank 1: the problem is closed"]
        self.assertEqual(len(found[0]), len(expected), found[0])
        for line, pattern in zip(found[0], expected, strict=True):
            self.assertRegex(line, f"^{pattern}")
        self.assertEqual(found[0], found[1])

    def test_one_rank_leaves(self):
        """By an exception that nobody catches, or by its end: the other raises, and the program ends."""
        for leave, status in (("raise KeyError('of the program')", 1), ("sys.exit(0)", DONE)):
            with self.subTest(leave=leave):
                found_status, found, text = self.reported(2, f"""
                    import sys
                    problem = fabseq.Problem({plate_2d()!r})
                    report(problem.evaluate, problem.design)
                    if rank:
                        {leave}
                    for _ in range(2):
                        report(problem.evaluate, problem.design)
                """)
                self.assertEqual(found_status, status, text)
                self.assertEqual(found[1], ["done"])
                self.assertEqual(found[0], ["done"] + 2 * [
                    "RuntimeError found the end of the program on rank 1 and evaluate() of problem 1 on rank 0; allowed: "
                    "the same call on all ranks"])

    def test_an_object_without_init(self):
        for ranks in (1, 2):
            status, found, text = self.reported(ranks, f"""
                empty = fabseq.Problem.__new__(fabseq.Problem)
                for name in ("rank", "design", "bounds", "logarithmic"):
                    report(getattr, empty, name)
                for call in (empty.evaluate, empty.gather, empty.share):
                    report(call, np.ones(3))
                for call in (empty.gradients, empty.fields, empty.close):
                    report(call)
                report(fabseq.Problem.evaluate, "text", np.ones(3))
                problem = fabseq.Problem({plate_2d()!r})
                report((empty if rank else problem).fields)
                del empty
                report(problem.evaluate, problem.design)
            """)
            self.assertEqual(status, DONE, text)
            without = "TypeError found a fabseq.Problem without __init__; allowed: fabseq.Problem(config)"
            self.assertEqual(found[0][:10], 10 * [without])
            self.assertEqual(found[0][10], "TypeError found 'text'; allowed: a fabseq.Problem")
            self.assertEqual(found[0][11:], [without.replace(" found", " rank 1: found"), "done"] if ranks == 2
                             else ["ValueError gradients, fields: found no evaluated design; allowed: after evaluate()", "done"])
            self.assertTrue(all(lines == found[0] for lines in found))

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

    def test_mpi_that_has_ended(self):
        """Nothing that is left then is an error."""
        lines = self.run_lines(2, f"""
            import numpy as np
            from mpi4py import MPI
            problem = fabseq.Problem({plate_2d()!r})
            MPI.Finalize()
            design = np.ones(3)
            for call in (lambda: fabseq.Problem({plate_2d()!r}), lambda: problem.evaluate(design), problem.gradients,
                         problem.fields, lambda: problem.gather(design), lambda: problem.share(design), lambda: problem.rank,
                         lambda: problem.bounds, lambda: problem.design, lambda: problem.logarithmic):
                try:
                    call()
                except RuntimeError as error:
                    print(error, flush=True)
            problem.close()
        """)
        self.assertEqual("".join(lines), 2 * 10 * "MPI has ended")

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
