# SPDX-License-Identifier: MIT
"""figures/reproduce.py runs a case, goes on with one that was interrupted, and writes its figures,
leaving the others."""

import csv
import glob
import json
import os
import shlex
import subprocess
import sys

import run_fabseq
from run_fabseq import ENVIRONMENT, FabseqTest, PROGRAM, Process, ROOT, Result
from small_parts import direct_2d, hook_3d, plate_2d

SCRIPT = os.path.join(ROOT, "benchmarks", "evidence", "figures", "reproduce.py")
DOCUMENT = "# Results\n\nBefore.\n\n<!-- cases -->\n<!-- end of cases -->\n\nAfter.\n"
GALLERY = "# Made up\n\nBefore.\n\n<!-- cases of made up -->\n<!-- end of cases -->\n\nAfter.\n"


class ReproduceTest(FabseqTest):
    def setUp(self):
        super().setUp()
        for config in (plate_2d(), direct_2d("elements"), hook_3d()):
            self.write_config(config, config["name"] + ".json")
        cases = {"wall": {"config": "plate.json", "source": "made up", "what": "a wall",
                          "published": {"planar": 2.0, "optimized": 0.5},
                          "set": {"constraints.layer_thickness.target": 0.35, "layers.count": "auto"}, "reslice": [8]},
                 "wall_free": {"config": "direct_elements.json", "source": "made up", "what": "a wall"},
                 "wall_fine": {"like": "wall", "what": "a wall", "set": {"layers.count": 9}},
                 "planar": {"config": "hook.json", "source": "made up §1", "what": "a hook", "task": "simulate",
                            "set": {"sequence": {"type": "planar"}}}}
        self.cases = self.write_config(cases, "cases.json")
        self.document = os.path.join(self.directory, "results.md")
        self.folder = os.path.join(self.directory, "results", "cases")
        os.makedirs(self.folder)
        for path, text in ((self.document, DOCUMENT), (os.path.join(self.folder, "page.md"), GALLERY)):
            with open(path, "w", encoding="utf-8") as file:
                file.write(text)

    def reproduce(self, *words):
        command = [sys.executable, SCRIPT, "--cases", self.cases, "--results", self.document, "--program", PROGRAM, *words]
        return subprocess.run(command, capture_output=True, text=True, cwd=self.directory, check=False,
                              env={**ENVIRONMENT, **os.environ, "OMPI_MCA_odls_base_sigkill_timeout": "0"})

    def written(self, path, before):
        """The text of a page between its marks; what was written by hand is still there."""
        with open(path, encoding="utf-8") as file:
            text = file.read()
        head, tail = before.split("<!-- end of cases -->")
        self.assertTrue(text.startswith(head) and text.endswith("\n<!-- end of cases -->" + tail), text)
        return text.removeprefix(head).removesuffix("\n<!-- end of cases -->" + tail)

    def rows(self):
        """Of the overview, by name."""
        lines = [line for line in self.written(self.document, DOCUMENT).splitlines() if line.startswith("| [")]
        rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in lines]
        for row in rows:
            self.assertRegex(row[0], r"^\[\w+\]\(results/cases/page\.md\)$")
        return {row[0][1:].split("]")[0]: row for row in rows}

    def figures(self):
        """The table of figures: rows by name and by the number of layers that a time was cut into."""
        with open(os.path.join(self.folder, "cases.csv"), encoding="utf-8", newline="") as file:
            return {(row["case"], row["cut_into"]): row for row in csv.DictReader(file)}

    def test_cases(self):
        done = self.reproduce("wall_free", "--", "-max_iterations", "2")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(set(self.rows()), {"wall_free"})
        output = os.path.join(self.directory, "output", "cases", "wall")
        os.makedirs(output)
        with open(os.path.join(output, "stop"), "w", encoding="utf-8") as file:
            file.write("1\n")
        stopped = self.reproduce("wall", "--", "-max_iterations", "3")
        self.assertEqual(stopped.returncode, 2)
        self.assertIn("failed: wall", stopped.stderr)
        self.assertEqual(set(self.rows()), {"wall_free"})
        before = self.rows()["wall_free"]
        done = self.reproduce("wall", "planar", "--ranks", "1", "--picture", "--", "-max_iterations", "3")
        self.assertIn("continues after iteration 1", done.stdout)
        self.assertEqual(done.returncode, 0, done.stderr)
        rows = self.rows()
        self.assertEqual(list(rows), ["wall", "wall_free", "planar"])  # in the order of the cases
        self.assertEqual(rows["wall_free"], before)
        self.check_case(rows["wall"], output)
        self.assertEqual(rows["planar"][1:], ["–"] * 5)
        self.assertIn("largest displacement", self.figures()["planar", ""]["run"])
        self.assertEqual(glob.glob(self.folder + "/*.png"), [self.folder + "/wall.png"])

    def check_case(self, row, output):
        with open(os.path.join(output, "summary.json"), encoding="utf-8") as file:
            summary = json.load(file)
        planar, smooth, binary = (summary[block]["responses"][0]["value"] for block in ("baseline", "optimized", "binary"))
        figures, cut = self.figures()["wall", ""], self.figures()["wall", "8"]
        page = self.written(os.path.join(self.folder, "page.md"), GALLERY)
        self.assertIn(f"- `wall`: a wall [made up]; {figures['run']}.", page)
        gains = (f"{figures[kind]}: {figures[kind + '_factor']}" for kind in ("smooth", "binary"))
        self.assertIn("\n| wall | " + " | ".join(["2 → 0.5: 4.0", figures["planar"], *gains]) + " |\n", page)
        self.assertIn("\n![layers and distorted shapes, planar and optimized](wall.png)", page)
        self.assertEqual(row[1], "4.0")
        of_planar, of_binary = (summary[block]["deposition"]["nominal"]["distortion"][0]["value"]
                                for block in ("baseline", "binary"))
        self.assertEqual(row[4], figures["nominal_factor"])
        self.assertAlmostEqual(float(row[4]), of_planar / of_binary, delta=0.06 * max(1, of_planar / of_binary))
        self.assertEqual(row[5], figures["constraints"])
        self.assertAlmostEqual(float(figures["planar"]) / planar, 1, delta=0.01)
        for shown, kind, value in ((row[2], "smooth", smooth), (row[3], "binary", binary)):
            ratio = figures[kind + "_factor"]
            self.assertEqual(shown, ratio)
            self.assertAlmostEqual(float(figures[kind]) / value, 1, delta=0.01)
            self.assertAlmostEqual(float(ratio), planar / value, delta=0.06 * max(1, planar / value))
            self.assertRegex(f"{cut[kind]}: {cut[kind + '_factor']}", r"^[0-9.e-]+: [0-9.]+$")
        self.assertRegex(cut["thickness_geometric"], "^[0-9.]+ to [0-9.]+$")
        self.assertIn("on 1 rank", figures["run"])
        self.assertLess(os.path.getsize(os.path.join(self.folder, "wall.png")), 80000)
        self.assertTrue(os.path.exists(os.path.join(output, "geometric_thickness.json")))

    def test_list_and_mistakes(self):
        listed = self.reproduce("--list")
        self.assertEqual(listed.returncode, 0, listed.stderr)
        self.assertEqual([line.split()[:2] for line in listed.stdout.splitlines()],
                         [["wall", "2D"], ["wall_free", "2D"], ["wall_fine", "2D"], ["planar", "3D"]])
        command = self.reproduce("--command", "wall_fine", "--ranks", "3").stdout
        self.assertEqual(command, f"mpirun -np 3 {PROGRAM} -config {self.directory}/plate.json -task optimize "
                         "-set constraints.layer_thickness.target=0.35 -set layers.count=9\n")
        for words, message in ((["wal"], "no such case"), ([], "no case given")):
            refused = self.reproduce(*words)
            self.assertEqual(refused.returncode, 2)
            self.assertIn(message, refused.stderr)

    def test_all_published_cases_are_accepted(self):
        """Every case of configs/published/cases.json and of the studies is one that the program takes."""
        paths = [os.path.join(ROOT, "configs", "published", "cases.json"),
                 *sorted(glob.glob(os.path.join(ROOT, "benchmarks", "evidence", "studies", "*_cases.json")))]
        self.assertGreater(len(paths), 1)
        for path in paths:
            with open(path, encoding="utf-8") as file:
                names = list(json.load(file))
            commands = self.reproduce("--cases", path, "--command", *names).stdout.splitlines()
            for name, command in zip(names, commands, strict=True):
                with self.subTest(name):
                    words = shlex.split(command)
                    words = words[words.index(PROGRAM) + 1:]
                    words[words.index("-task") + 1] = "check"
                    with Process([PROGRAM, *words], self.directory) as process:  # many: without mpirun, in half the time
                        run = Result(process.command, *process.wait(120), "")
                    self.assert_done(run)
                    self.assertIn("estimate", run.stdout)


if __name__ == "__main__":
    run_fabseq.main()
