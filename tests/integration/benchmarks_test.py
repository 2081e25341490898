# SPDX-License-Identifier: MIT
"""The scripts of benchmarks/ run the program and report what they should; not how fast it is."""

import csv
import json
import math
import os

import run_fabseq
from run_fabseq import DONE, PROGRAM, ROOT, FabseqTest, only_release, run_command
from small_parts import hook_3d

from pictures import drawn


@only_release
class BenchmarkScriptTest(FabseqTest):
    def run_script(self, name, *arguments):
        """Printed lines, and the JSON record."""
        record = os.path.join(self.directory, "record.json")
        script = os.path.join(ROOT, "benchmarks", name)
        config = hook_3d()
        config["domain"]["elements"] = [16, 8, 16]  # more than the lanes solve directly
        command = ["/usr/bin/python3", script, self.write_config(config), "--program", PROGRAM, "--repetitions", "1",
                   "--json", record, *map(str, arguments)]
        status, stdout, stderr = run_command(command, self.directory, 120)
        self.assertEqual(status, DONE, stdout + stderr)
        with open(record, encoding="utf-8") as file:
            return stdout.splitlines(), json.load(file)

    def test_iteration_compares_methods_at_equal_errors(self):
        lines, record = self.run_script("iteration.py", "--iterations", 1, "--methods",
                                        "lanes", "gamg", "--", "-move_limit", 0.02)
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
            self.assertGreater(figures["seconds_per_solve"], 0)
            self.assertGreater(figures["peak_memory_gigabytes"], 0)
            self.assertEqual(len(record["samples"][method]), 1)
        self.assertIn("type: gamg", " ".join(record["settings"]["gamg"]["petsc"]))
        total = next(line.split() for line in lines if line.startswith("total"))
        self.assertEqual(len(total), 4)  # two methods and their ratio

    def test_flow_over_linear(self):
        lines, record = self.run_script("flow.py", "--yield-stress", 0.002, "--iterations", 2)
        self.assertEqual(set(record["iterations"]), {"linear", "elastoplastic"})
        (flow,) = record["iterations"]["elastoplastic"]
        self.assertGreaterEqual(flow["sweeps"], 1)
        self.assertEqual(len(record["simulations"]), 3)
        table = {line[:32].strip(): line[32:].split() for line in lines[-5:]}
        linear, elastoplastic, ratio = map(float, table["iteration, s"])
        self.assertAlmostEqual(elastoplastic / linear, ratio, delta=0.1 * ratio)

    def test_layers_are_timed_on_one_and_two_ranks(self):
        lines, record = self.run_script("layers.py", "--layers", 2, 3, "--ranks", 1, 2)
        self.assertEqual([(run["layers"], run["ranks"]) for run in record["runs"]], [(2, 1), (2, 2), (3, 1), (3, 2)])
        self.assertTrue(all(run["samples"][0]["primal"] > 0 for run in record["runs"]))
        self.assertEqual([line.split()[0] for line in lines[-2:]], ["2", "3"])
        machine = record["machine"]
        self.assertEqual(machine["threads"], len(os.sched_getaffinity(0)))
        self.assertIn(machine["cores"], range(1, machine["threads"] + 1))
        self.assertTrue(0 <= machine["busy"] <= 1 and len(machine["triad"]) == 2, machine)
        self.assertIn(f" repetitions, {machine['cores']} cores ({machine['threads']} threads), ", "\n".join(lines))

    def test_spinning_and_yielding_beside_busy_processes(self):
        lines, record = self.run_script("busy_machine.py", "--ranks", 2, "--busy", 0, 1, "--", "-max_iterations", 1)
        self.assertEqual([(run["ranks"], run["busy"], run["waiting"]) for run in record["runs"]],
                         [(2, busy, waiting) for busy in (0, 1) for waiting in ("spin", "yield")])
        self.assertTrue(all(len(run["samples"]) == 1 and run["seconds"] > 0 for run in record["runs"]))
        self.assertEqual([line.split()[:2] for line in lines[-2:]], [["2", "0"], ["2", "1"]])

    def read_csv(self, name):
        with open(os.path.join(self.directory, name), encoding="utf-8", newline="") as file:
            return list(csv.DictReader(file))

    def assert_picture(self, name, columns=1):
        """Every panel shows something."""
        self.assertGreater(min(drawn(os.path.join(self.directory, name), 1, columns)), 0.003)

    def test_layers_by_phase(self):
        lines, record = self.run_script("layers.py", "--phases", "--layers", 2, 3, "--ranks", 1, "--iterations", 2,
                                        "--csv", "l.csv", "--plot", "l.png")
        total = {row["layers"]: row for row in record["table"] if row["phase"] == "total"}
        self.assertEqual(sorted(total), [2, 3])
        for layers, row in total.items():
            self.assertAlmostEqual(row["seconds_per_layer"] * layers, row["seconds"])
        self.assertEqual([line.split()[0] for line in lines[-3:]], ["2", "3", "[D24]"])
        self.assertEqual(len(self.read_csv("l.csv")), len(record["table"]))
        self.assert_picture("l.png")

    def test_strong_scaling_against_one_baseline(self):
        _, record = self.run_script("strong_scaling.py", "--ranks", 1, 2, "--baseline", "1x2", "--iterations", 3,
                                    "--warm-up", 2, "--csv", "s.csv", "--plot", "s.png")
        self.assertEqual([(run["groups"], run["domain_ranks"]) for run in record["samples"]], [(1, 1), (1, 2), (2, 1)])
        self.assertEqual([len(run["iterations"]) for run in record["samples"]], [1, 1, 1])
        total = {(row["groups"], row["domain_ranks"]): row for row in record["table"] if row["phase"] == "total"}
        reference = total[1, 2]
        self.assertEqual((reference["speed_up"], reference["efficiency"], reference["serial_fraction"]), (1.0, 1.0, None))
        for split, row in total.items():
            ratio = reference["seconds"] / row["seconds"]
            self.assertAlmostEqual(row["speed_up"], ratio)
            self.assertAlmostEqual(row["efficiency"], 2 * ratio / row["ranks"])
            if split == (1, 1):  # half of the ranks: T = T0 (f + 2 (1 - f))
                self.assertAlmostEqual(row["serial_fraction"] + 2 * (1 - row["serial_fraction"]), 1 / ratio)
        self.assertEqual([row["phase"] for row in self.read_csv("s.csv")], [row["phase"] for row in record["table"]])
        self.assert_picture("s.png", 2)

    def test_sizes_up_to_a_limit(self):
        _, record = self.run_script("size.py", "--smallest", 500, "--largest", 2500,
                                    "--iterations", 2, "--csv", "z.csv", "--plot", "z.png")
        self.assertEqual([run["box"] for run in record["runs"]], ["10x4x10", "12x6x12", "16x8x16"])
        for run, row in zip(record["runs"], self.read_csv("z.csv"), strict=True):
            self.assertGreater(run["gigabytes"], 0.01)
            self.assertEqual(int(row["part_elements"]), run["part_elements"])
            self.assertEqual(run["layer_count"], 3)
            self.assertLess(run["primal"], run["total"])
        self.assert_picture("z.png")

    def test_sizes_end_where_memory_does(self):
        used = self.run_script("size.py", "--smallest", 2048, "--largest", 2100, "--iterations", 2)[1]["runs"][0]["gigabytes"]
        runs = self.run_script("size.py", "--smallest", 2048, "--memory", 1.5 * used, "--iterations", 2)[1]["runs"]
        self.assertGreater(len(runs), 1)
        self.assertLess(runs[1]["elements"], 1.6 * runs[0]["elements"])

    def test_growth_with_layers_and_unknowns(self):
        printed, record = self.run_script("growth.py", "--layers", 2, 4, "--sizes", 500, 2500, "--ranks", 1, "--iterations", 2,
                                          "--csv", "g.csv", "--plot", "g.png")
        self.assertTrue(any("layers, 1 rank(s): exponents total " in line for line in printed))
        self.assertEqual([(run["series"], run["layer_count"], run["box"]) for run in record["runs"]],
                         [("layers", 2, "10x4x10"), ("layers", 4, "10x4x10"), ("unknowns", 2, "10x4x10"),
                          ("unknowns", 2, "18x8x18")])
        for fit, by in zip(record["fits"], ("layer_count", "unknowns"), strict=True):
            first, last = [run for run in record["runs"] if run["series"] == fit["series"]]
            self.assertAlmostEqual(fit["gigabytes"], math.log(last["gigabytes"] / first["gigabytes"])
                                   / math.log(last[by] / first[by]))
        self.assertEqual(len(self.read_csv("g.csv")), 4)
        self.assert_picture("g.png")


if __name__ == "__main__":
    run_fabseq.main()
