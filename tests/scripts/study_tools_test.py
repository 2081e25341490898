#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""fabseq-tools tradeoff and compare-families on a tiny part: tables, pictures, the page, what runs once."""

import argparse
import csv
import json
import os
import subprocess
import sys
import time

import numpy as np

import run_fabseq
from run_fabseq import ENVIRONMENT, FabseqTest, PROGRAM, ROOT
from small_parts import hook_3d, plate_2d

from fabseq_tools.report import report as report_page
from fabseq_tools.run.command_line import RunError
from fabseq_tools.run.settings import put
from fabseq_tools.study.comparison import strains
from fabseq_tools.study.families import Families
from fabseq_tools.study.rounds import Rounds
from fabseq_tools.study.tradeoff import LIMITS, later_schedule, values_of
from fabseq_tools.run.read_run import Run, target_thickness

TOOLS = os.path.join(ROOT, "scripts", "fabseq-tools")
FAMILIES = ["planar", "tilted planar, 60 degrees", "start", "heat", "guided"]


def hook(**more):
    """The shape of its skin, within the range of a process."""
    config = hook_3d()
    config["node_sets"]["skin"] = {"all": True, "surface": True}
    return config | {"objective": [{"type": "distortion", "measure": "shape", "nodes": "skin"},
                                   {"type": "layer_uniformity", "weight": 0.05}],
                     "constraints": [{"type": "layer_thickness", "target": 0.55}],
                     "optimizer": {"max_iterations": 4, "final_move_limit": 0.004},
                     "tool": {"thickness": [0.6, 1.6], "max_tilt": 60}} | more


class StudyTest(FabseqTest):
    def tool(self, command, config, *words):
        command = [sys.executable, TOOLS, command, self.write_config(config), "--program", PROGRAM, "--output", "out", *words]
        return subprocess.run(command, capture_output=True, text=True, cwd=self.directory, check=False,
                              env={**ENVIRONMENT, **os.environ})

    def path(self, *names):
        return os.path.join(self.directory, "out", *names)

    def json(self, name):
        with open(self.path(name), encoding="utf-8") as file:
            return json.load(file)

    def assert_ends(self, run):
        self.assertEqual((run.returncode, run.stderr), (0, ""), run.stdout)

    def refused(self, command, config, *words):
        """The line that says why."""
        run = self.tool(command, config, *words)
        self.assertEqual((run.returncode, run.stderr.count("\n")), (2, 1), run.stderr)
        return run.stderr


