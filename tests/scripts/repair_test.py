#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""fabseq-tools repair on small parts: what it says is what the program has found, and what it cannot mend."""

import os

import numpy as np

import run_fabseq
from run_fabseq import FabseqTest
from small_parts import direct_2d, plate_2d, v_2d

from fabseq_tools.run.command_line import write_json
from fabseq_tools.run.read_run import read_fields, read_json

COMMAND = "repair"
RIGHT = "buildable, not repaired: no element fails a check\n"


def leaning():
    """Guided layers, a few elements of which are too thick."""
    config = v_2d()
    del config["objective"][1], config["constraints"][0]["tolerance"]
    return config | {"sequence": {"type": "guided", "max_tilt": 50}, "tool": {"thickness": [0.2, 1.2]}}


def notched():
    """Planar layers that begin in the air at a place which no other layers reach."""
    return plate_2d() | {"sequence": {"type": "planar"}}


class RepairTest(FabseqTest):
    iterations = 10

    def said(self, *words):
        done = self.run_tool(COMMAND, *words)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        return done.stdout

    def refused(self, *words):
        done = self.run_tool(COMMAND, *words)
        self.assertEqual((done.returncode, done.stdout, done.stderr.count("\n")), (2, "", 1), done.stderr)
        return done.stderr

    def check_repair(self, run, block, said, output):
        """Words and files of a repair of a run, whose layers have that block of its summary."""
        summary = read_json(output, "summary.json")
        repair, skin = summary["repair"], summary["finished"]["as_built"]["skin"]
        before, rms = repair["before"], block["finished"]["as_built"]["skin"]["rms"]
        self.assertEqual((before["class"], before["places_in_all"]), (block["verdict"]["class"], block["places_in_all"]))
        self.assertAlmostEqual(before["rms"] / rms, 1, delta=1e-4)
        count, moved = repair["repaired"], repair["moved"]
        self.assertEqual(said.splitlines(),
                         ["buildable; before the repair: not buildable",
                          f"{count} element{'s' * (count > 1)} repaired, {len(moved)} of them moved to another layer",
                          f"skin as built: rms {milli(skin['rms'])}, before {milli(before['rms'])}; "
                          f"largest {milli(skin['max'])}, before {milli(before['largest'])}",
                          "no place left", f"results in {output}; go on with fabseq-tools report, paths"])
        fields = [read_fields(os.path.join(folder, "result.h5"))["layer"] for folder in (run.output, output)]
        changed = np.argwhere(fields[0] != fields[1])[:, ::-1].tolist()
        self.assertEqual(sorted(one["element"] for one in moved), sorted(changed))
        for one in moved:
            self.assertEqual([field[tuple(one["element"][::-1])] for field in fields], [one["from"], one["to"]])
        return repair

    def test_optimization(self):
        run = self.optimize(leaning(), 1)
        block = run.json("summary.json")["binary"]
        said = self.said(run.output, "--share", "0.05")
        repair = self.check_repair(run, block, said, run.path("repaired"))
        self.assertGreater(repair["repaired"], len(repair["moved"]))
        self.assertEqual(self.said(run.path("repaired")), RIGHT)
        self.assertFalse(os.path.exists(run.path("repaired/repaired")))
        self.assertEqual(self.said(run.output, "--", "-set", "tool.thickness=[0.1, 9]"), RIGHT)
        self.assertNotIn("repair", read_json(run.path("repaired"), "summary.json"))
        self.assertRegex(self.said(run.output, "--share", "0.005"), r"^not buildable, not repaired: found \d+ failed checks in "
                         r"260 elements; allowed: 0.5 % of the elements \(--share\)\n$")
        self.assertIn("holds a run already", self.refused(run.output, "--output", run.output))

    def test_optimization_that_was_repaired(self):
        """A repaired run is repaired again from its times, which its design no longer gives."""
        config = leaning()
        config["optimizer"] = {"binary_iterations": 1, "repair_iterations": 1, "repair_share": 0.05}
        run = self.run_config(1, config, "-max_iterations", 10)
        self.assert_done(run)
        self.assertTrue(run.json("summary.json")["repair"]["moved"])
        self.assertEqual(self.said(run.output, "--", "-set", "tool.thickness=[0.1, 9]"), RIGHT)
        np.testing.assert_array_equal(*(read_fields(run.path(name))["layer"] for name in ("result.h5", "repaired/result.h5")))

    def test_simulation_of_a_file(self):
        """The layers of an optimization, whose design a simulation of its times does not have."""
        first = self.optimize(direct_2d("elements"), 1)
        run = self.simulate(first.path("config.json"), "-sequence", first.path("result.h5"))
        output = os.path.join(self.directory, "mended")
        said = self.said(run.output, "--share", "0.02", "--output", output, "--ranks", "2")
        repair = self.check_repair(run, run.json("summary.json"), said, output)
        self.assertEqual(repair["repaired"], len(repair["moved"]))
        self.assertIn("holds a run already", self.refused(run.output, "--share", "0.02", "--output", output))

    def test_what_is_right_or_cannot_be_mended(self):
        run = self.simulate(notched())
        self.assertEqual(self.said(run.output), "buildable but for 1 place, not repaired: found 1 failed check in 224 elements, "
                         "and no better layers within 0.5 % of the elements (--share)\n")
        right = notched()
        right["part"] = right["part"]["difference"][0]
        run = self.simulate(right)
        self.assertEqual(self.said(run.output), RIGHT)
        self.assertFalse(os.path.exists(run.path("repaired")))
        self.assertIn("found 240 failed checks in 240 elements", self.said(run.output, "--", "-set", "tool.thickness=[0.1, 0.9]"))

    def test_refusals(self):
        run = self.simulate(notched())
        self.assertIn("--share: found 0.2; allowed: a number from 0 to 0.1", self.refused(run.output, "--share", "0.2"))
        self.assertIn("no such program", self.refused(run.output, "--program", "/nowhere"))
        self.assertIn("not the output directory of a finished run", self.refused(self.directory))
        self.assertIn("/tool/max_tilt", self.refused(run.output, "--", "-set", "tool.max_tilt=-1"))
        self.edit(run, "config.json", lambda config: config["layers"].update(type="multi_planar"))
        self.assertIn("/layers/type is multi_planar", self.refused(run.output))
        self.edit(run, "summary.json", lambda summary: summary["verdict"].pop("class"))
        self.assertIn("found no class of the verdict", self.refused(run.output))

    @staticmethod
    def edit(run, name, change):
        content = run.json(name)
        change(content)
        write_json(run.path(name), content)


def milli(length):
    """As the tools write lengths from 0.001 to 1."""
    return f"{length:.3g}" if length >= 0.01 else f"{1e3 * length:.2f}·10⁻³"


if __name__ == "__main__":
    run_fabseq.main()
