#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""fabseq-tools compare, scaling and what draws, and study_table.py, on made-up results."""

import csv
import json
import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy as np

import fake_results
from pictures import drawn

PROJECT = Path(__file__).resolve().parents[2]


class ScriptTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def run_tool(self, *words):
        return self.run_script("fabseq-tools", *words)

    def run_script(self, script, *arguments):
        return subprocess.run(["/usr/bin/python3", PROJECT / "scripts" / script, *map(str, arguments)], cwd=self.folder,
                              capture_output=True, text=True, check=False)

    def write_run(self, folder, weight=1.0, **settings):
        directory = self.folder / folder
        fake_results.write_run(directory, "plate", np.ones((8, 12)), (3.0, 2.0), iterations=4)
        self.change(directory / "config.json",
                    lambda config: (config["objective"][1].update(weight=weight), config.update(settings)))
        return directory

    def change(self, path, edit):
        content = json.loads(path.read_text())
        edit(content)
        path.write_text(json.dumps(content))

    def assert_drawn(self, name, rows, columns):
        """Every panel of a picture shows something."""
        self.assertGreater(min(drawn(self.folder / name, rows, columns)), 0.005)

    def table(self, name):
        with open(self.folder / name, encoding="utf-8", newline="") as file:
            return list(csv.DictReader(file))


class Pictures(ScriptTest):
    def test_settings(self):
        for name in ("defaults_absent", "defaults_quiet", "beta_late_absent"):
            self.write_run(f"study/{name}")
        (self.folder / "study" / "stopped_quiet").mkdir()
        done = self.run_tool("plot-settings", "study", "--picture", "s.png")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("stopped_quiet", done.stderr)
        self.assert_drawn("s.png", 1, 2)
        done = self.run_tool("plot-settings", "nothing")
        self.assertEqual((done.returncode, done.stderr.count("\n")), (2, 1))

    def test_history_over_seconds(self):
        runs = [self.write_run("a"), self.write_run("b")]
        done = self.run_tool("plot-history", *runs, "--seconds", "--picture", "h.png")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assert_drawn("h.png", 2, 2)


class Compare(ScriptTest):
    def test_table(self):
        runs = [self.write_run("a", 0.1, run={"ranks": 2}, name="x"), self.write_run("b", 10, run={"ranks": 4}, name="y")]
        layers = [{"volume": 1.0, "thickness": 0.2, "cv": 0.3}, {"volume": 3.0, "thickness": 0.1, "cv": 0.1},
                  {"volume": 0.0, "thickness": None, "cv": None}]
        self.change(runs[1] / "summary.json", lambda summary: summary["binary"].update(layers=layers))
        done = self.run_tool("compare", *runs)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        first, second = self.table("compare.csv")
        self.assertEqual(list(first)[:3], ["run", "objective.layer_uniformity.weight", "status"])
        self.assertEqual([row["objective.layer_uniformity.weight"] for row in (first, second)], ["0.1", "10"])
        self.assertEqual(first["baseline/objective_0"], "0.41")
        self.assertEqual(second["binary/layers"], "2")
        self.assertAlmostEqual(float(second["binary/cv"]), 0.15)
        self.assertAlmostEqual(float(second["binary/thickness_mean"]), 0.15)
        self.assertEqual((second["binary/thickness_max"], second["ranks"]), ("0.2", "4"))
        self.assert_drawn("compare.png", 2, 2)

    def test_a_run_that_is_not_done(self):
        runs = [self.write_run("stopped"), self.write_run("done")]
        self.change(runs[0] / "summary.json", lambda summary: (summary.pop("optimized"), summary.update(status="stopped")))
        done = self.run_tool("compare", *runs, "--table", "t.csv", "--picture", "p.png")
        self.assertEqual(done.returncode, 0)
        self.assertIn("stopped: holds no finished optimization (status: stopped)", done.stderr)
        rows = self.table("t.csv")
        self.assertEqual([(row["status"], row["optimized/objective_0"]) for row in rows],
                         [("stopped", ""), ("iteration_limit", "0.00045")])
        done = self.run_tool("compare", runs[0], self.folder / "nothing")
        self.assertEqual(done.returncode, 2)
        self.assertIn("nothing/config.json is missing", done.stderr)

    def test_several_keys(self):
        runs = [self.write_run("a", 0.1, layers={"count": 3}), self.write_run("b", 1, layers={"count": 5})]
        self.assertEqual(self.run_tool("compare", *runs).returncode, 0)
        self.assertEqual(self.run_tool("compare", *runs, "--against", "layers.count").returncode, 0)
        done = self.run_tool("compare", *runs, "--against", "material.young")
        self.assertEqual(done.returncode, 2)
        self.assertIn("they do in: objective.layer_uniformity.weight, layers.count", done.stderr)