class Tradeoff(StudyTest):
    def test_runs_start_from_each_other(self):
        self.assert_ends(self.tool("tradeoff", hook(), "--points", "3", "--ranks", "2"))
        record = self.json("tradeoff_thickness.json")
        rows = record["rows"]
        self.assertEqual([row["value"] for row in rows], [[0.88, 1.125], [0.697, 1.394], [0.36, 2.56]])
        for number, row in enumerate(rows):
            run = Run(self.path(row["folder"]))
            self.assertEqual(run.config["tool"]["thickness"], row["value"])
            self.assertEqual([c["type"] for c in run.config["constraints"]], ["layer_thickness", "local_thickness"])
            self.assertEqual(len(run.history), 2 if number else 4)
            self.assertEqual(run.config["optimizer"]["earlier_iterations"], 2 if number else 0)
            self.assertEqual(row["objective"], run.length("binary"))
            self.assertAlmostEqual(row["skin"] / row["objective"], 1, delta=1e-6)  # the same measure of the same nodes
            self.assertEqual(row["outside"], run.summary["binary"]["checks"]["local_thickness"]["share_outside"])
            self.assertEqual(row["class"], run.summary["binary"]["verdict"].get("class"))
            self.assertEqual(row["violated"], [reason["words"] for reason in run.summary["binary"]["verdict"]["reasons"]])
        before, after = (Run(self.path(row["folder"])) for row in rows[:2])
        words = after.config["run"]["command_line"]
        self.assertIn(f"-design out/{rows[0]['folder']}/result.h5", words)
        self.assertLess(abs(after.history[0]["objective"][0] / before.history[-1]["objective"][0] - 1), 0.2)
        self.assertEqual(record["planar"], before.length("baseline"))
        with open(self.path("tradeoff_thickness.csv"), encoding="utf-8", newline="") as file:
            self.assertEqual([row["limit"] for row in csv.DictReader(file)], [row["limit"] for row in rows])
        with open(self.path("tradeoff_thickness.svg"), encoding="utf-8") as file:
            text = file.read()
        for words in ("0.88 to 1.125", "as built", "after the release", "planar layers"):
            self.assertIn(words, text)
        self.check_page(rows)

    def check_page(self, rows):
        page = report_page.page_of([report_page.ReportRun(self.path(rows[1]["folder"]))])
        self.assertIn("Trade-off, binary layers", page)
        self.assertIn('id="tradeoff_thickness"', page)
        self.assertIn("Deviation of the skin over local thickness", page)

    def test_goes_on_after_a_kill(self):
        """What is done is not run again, what was stopped goes on, what has other settings is new."""
        words = "--over", "tilt", "--values", "90", "45", "--ranks", "1"
        self.assert_ends(self.tool("tradeoff", hook(), *words))
        expected = self.json("tradeoff_tilt.json")
        self.assertEqual([row["place"] for row in expected["rows"]], [45.0, 90.0])
        first, second = (self.path(row["folder"], "summary.json") for row in expected["rows"])
        os.remove(second)
        times = os.stat(first).st_mtime_ns
        self.assert_ends(self.tool("tradeoff", hook(), *words))
        self.assertEqual(os.stat(first).st_mtime_ns, times)
        found = self.json("tradeoff_tilt.json")
        for row, old in zip(found["rows"], expected["rows"], strict=True):
            self.assertEqual(row | {"seconds": 0}, old | {"seconds": 0})
        self.assert_ends(self.tool("tradeoff", hook(), *words, "--", "-max_iterations", "3"))
        self.assertGreater(os.stat(first).st_mtime_ns, times)

    def test_a_limit_that_the_program_refuses(self):
        """The others are there, with the reason."""
        terms = [{"type": "layer_thickness", "target": 0.55}, {"type": "tilt", "width": 91}]
        run = self.tool("tradeoff", hook(constraints=terms), "--points", "2")
        self.assertEqual(run.returncode, 2)
        self.assertIn("/constraints/1/width", run.stderr)

    def test_mistakes(self):
        for words, reason in ((["--points", "1"], "--points: found 1"), (["--values", "0.5,1.2", "0.8,2"], "each holds"),
                              (["--values", "1.2,1.5"], "allowed: two numbers with 1 between them"),
                              (["--ranks", "0"], "--ranks: found 0")):
            self.assertIn(reason, self.refused("tradeoff", hook(), *words))
        self.assertIn("found no layer_thickness", self.refused("tradeoff", hook(constraints=[])))
        self.assertIn("sequence.type: found planar", self.refused("tradeoff", hook(sequence={"type": "planar"})))

    def test_values_and_schedules(self):
        class Words:
            values, points = None, 6

        tilts = values_of(Words, LIMITS["tilt"], {})
        self.assertEqual(tilts, [15.0, 30.0, 45.0, 60.0, 75.0, 90.0])
        ranges = values_of(Words, LIMITS["thickness"], {})
        self.assertEqual(ranges[-1], [0.25, 2.25])
        for narrow, wide in zip(ranges, ranges[1:]):
            self.assertTrue(LIMITS["thickness"].holds(wide, narrow))
        self.assertEqual(later_schedule({"max_iterations": 5, "starts": ["planar"], "start_iterations": 3}, 2),
                         {"optimizer.max_iterations": 2, "optimizer.coarse_iterations": 0, "optimizer.starts": [],
                          "optimizer.earlier_iterations": 6})
        self.assertEqual(later_schedule({"max_iterations": 20, "coarse_iterations": 100}, None),
                         {"optimizer.max_iterations": 60, "optimizer.coarse_iterations": 0, "optimizer.earlier_iterations": 60})


