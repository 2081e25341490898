# SPDX-License-Identifier: MIT
"""What is said of a sequence beside its distortion: hanging elements, local thickness, build time, wire,
yield stress, and what the tools make of it; and materials from a file."""

import json
import os
import subprocess

import numpy as np

import run_fabseq
from read_outputs import read_result
from run_fabseq import BAD_INPUT, ROOT, FabseqTest, distinct

# A column with an arm that planar layers begin in the air; unit cubes.
CRANE = {"name": "crane", "domain": {"size": [8, 2, 6], "elements": [8, 2, 6], "unit": "mm"},
         "part": {"union": [{"box": {"min": [0, 0, 0], "max": [2, 2, 4]}}, {"box": {"min": [0, 0, 4], "max": [8, 2, 6]}}]},
         "node_sets": {"tip": {"box": {"min": [8, 0, 4], "max": [8, 2, 6]}}},
         "sequence": {"type": "heat", "characteristic_length": 8}, "layers": {"count": 4},
         "objective": [{"type": "distortion", "nodes": "tip"}],
         "constraints": [{"type": "layer_thickness", "target": 3.0}], "baseline": {"layers": 6}}
STEEL = {"name": "steel", "young": 200e3, "yield_stress": 1.0, "mass_density": 0.5, "inherent_strain": [-0.01] * 3 + [0] * 3,
         "source": "a book", "comment": "at room temperature"}