class Scaling(ScriptTest):
    PHASES = ("heat", "layers", "primal", "adjoint", "responses", "optimizer", "output")

    def write_times(self, name, ranks, seconds, **settings):
        """A history with two slow iterations first and one in the middle."""
        directory = self.folder / name
        directory.mkdir()
        (directory / "config.json").write_text(json.dumps({"run": {"ranks": ranks}, "name": name, **settings}))
        lines = [{"seconds": {**dict.fromkeys(self.PHASES, seconds / 10), "total": factor * seconds}}
                 for factor in (9, 8, 1, 1, 5, 1)]
        (directory / "history.jsonl").write_text("".join(json.dumps(line) + "\n" for line in lines) + '{"half a li')
        return directory

    def test_figures_are_relative_to_the_fewest_ranks(self):
        """Amdahl's law with a serial fraction s on 4 ranks, relative to which 16 are 4 times as many."""
        serial = 0.1
        times = {4: 8.0, 16: 8.0 * (serial + (1 - serial) / 4)}
        runs = [self.write_times(f"r{ranks}", ranks, seconds) for ranks, seconds in reversed(times.items())]
        done = self.run_tool("scaling", *runs)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        first, second = self.table("scaling.csv")
        self.assertEqual((first["ranks"], first["speed_up"], first["efficiency"], first["karp_flatt"]), ("4", "1.0", "1.0", ""))
        self.assertEqual((second["baseline_ranks"], second["iterations"]), ("4", "4"))
        self.assertAlmostEqual(float(second["seconds"]), times[16])
        self.assertAlmostEqual(float(second["speed_up"]), 1 / 0.325)
        self.assertAlmostEqual(float(second["efficiency"]), 1 / 0.325 / 4)
        self.assertAlmostEqual(float(second["karp_flatt"]), serial)
        self.assertAlmostEqual(float(second["primal_speed_up"]), 1 / 0.325)
        self.assert_drawn("scaling.png", 1, 2)

    def test_what_cannot_be_compared(self):
        one = self.write_times("one", 1, 1.0)
        for others, words in (([self.write_times("again", 1, 1.0)], "same number of ranks"),
                              ([self.write_times("other", 2, 1.0, layers=3)], "different configs"),
                              (["--warm_up", 6], "no iteration after the first 6")):
            done = self.run_tool("scaling", one, *others)
            self.assertEqual(done.returncode, 2)
            self.assertIn(words, done.stderr)


class StudyTable(ScriptTest):
    def words(self, text, *arguments):
        (self.folder / "t.csv").write_text(text)
        done = self.run_script("slurm/study_table.py", "t.csv", *arguments)
        return done.stdout.splitlines() if done.returncode == 0 else done.stderr

    def test_rows(self):
        table = 'name,a.b,c\n# no run\none,1,"{""x"": [1, 2]}"\n\ntwo,,word\n'
        self.assertEqual(self.words(table), ["2"])
        self.assertEqual(self.words(table, 1), ["one", "-set", "a.b=1", "-set", 'c={"x": [1, 2]}'])
        self.assertEqual(self.words(table, 2), ["two", "-set", "c=word"])

    def test_errors(self):
        for table, number, words in (("a,b\n1,2\n", 1, "the first of them 'name'"),
                                     ("name,b\nx\n", 1, "line 2: 1 columns in place of 2"),
                                     ("name,b\nx,1\n", 2, "has runs 1 to 1, but no run 2"), ("name,b\n../x,1\n", 1, "'../x'"),
                                     ("name,b\nx,1\nx,2\n", 1, "line 3: there is another run 'x'"), ("", 1, "first line"),
                                     ("name,b\n.,1\n", 1, "'.'")):
            self.assertIn(words, self.words(table, number), table)

    def test_table_of_the_repository(self):
        done = self.run_script("slurm/study_table.py", PROJECT / "configs" / "alpha_study.csv", 4)
        self.assertEqual(done.stdout.splitlines(), ["alpha_10", "-set", "objective.layer_uniformity.weight=10"])


if __name__ == "__main__":
    unittest.main(verbosity=2)
