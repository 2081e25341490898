# SPDX-License-Identifier: MIT
"""What the Python module refuses: one line, on all ranks the same, whichever rank is wrong, leaves early or
comes after the end of MPI."""

import os
import textwrap

import run_fabseq
from python_case import PythonModuleTest
from run_fabseq import BAD_INPUT, DONE
from small_parts import plate_2d


class PythonErrorsTest(PythonModuleTest):
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
        program = "import fabseq\n" + textwrap.dedent(head) + textwrap.dedent(text)
        status, stdout, stderr = self.run_python(ranks, "-c", program)
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
            "RuntimeError found gradients() of problem 1 on rank 1 and fields() of problem 1 on rank 0; allowed: the "
            "same call on all ranks",
            "RuntimeError found evaluate() of problem 2 on rank 1 and evaluate() of problem 1 on rank 0; allowed: the "
            "same call on all ranks",
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
                    "RuntimeError found the end of the program on rank 1 and evaluate() of problem 1 on rank 0; "
                    "allowed: the same call on all ranks"])

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
            alone = "ValueError gradients, fields: found no evaluated design; allowed: after evaluate()"
            with_others = without.replace(" found", " rank 1: found")
            self.assertEqual(found[0][11:], [with_others if ranks == 2 else alone, "done"])
            self.assertTrue(all(lines == found[0] for lines in found))

    def test_mpi_that_has_ended(self):
        """Nothing that is left then is an error."""
        lines = self.run_lines(2, f"""
            import numpy as np
            from mpi4py import MPI
            problem = fabseq.Problem({plate_2d()!r})
            MPI.Finalize()
            design = np.ones(3)
            for call in (lambda: fabseq.Problem({plate_2d()!r}), lambda: problem.evaluate(design), problem.gradients,
                         problem.fields, lambda: problem.gather(design), lambda: problem.share(design),
                         lambda: problem.rank, lambda: problem.bounds, lambda: problem.design,
                         lambda: problem.logarithmic):
                try:
                    call()
                except RuntimeError as error:
                    print(error, flush=True)
            problem.close()
        """)
        self.assertEqual("".join(lines), 2 * 10 * "MPI has ended")


if __name__ == "__main__":
    run_fabseq.main()
