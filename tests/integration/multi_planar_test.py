# SPDX-License-Identifier: MIT
"""Multi-planar layers: files, restarts, ranks and groups, fixed variables, derivatives, and that nothing
jumps where slabs come and go."""

import os

import h5py
import numpy as np

import run_fabseq
from read_outputs import assert_close, read_dump, read_result
from run_fabseq import BAD_INPUT, DONE, FabseqTest, SANITIZED, largest_relative_difference
from small_parts import write_voxels

COMPARED = ("objective", "objective_scaled", "constraints", "change", "angles")


def tee_2d():
    """A column with an arm, in three sub-parts."""
    return {
        "name": "tee",
        "domain": {"size": [22, 15], "elements": [22, 15]},
        "part": {"union": [{"box": {"min": [0, 0], "max": [8.2, 15]}}, {"box": {"min": [0, 7.6], "max": [22, 15]}}]},
        "node_sets": {"tip": {"box": {"min": [22, 7], "max": [22, 15]}}},
        "material": {"inherent_strain": {"tangential": -0.01332, "normal": -0.002}},
        "sequence": {"type": "heat"},
        "layers": {"type": "multi_planar", "subparts": 3, "thickness": 3.0, "angles": [[1.3], [0.9], [0.3]],
                   "sharpness": {"time": 40, "slab": 10}},
        "objective": [{"type": "distortion", "measure": "layerwise"},
                      {"type": "segmentation_alignment", "weight": 0.5},
                      {"type": "distortion", "nodes": "tip", "after_release": True, "least_squares": False}],
        "constraints": [{"type": "subpart_volume"}],
    }


def tee_3d():
    config = tee_2d()
    config.update({
        "name": "tee_3d",
        "domain": {"size": [16, 8, 16], "elements": [10, 4, 10]},
        "part": {"union": [{"box": {"min": [0, 0, 0], "max": [7, 8, 16]}},
                           {"box": {"min": [0, 0, 9.5], "max": [16, 8, 16]}}]},
        "node_sets": {"tip": {"box": {"min": [16, 0, 9], "max": [16, 8, 16]}}}})
    config["layers"].update({"subparts": 2, "thickness": 4.0, "angles": [[1.3, 0.4], [0.6, 0.2]]})
    return config