class CompareFamilies(StudyTest):
    words = "--ranks", "2", "--step", "60", "--azimuths", "2", "--subparts", "2"

    def test_families_within_the_same_limits(self):
        self.assert_ends(self.tool("compare-families", hook(), *self.words))
        record = self.json("families.json")
        names = [row["layers"] for row in record["rows"]]
        self.assertEqual(names, [*FAMILIES[:2], "multi-planar, 2 sub-parts", *FAMILIES[2:]])
        self.assertEqual(len(record["scan"]), 2)
        for row in record["rows"]:
            run = Run(self.path(row["folder"]), simulations=True)
            self.assertEqual(run.config["tool"]["max_tilt"], 60)
            types = {constraint["type"] for constraint in run.config["constraints"]}
            self.assertLessEqual({"tilt", "supported"}, types)
            self.assertEqual("local_thickness" in types, not row["layers"].startswith("multi"))
            self.check_row(row, run)
        moves = [Run(self.path(name)).config["optimizer"]["final_move_limit"] for name in ("heat", "guided")]
        self.assertEqual(moves, [0.004, "auto"])
        planar = record["rows"][0]
        self.assertRegex(planar["violated"][0], r"^6\.8 % of the part begins in the air \(first near \[")
        self.assertTrue(os.path.getsize(self.path("families.png")) > 1000)
        times = os.stat(self.path("heat", "summary.json")).st_mtime_ns
        self.assert_ends(self.tool("compare-families", hook(), *self.words))
        self.assertEqual(os.stat(self.path("heat", "summary.json")).st_mtime_ns, times)

    def check_row(self, row, run):
        """Of the simulation of binary layers, which is of the optimized design, and has the scenarios."""
        optimized = "optimized" in run.summary
        judged = Run(self.path(f"{row['folder']}_judged"), simulations=True) if optimized else run
        summary = judged.summary
        self.assertEqual(row["class"], summary["verdict"].get("class"))
        self.assertEqual(row["violated"], [reason["words"] for reason in summary["verdict"]["reasons"]])
        self.assertEqual(row["skin_released"], summary["finished"]["released"]["skin"]["rms"])
        self.assertEqual(row["seconds"], run.summary["seconds"]["total"])
        # The mean strain is the given one, so that the mean of J is J of that strain and the spread.
        term = summary["scenarios"][0]
        self.assertEqual(len(term["values"]), 2 * 3)
        self.assertAlmostEqual((term["mean"] - row["objective"]**2) / row["spread"]**2, 1, places=6)
        self.assertLess(row["spread"], row["objective"])
        if optimized:
            self.assertLess(abs(row["objective"] / run.length("binary") - 1), 1e-4)
            self.assertEqual(row["violated"], [reason["words"] for reason in run.summary["binary"]["verdict"]["reasons"]])

    def test_two_dimensions(self):
        config = plate_2d() | {"optimizer": {"max_iterations": 2}}
        self.assert_ends(self.tool("compare-families", config, "--ranks", "1", "--step", "45", "--subparts", "3"))
        self.assertEqual([row["layers"] for row in self.json("families.json")["rows"]][2], "multi-planar, 3 sub-parts")

    def test_directions(self):
        """Within the limit, from every face of the box; the angles of sub-parts lie within their bounds."""
        for plate in ("x-", "x+", "y-", "y+", "z-", "z+"):
            families = Families(hook(build_plate=plate), 0.55)
            axis, sign = "xyz".index(plate[0]), 1.0 if plate[1] == "-" else -1.0
            found = list(families.directions(30.0, 4))
            self.assertEqual(len(found), 8)
            for tilt, direction in found:
                self.assertAlmostEqual(np.degrees(np.arccos(sign * direction[axis])), tilt)
                self.assertAlmostEqual(np.linalg.norm(direction), 1.0)
                layers = families.multi_planar(3, direction).settings["layers"]
                for angles in layers["angles"]:
                    for angle, (low, high) in zip(angles, layers["angle_bounds"], strict=True):
                        self.assertTrue(low <= angle <= high, (plate, angle, low, high))

    def test_layers_of_several_beads(self):
        """All families have them, as thick as the layers that they are compared with."""
        families = Families(hook(layers={"count": 4, "passes": 3}, constraints=[{"type": "layer_thickness", "target": 0.2}]), 0.6)
        self.assertEqual(target_thickness(families.config), 0.2 * 3)
        self.assertEqual(families.planar("", "", families.up, 1.8).settings["layers"], {"count": 3, "passes": 3})
        slabs = families.multi_planar(2, families.up).settings["layers"]
        self.assertEqual((slabs["passes"], slabs["passes"] * slabs["thickness"]), (3, 0.6))

    def test_mistakes(self):
        self.assertIn("--step: found 0", self.refused("compare-families", hook(), "--step", "0"))
        self.assertIn("--subparts: found 0", self.refused("compare-families", hook(), "--subparts", "0"))

    def test_scenarios(self):
        self.assertEqual(strains(2), [[1.15, 1.0], [0.85, 1.0], [1.0, 1.15], [1.0, 0.85]])

    def test_settings_by_path(self):
        config = {"objective": [{"type": "distortion"}, {"type": "layer_uniformity"}]}
        for path, value in (("objective.layer_uniformity.weight", 0.5), ("objective.0.nodes", "all"), ("tool.max_tilt", 60),
                            ("layers", {"count": 3})):
            put(config, path, value, "part.json")
        objective = [{"type": "distortion", "nodes": "all"}, {"type": "layer_uniformity", "weight": 0.5}]
        self.assertEqual(config, {"objective": objective, "tool": {"max_tilt": 60}, "layers": {"count": 3}})
        for path, found in (("objective.tilt.weight", "found no entry tilt"), ("layers.count.more", "found 3 for count")):
            self.assertRaisesRegex(RunError, f"part.json: {path}: {found}", put, config, path, 1, "part.json")

    def test_a_damaged_config(self):
        path = self.write_config("{}", "empty.json")
        run = subprocess.run([sys.executable, TOOLS, "compare-families", path], capture_output=True, text=True, check=False,
                             cwd=self.directory)
        self.assertEqual(run.returncode, 2)
        self.assertIn("domain is missing", run.stderr)
        self.assertRaises(RunError, values_of, type("Words", (), {"values": ["x"]}), LIMITS["tilt"], {})