class BuildReportTest(FabseqTest):
    def write_material(self, content):
        with open(os.path.join(self.directory, "steel.json"), "w", encoding="utf-8") as file:
            file.write(content if isinstance(content, str) else json.dumps(content))

    def test_end_of_an_optimization(self):
        self.write_material(STEEL)
        config = {**CRANE, "material": {"file": "steel.json", "poisson": 0.25},
                  "process": {"deposition_rate": 2.0, "dwell": 90}, "tool": {"thickness": [0.9, 1.1]}}
        for ranks in distinct(2, 1):
            run = self.run_config(ranks, config, "-max_iterations", 2)
            self.assert_done(run)
            summary, data = run.json("summary.json"), read_result(run)
            for block, prefix in (("optimized", ""), ("baseline", "planar/"), ("start", "start/")):
                self.check_block(summary[block], {name: data[prefix + name] for name in
                                                  ("layer", "time", "hanging", "local_thickness", "build_direction")}, data)
            for block, prefix in (("optimized", ""), ("binary", "binary/"), ("baseline", "planar/"), ("start", "start/")):
                stress, part = data[prefix + "von_mises"], data["density"] > 0
                self.assertAlmostEqual(summary[block]["stress"]["von_mises"] / stress.max(), 1)
                self.assertAlmostEqual(summary[block]["stress"]["share_beyond_yield"], np.mean(stress[part] > 1))
                self.assertFalse(stress[~part].any())
                share = 100 * summary[block]["stress"]["share_beyond_yield"]
                self.assertEqual(summary[block]["words"]["stress"],
                                 ["residual stress, without plastic flow: up to "
                                  f"{stress.max():.4g}, above the yield stress 1 in {share:.3g} % of the part"])
                self.check_words(summary[block])
            planar, binary = summary["baseline"], summary["binary"]
            self.assertEqual(planar["checks"]["hanging"]["elements"], 10)
            self.assertEqual(planar["checks"]["hanging"]["per_layer"], [0, 0, 0, 0, 10, 0])
            self.assertEqual(planar["checks"]["hanging"]["at"], [3.5, 0.5, 4.5])
            self.assertAlmostEqual(planar["checks"]["local_thickness"]["least"], 1.0)
            self.assertAlmostEqual(planar["checks"]["local_thickness"]["share_outside"], 1.0)
            used = sum(layer["volume"] > 1e-6 * 48 / 4 for layer in binary["layers"])
            thickness = np.average([layer["thickness"] for layer in binary["layers"] if layer["volume"] > 0],
                                   weights=[layer["volume"] for layer in binary["layers"] if layer["volume"] > 0])
            self.assertEqual(len(summary["baseline_matched"]["layers"]), round(6 / thickness))
            self.assertAlmostEqual(binary["wire_mass"], 24.0)
            self.assertAlmostEqual(binary["build_hours"], 12.0 + used * 90 / 3600)
            reasons = [reason["words"] for reason in planar["verdict"]["reasons"]]
            self.assertIn("21 % of the part begins in the air (first near [3.5,0.5,4.5])", reasons)
            self.assertNotIn("yield stress", run.stdout + run.stderr)
            self.assertIn("  hours  ", run.stdout)
            material = run.json("config.json")["material"]
            self.assertEqual((material["name"], material["young"], material["poisson"]), ("steel", 200e3, 0.25))
            self.assertNotIn("source", material)

    def check_words(self, block):
        """What findings say is what the verdict and the figures say."""
        words, thickness = block["words"], block["checks"]["local_thickness"]
        for reason in block["verdict"]["reasons"]:
            self.assertEqual(words[reason["name"]][0], reason["words"])
        end = "fronts meet there" if thickness["largest_is_meeting"] else "a thick layer$"
        self.assertRegex(words["local_thickness"][1], rf"^the largest local thickness is \S+ mm near \[[^\]]*\]: {end}")
        self.assertTrue(set(words) <= {"hanging", "local_thickness", "stress", "late_sets"}, words)

    def check_block(self, block, fields, data):
        """The block's figures are those of the fields, and these are what they are called."""
        part = data["density"] > 0
        hanging, layer = fields["hanging"][part], fields["layer"][part]
        self.assertEqual(block["checks"]["hanging"]["elements"], hanging.sum())
        self.assertEqual(block["checks"]["hanging"]["per_layer"],
                         [int(hanging[layer == j + 1].sum()) for j in range(len(block["layers"]))])
        thickness = fields["local_thickness"][part]
        self.assertAlmostEqual(block["checks"]["local_thickness"]["least"] / thickness.min(), 1)
        self.assertAlmostEqual(block["checks"]["local_thickness"]["largest"] / thickness.max(), 1)
        outside = np.mean((thickness < 2.7) | (thickness > 3.3))
        self.assertAlmostEqual(block["checks"]["local_thickness"]["share_outside"], outside)
        np.testing.assert_allclose(np.linalg.norm(fields["build_direction"][part], axis=1), 1)
        self.assertFalse(fields["hanging"][~part].any() or fields["build_direction"][~part].any())

    def tool(self, *words):
        command = [os.path.join(ROOT, "scripts", "fabseq-tools"), *words]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    @run_fabseq.only_release
    def test_tools_begin_with_the_verdict(self):
        run = self.run_config(2, {**CRANE, "tool": {"bead_width": 1.0}}, "-max_iterations", 2)
        self.assert_done(run)
        summary = run.json("summary.json")
        (place,) = (place for place in summary["baseline"]["places"] if place["kind"] == "hanging")
        self.assertEqual((place["kind"], place["elements"], place["layer"]), ("hanging", 12, 5))
        self.assertEqual((place["lower"], place["upper"]), ([2.0, 0.0, 4.0], [8.0, 2.0, 5.0]))
        printed = self.tool("layers", run.output, "--of", "planar", "--format", "stl").splitlines()
        self.assertEqual(printed[0], summary["baseline"]["verdict"]["words"])
        self.assertIn(f"  {place['words']}", printed)
        self.assertTrue(self.tool("paths", run.output, "--no-picture").startswith(summary["binary"]["verdict"]["words"] + "\n"))
        self.tool("report", run.output)
        with open(run.path("report.html"), encoding="utf-8") as file:
            page = file.read()
        short = summary["binary"]["verdict"]["words"].partition(":")[0]
        self.assertIn(f'<p class="verdict">{short.capitalize()}</p>', page)
        for state, figure in (("baseline", "not buildable"), ("binary", short)):
            self.assertIn(f'<b title="{summary[state]["finished"]["as_built"]["skin"]["rms"]!r}">', page)
            self.assertIn(f">{figure}</p>", page)
        self.assertIn('<section id="pair">', page)

    def test_simulation_prints_a_table(self):
        run = self.run_config(1, CRANE, "-task", "simulate")
        self.assert_done(run)
        for words in ("not buildable: ", "skin after the release, mm", "  simulated ", " times as thick as the target in layer ",
                      "constraint_0 (layer_thickness): "):
            self.assertIn(words, run.stdout)
        self.assertLess(len(run.stdout.splitlines()), 20)
        self.assertNotIn("stress", run.stdout)
        asked = self.run_config(1, CRANE, "-task", "simulate", "-set", "output.stress=true")
        self.assertIn("largest equivalent stress ", asked.stdout)
        self.assertEqual(run.json("summary.json")["checks"]["hanging"]["elements"], read_result(run)["hanging"].sum())

    def test_the_shelf(self):
        """Every material of configs/materials can be taken."""
        shelf = os.path.join(ROOT, "configs", "materials")
        for name in distinct(*sorted(os.listdir(shelf))):
            self.assert_done(self.run_config(1, CRANE, "-task", "check", "-material", os.path.join(shelf, name)))

    def test_material_files_that_cannot_be_used(self):
        cases = {"": "cannot be read", "{": "steel.json", "[1]": "holds no object", '{"file": "other.json"}': "another file",
                 '{"yung": 1}': "/material/yung"}
        for content, words in cases.items():
            if content:
                self.write_material(content)
            run = self.run_config(1, {**CRANE, "material": {"file": "steel.json"}})
            self.assertEqual(run.status, BAD_INPUT, str(run))
            self.assertEqual(len(run.messages()), 1, str(run))
            self.assertIn(words, run.stderr)
            self.assertFalse(os.path.exists(run.output))


if __name__ == "__main__":
    run_fabseq.main()