class OutputsTest(FabseqTest):
    iterations = 6

    def test_files(self):
        self.resumes = True
        run = self.optimize(tee_2d(), 2)
        counts = set()
        for line in run.history():
            self.assertEqual(np.shape(line["angles"]), (3, 1))
            self.assertEqual(len(line["constraints"][0]), 3)
            self.assertAlmostEqual(sum(line["constraints"][0]), 0.0, places=10)  # the sub-parts make up the part
            counts.add(len(line["solver_iterations"]["primal"]))
            self.assertEqual(len(line["solver_iterations"]["adjoint"]), len(line["solver_iterations"]["primal"]))
        self.assertGreater(len(counts), 1, "as the angles turn, slabs come and go")
        self.assertEqual(run.history()[0]["angles"], [[1.3], [0.9], [0.3]])
        summary, data = run.json("summary.json"), read_result(run)
        self.assertEqual(data["angles"].tolist(), summary["angles"])
        for name in ("optimized", "binary"):
            layers = summary[name]["layers"]
            places = [(layer["subpart"], layer["slab"]) for layer in layers]
            self.assertEqual(places, sorted(set(places)))
            self.assertTrue(all(layer["thickness"] is None and layer["cv"] is None for layer in layers))
            volume = sum(layer["volume"] for layer in layers)
            self.assertAlmostEqual(volume / (data["density"].sum()), 1.0, places=12 if name == "binary" else 2)
        self.assertEqual([entry["value"] is None for entry in summary["baseline"]["responses"]],
                         [False, True, False, True, True, True])
        self.check_layers(data, summary)
        self.assertEqual(read_dump(run, 4)["layer"].max(), data["layer"].max())
        with h5py.File(run.path("checkpoint/slot_1.h5"), "r") as file:
            for name in ("angles", "best/angles", "optimizer/angles_low"):
                self.assertEqual(file[name].shape, (3,))

    def check_layers(self, data, summary):
        """The layer of each element, by its pseudo-time and its place."""
        there = data["density"] > 0
        center = np.meshgrid(np.arange(22) + 0.5, np.arange(15) + 0.5)
        subpart = 1 + (data["time"][..., None] > np.array([1 / 3, 2 / 3]) + 1e-12).sum(-1)
        angle = data["angles"][subpart - 1, 0]
        slab = np.ceil((center[0] * np.cos(angle) + center[1] * np.sin(angle)) / 3.0 - 1e-12)
        layers = summary["optimized"]["layers"]
        found = data["layer"][there].astype(int) - 1
        np.testing.assert_array_equal([layers[j]["subpart"] for j in found], subpart[there])
        np.testing.assert_array_equal([layers[j]["slab"] for j in found], slab[there])

    def test_a_design_is_read_again(self):
        for config in (tee_2d(), tee_3d()):
            with self.subTest(config=config["name"]):
                run = self.optimize(config, 2)
                summary = run.json("summary.json")
                for file in ("result.h5",):
                    again = self.run_config(3, config, "-task", "evaluate", "-design", run.path(file), "-tolerance", "1e-11")
                    self.assert_done(again)
                    found = again.json("evaluation.json")
                    self.assertEqual(found["angles"], summary["angles"])
                    values = [entry["value"] for entry in found["responses"]]
                    correct = [entry["value"] for entry in summary["optimized"]["responses"]]
                    self.assertLess(largest_relative_difference(values, correct), 1e-6)
                    angles = config["domain"]["elements"]
                    gradients = read_result(again, "gradients.h5")
                    self.assertEqual(gradients["objective_0/angles"].shape,
                                     (config["layers"]["subparts"], len(angles) - 1))
                simulated = self.run_config(1, config, "-task", "simulate", "-design", run.path("result.h5"))
                self.assert_done(simulated)
                self.assertEqual(len(simulated.json("summary.json")["layer_displacement_norms"]),
                                 len(simulated.json("summary.json")["layers"]))

    def test_fixed(self):
        for word, still in (("angles", "angles"), ("time", "design")):
            with self.subTest(fixed=word):
                config = tee_2d()
                self.resumes = False
                start = self.optimize(config, 1, 2)
                config["layers"]["fixed"] = [word]
                # From a design: what is fixed stays as it is there.
                self.resumes = True
                run = self.optimize(config, 2, 4, "-design", start.path("result.h5"))
                with h5py.File(start.path("result.h5"), "r") as before, h5py.File(run.path("result.h5"), "r") as after:
                    np.testing.assert_array_equal(before[still][()], after[still][()])
                angles = [line["angles"] for line in run.history()]
                self.assertEqual(all(later == angles[0] for later in angles), word == "angles")
                volumes = [line["constraints"] for line in run.history()]
                self.assertEqual(all(later == volumes[0] for later in volumes), word == "time")
                with h5py.File(run.path("checkpoint/slot_0.h5"), "r") as file:
                    self.assertEqual("optimizer/low" in file, word == "angles")
                    self.assertEqual("optimizer/angles_low" in file, word == "time")

    def test_other_sequences(self):
        """Times of nodes and of elements as variables; the strain needs no gradient."""
        self.resumes = True
        for location in ("nodes", "elements"):
            config = tee_2d()
            config["sequence"] = {"type": "direct", "location": location}
            config["constraints"].append({"type": "continuity"})
            if location == "elements":
                del config["objective"][1]
            self.optimize(config, 2, 2)

    def test_check(self):
        run = self.run_config(2, tee_3d(), "-task", "check", output="")
        self.assert_done(run)
        self.assertIn("4 angles", run.stdout)
        self.assertRegex(run.stdout, r"layers: about \d+ multi-planar, 4 planar in the baseline")

    def test_what_a_run_leaves_is_taken_by_others(self):
        config = tee_2d()
        config["objective"].insert(0, config["objective"].pop(1))  # alignment, which planar layers do not have
        run = self.run_config(1, config, "-max_iterations", 1)
        self.assert_done(run)
        self.assertNotIn("nan", run.stdout)
        with open(run.path("checkpoint/newest"), encoding="utf-8") as file:
            checkpoint = run.path("checkpoint/" + file.read().strip())
        evaluated = self.run_config(1, config, "-task", "evaluate", "-design", checkpoint)
        self.assert_done(evaluated)
        with h5py.File(checkpoint, "r") as file:
            self.assertEqual(np.ravel(evaluated.json("evaluation.json")["angles"]).tolist(), file["angles"][...].tolist())
        config["objective"], config["material"] = [{"type": "distortion", "measure": "layerwise"}], {}
        sliced = self.run_config(1, config, "-task", "simulate", "-sequence", run.path("result.h5"))
        self.assertEqual(sliced.status, DONE, str(sliced))


