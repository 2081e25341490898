"""The scripts of benchmarks/ run the program and report what they should; not how fast it is."""

import json
import os

import run_fabseq
from run_fabseq import DONE, PROGRAM, ROOT, FabseqTest, only_release, run_command
from small_parts import hook_3d


@only_release
class BenchmarkScriptTest(FabseqTest):
    def run_script(self, name, *arguments):
        """Printed lines, and the JSON record."""
        record = os.path.join(self.directory, "record.json")
        script = os.path.join(ROOT, "benchmarks", name)
        config = hook_3d()
        config["domain"]["elements"] = [16, 8, 16]  # more than the lanes solve directly
        command = ["bash", script, self.write_config(config), "--program", PROGRAM, "--repetitions", "1", "--json", record,
                   *map(str, arguments)]
        status, stdout, stderr = run_command(command, self.directory, 120)
        self.assertEqual(status, DONE, stdout + stderr)
        with open(record, encoding="utf-8") as file:
            return stdout.splitlines(), json.load(file)

    def test_iteration_compares_methods_at_equal_errors(self):
        lines, record = self.run_script("iteration.sh", "--iterations", 1, "--methods", "lanes", "gamg", "--", "-move_limit", 0.02)
        errors = {(entry["method"], entry["tolerance"]): entry["error"] for entry in record["errors"]["errors"]}
        of_lanes = errors["lanes", record["tolerances"]["lanes"]]
        of_gamg = errors["gamg", record["tolerances"]["gamg"]]
        self.assertLess(of_lanes, 1e-3)
        self.assertLess(of_gamg, 10 * of_lanes)
        self.assertGreater(10 * of_gamg, of_lanes)
        self.assertLess(errors["lanes", 1e-11], 1e-8)
        for method in ("lanes", "gamg"):
            figures = record["medians"][method]
            self.assertEqual(figures["solves"], 6)
            self.assertGreater(figures["total"], figures["primal"])
            self.assertGreater(figures["seconds_a_solve"], 0)
            self.assertGreater(figures["peak_memory_gigabytes"], 0)
            self.assertEqual(len(record["samples"][method]), 1)
        self.assertIn("type: gamg", " ".join(record["settings"]["gamg"]["petsc"]))
        total = next(line.split() for line in lines if line.startswith("total"))
        self.assertEqual(len(total), 4)  # two methods and their ratio

    def test_layers_are_timed_on_one_and_two_ranks(self):
        lines, record = self.run_script("layers.sh", "--layers", 2, 3, "--ranks", 1, 2)
        self.assertEqual([(run["layers"], run["ranks"]) for run in record["runs"]], [(2, 1), (2, 2), (3, 1), (3, 2)])
        self.assertTrue(all(run["primal_seconds"][0] > 0 for run in record["runs"]))
        self.assertEqual([line.split()[0] for line in lines[-2:]], ["2", "3"])


if __name__ == "__main__":
    run_fabseq.main()