class SensitivityTest(FabseqTest):
    def test_a_table_is_as_new_as_its_design(self):
        """With a program that only writes a table, and counts its runs."""
        program, design = os.path.join(self.directory, "program"), os.path.join(self.directory, "result.h5")
        with open(program, "w", encoding="utf-8") as file:
            file.write('#!/bin/bash\nmkdir -p "${@: -1}"; echo {} > "${@: -1}/sensitivity.json"; echo >> "$0.runs"\n')
        os.chmod(program, 0o755)
        words = {"config": self.write_config(hook()), "output": os.path.join(self.directory, "out"), "ranks": 1,
                 "program": program, "rest": []}
        rounds = Rounds(argparse.Namespace(**words))

        def runs_after(settings, age):
            """Runs of the program once the table of a design of that age, in seconds, was asked for."""
            with open(design, "w", encoding="utf-8"):
                os.utime(design, (time.time() - age,) * 2)
            directory = rounds.sensitivity("thinner", settings, design)
            self.assertTrue(os.path.exists(os.path.join(directory, "sensitivity.json")))
            with open(program + ".runs", encoding="utf-8") as file:
                return len(file.readlines())

        self.assertEqual(runs_after({}, 100), 1)
        self.assertEqual(runs_after({}, 100), 1)
        self.assertEqual(runs_after({"layers.count": 3}, 100), 2)
        self.assertEqual(runs_after({"layers.count": 3}, -100), 3)
        looking = Rounds(argparse.Namespace(**words), may_run=False)
        self.assertRaisesRegex(RunError, "thinner: holds no table", looking.sensitivity, "thinner", {}, design)


class Machine(StudyTest):
    def machine(self, *words):
        """The rows of the table, without its head."""
        script = os.path.join(ROOT, "benchmarks", "evidence", "figures", "machine.py")
        command = [sys.executable, script, "--cases", "cases.json", "--output", "out", "--ranks", "1", "--step", "60",
                   "--azimuths", "2", "--program", PROGRAM, *words]
        run = subprocess.run(command, capture_output=True, text=True, cwd=self.directory, check=False,
                             env={**ENVIRONMENT, **os.environ})
        self.assertEqual(run.returncode, 0, run.stderr)
        lines = [line.strip("| ").split(" | ") for line in run.stdout.splitlines()]
        self.assertEqual(len({len(line) for line in lines}), 1, run.stdout)
        return lines[2:]

    def test_rows(self):
        """With a case's settings, those of its kind of layers, and the torch that is judged."""
        self.write_config(hook(), "hook.json")
        case = {"config": "hook.json", "what": "hook", "set": {"tool.clearance": 0.3, "tool.profile": [[0, 0.1], [4, 0.1]]},
                "judging": {"tool.clearance": 0}, "guided": {"optimizer": {"max_iterations": 2}}}
        self.write_config({"hook": case}, "cases.json")
        rows = self.machine()
        self.assertEqual([row[:2] for row in rows], [["hook", name] for name in FAMILIES])
        self.assertEqual([len(Run(self.path("hook", name)).history) for name in ("heat", "guided")], [4, 2])
        for name, clearance in (("planar", 0.0), ("heat", 0.3), ("heat_judged", 0.0)):
            config = Run(self.path("hook", name), simulations=True).config
            self.assertEqual(config["tool"]["clearance"], clearance)
            self.assertEqual("tool_clearance" in [constraint["type"] for constraint in config["constraints"]], True)
        self.assertEqual(self.machine("--table"), rows)
        self.assertEqual(self.machine("--table", "--output", "elsewhere"), [])


if __name__ == "__main__":
    run_fabseq.main()