class RanksTest(FabseqTest):
    def compare(self, config, splits, *more):
        arguments = ("-max_iterations", 4, "-tolerance", "1e-11", "-output_every", 4, "-checkpoint_every", 2, *more)
        expected = self.run_config(1, config, *arguments)
        self.assert_done(expected)
        for ranks, groups in splits:
            with self.subTest(config=config["name"], ranks=ranks, groups=groups):
                run = self.run_config(ranks, config, *arguments, "-layer_groups", groups)
                self.assert_done(run)
                for line, correct in zip(run.history(), expected.history(), strict=True):
                    for key in COMPARED:
                        self.assertLess(largest_relative_difference(line[key], correct[key]), 1e-5, key)
                    for kind, counts in correct["solver_iterations"].items():
                        self.assertEqual(len(line["solver_iterations"][kind]), len(counts), kind)
                fields, correct = read_result(run), read_result(expected)
                self.assertEqual(set(fields), set(correct))
                for name, values in correct.items():
                    assert_close(fields[name], values, 1e-5, name)

    def test_plane(self):
        self.compare(tee_2d(), ((4, 2),) if SANITIZED else ((2, 1), (4, 2), (3, 3)))

    def test_solid(self):
        self.compare(tee_3d(), ((4, 2),) if SANITIZED else ((3, 1), (4, 2)), "-lanes", 4)

    @run_fabseq.only_release
    def test_reference_path(self):
        self.compare(tee_2d(), ((2, 2),), "-solver_path", "reference", "-reference_method", "direct")


class GradientsTest(FabseqTest):
    def check(self, config, components, *arguments):
        run = self.run_config(2, config, "-task", "check_gradients", *arguments, timeout=900)
        self.assert_done(run)
        entries = run.json("gradient_check.json")["components"]
        self.assertEqual([entry["variables"] for entry in entries], ["design"] * components + ["angles"] * components)
        for entry in entries:
            self.assertLess(entry["best"], 1e-5, f"{entry['name']} ({entry['type']}), {entry['variables']}")
            volume_of_angles = entry["type"] == "subpart_volume" and entry["variables"] == "angles"
            self.assertEqual(entry["adjoint"] == 0, volume_of_angles, entry["name"])

    def test_both_strains_and_voids(self):
        """In layer groups too. All combinations: gradient_matrix_test."""
        constant, turning = [-0.013, -0.013, 0], {"tangential": -0.013, "normal": -0.002}
        for config, components, strain, void, groups in ((tee_2d(), 6, constant, "absent", 1), (tee_2d(), 6, turning, "quiet", 2),
                                                         (tee_3d(), 5, turning, "absent", 2)):
            with self.subTest(config=config["name"], strain=strain, void=void):
                config["material"]["inherent_strain"] = strain
                self.check(config, components, "-void", void, "-layer_groups", groups)


class JumpsTest(FabseqTest):
    def value(self, config, angle):
        config["layers"]["angles"][1] = [angle]
        run = self.run_config(1, config, "-task", "evaluate", "-tolerance", "1e-9")
        self.assert_done(run)
        evaluation = run.json("evaluation.json")
        return evaluation["responses"][0]["value"], len(evaluation["layers"])

    @run_fabseq.only_release
    def test_objective_where_slabs_come_and_go(self):
        """Between two angles with other numbers of layers, halved until they are next to each other."""
        config = tee_2d()
        config["objective"] = [config["objective"][0]]
        high, count = 0.2, self.value(config, 0.2)[1]
        changed = count
        while changed == count:
            low, high = high, high + 0.05
            self.assertLess(high, 1.5, "always as many layers")
            changed = self.value(config, high)[1]
        for _ in range(26):
            middle = 0.5 * (low + high)
            if self.value(config, middle)[1] == count:
                low = middle
            else:
                high = middle
        (before, first), (after, second) = self.value(config, low), self.value(config, high)
        self.assertNotEqual(first, second)
        self.assertLess(abs(after - before), 1e-7 * before)


class RefusalsTest(FabseqTest):
    def assert_refused(self, config, *arguments, words):
        path = self.write_config(config)
        before = self.tree()
        run = self.run_program(2, "-config", path, *arguments)
        self.assertEqual(run.status, BAD_INPUT, str(run))
        self.assertEqual(len(run.messages()), 1, str(run))
        for word in words:
            self.assertIn(word, run.messages()[0])
        self.assertEqual(self.tree(), before)

    def test_configs(self):
        config = tee_2d()
        config["constraints"].append({"type": "deposition_speed"})
        self.assert_refused(config, words=["/constraints/1/type", "multi_planar"])
        self.assert_refused(tee_2d(), "-set", 'layers.fixed=["angles", "time"]', words=["/layers/fixed"])
        self.assert_refused(tee_2d(), "-set", "objective.1.band=0.4", words=["/objective/1/band", "before 1"])

    def test_designs(self):
        path = os.path.join(self.directory, "design.h5")
        evaluate = ("-task", "evaluate", "-design", path)
        for angles, words in (([0.2, 0.4], ["angles", "[2]", "[3,1]"]),
                              ([[0.2], [0.4], [2.0]], ["angles", "2.0", "outside 0.0 to 1.5708"])):
            write_voxels(path, np.full((15, 22), 0.1), dataset="design")
            with h5py.File(path, "a") as file:
                file["angles"] = angles
            self.assert_refused(tee_2d(), *evaluate, words=words)


if __name__ == "__main__":
    run_fabseq.main()
