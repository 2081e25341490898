# SPDX-License-Identifier: MIT
"""Direct sequences and variable time points: files, restarts, ranks and groups, and what is refused."""

import os

import h5py
import numpy as np

import run_fabseq
from read_outputs import assert_close, read_dump, read_result
from run_fabseq import BAD_INPUT, FabseqTest, SANITIZED, largest_relative_difference
from small_parts import direct_2d, hook_3d, part_density, touched_nodes, write_voxels

DENSITY = part_density(direct_2d())
TOUCHED = touched_nodes(DENSITY)
COMPARED = ("objective", "objective_scaled", "constraints", "change", "time_points", "interior_minima")


def direct_3d():
    config = hook_3d()
    config["sequence"] = {"type": "direct", "location": "nodes"}
    config["layers"]["time_points"] = "variable"
    config["constraints"] += [{"type": "continuity", "limit": 0.01}, {"type": "minimum_layer_volume", "fraction": 0.1}]
    return config


def smoothed(location):
    """Times smoothed over three elements."""
    config = direct_2d(location)
    config["name"] += "_smoothed"
    config["sequence"]["filter_radius"] = 0.3
    return config


class PlateauTest(FabseqTest):
    def test_times_that_do_not_change(self):
        """A start region of whole elements has no gradient: its layer counts as thick as the part is long,
        all numbers of the files are finite, and the run says so."""
        config = {"domain": {"size": [8, 6], "elements": [8, 6]},
                  "part": {"union": [{"box": {"min": [0, 0], "max": [2, 6]}}, {"box": {"min": [0, 4], "max": [8, 6]}}]},
                  "sequence": {"type": "direct", "location": "nodes", "start": {"box": {"min": [0, 0], "max": [2, 1]}}},
                  "layers": {"count": 8}, "objective": [{"type": "distortion", "measure": "layerwise"}]}
        run = self.run_config(2, config, "-task", "simulate", "-binary")
        self.assert_done(run)
        for name, values in read_result(run).items():
            self.assertTrue(np.isfinite(values).all(), name)
        thickness = run.json("summary.json")["checks"]["local_thickness"]
        self.assertEqual((thickness["largest"], thickness["without_end"]), (8.0, 2))
        self.assertIn("warning: local thickness: the pseudo-time hardly changes at 2 elements", run.stderr)


class OutputsTest(FabseqTest):
    def check_result(self, run, location):
        entities = DENSITY > 0 if location == "elements" else TOUCHED.copy()
        data = read_result(run)
        self.assertEqual(data["design"].shape, entities.shape)
        self.assertTrue(np.all(data["design"][~entities] == 0))
        self.assertEqual(data["design"][0, 0], 0)  # the start
        self.assertGreater(np.count_nonzero(data["design"]), 0.9 * entities.sum())
        time = data["design"]
        if location == "nodes":
            time = (time[1:, 1:] + time[1:, :-1] + time[:-1, 1:] + time[:-1, :-1]) / 4
        np.testing.assert_allclose(data["time"][DENSITY > 0], time[DENSITY > 0], rtol=1e-14)
        points = data["time_points"]
        self.assertEqual(points.shape, (3,))
        self.assertEqual(run.json("summary.json")["time_points"], list(points))
        layers = 1 + (data["time"][..., None] > points + 1e-12).sum(-1)
        np.testing.assert_array_equal(data["layer"][DENSITY > 0], layers[DENSITY > 0])
        self.assertNotIn("temperature", data)
        return data

    def test_files(self):
        self.resumes = True
        for location in ("nodes", "elements"):
            with self.subTest(location=location):
                run = self.optimize(direct_2d(location))
                self.check_result(run, location)
                for line in run.history():
                    self.assertEqual(len(line["time_points"]), 3)
                    self.assertEqual(line["solver_iterations"]["heat"], [])
                    self.assertNotIn("temperature_range", line)
                self.assertEqual(run.history()[0]["time_points"], [0.25, 0.5, 0.75])
                self.assertNotEqual(run.history()[-1]["time_points"], [0.25, 0.5, 0.75])
                dump = read_dump(run, 4)
                shape = (1,) + ((12, 20) if location == "elements" else (13, 21))
                self.assertEqual(dump["design"].shape[-2:], shape[-2:])
                with h5py.File(run.path("checkpoint/slot_1.h5"), "r") as file:
                    self.assertEqual(file["design"].shape, shape[-2:])
                    self.assertEqual(file["optimizer/low"].shape, shape[-2:])
                    self.assertEqual(file["time_points"].shape, (3,))
                    self.assertEqual(file["optimizer/time_points_low"].shape, (3,))

    def test_a_design_is_read_again(self):
        """Field and time points of a result, and of a checkpoint."""
        for config in (direct_2d("nodes"), direct_2d("elements"), direct_3d()):
            with self.subTest(config=config["name"]):
                run = self.optimize(config, 2)
                summary = run.json("summary.json")
                for task, name in (("evaluate", "evaluation.json"), ("simulate", "summary.json")):
                    again = self.run_config(3, config, "-task", task, "-design", run.path("result.h5"), "-beta",
                                            repr(summary["beta"]), "-tolerance", "1e-11")
                    self.assert_done(again)
                    found = again.json(name)
                    values = [entry["value"] for entry in found["responses"]]
                    correct = [entry["value"] for entry in summary["optimized"]["responses"]]
                    self.assertLess(largest_relative_difference(values, correct), 1e-6)
                    self.assertEqual(found["time_points"], summary["time_points"])
                assert_close(read_result(again)["design"], read_result(run)["design"], 1e-14, "design")

    def test_file_without_time_points(self):
        path = os.path.join(self.directory, "design.h5")
        write_voxels(path, np.zeros((13, 21)), dataset="design")
        result = self.run_config(1, direct_2d(), "-task", "evaluate", "-design", path)
        self.assert_done(result)
        self.assertIn("has no dataset 'time_points'", result.messages()[0])
        self.assertEqual(result.json("evaluation.json")["time_points"], [0.25, 0.5, 0.75])

    def test_gradients(self):
        config = direct_2d()
        run = self.run_config(2, config, "-task", "evaluate")
        self.assert_done(run)
        data = read_result(run, "gradients.h5")
        names = [entry["name"] for entry in run.json("evaluation.json")["responses"]]
        self.assertEqual(set(data), {f"{name}/{kind}" for name in names for kind in ("design", "time_points")})
        for name in names:
            field = data[name + "/design"]
            self.assertEqual(field.shape, (13, 21))
            self.assertTrue(np.all(field[~TOUCHED] == 0) and field[0, 0] == 0)
            self.assertEqual(data[name + "/time_points"].shape, (3,))

    def test_uniform_time_points_are_no_variables(self):
        config = direct_2d()
        config["layers"]["time_points"] = "uniform"
        run = self.optimize(config)
        self.assertNotIn("time_points", run.history()[0])
        self.assertNotIn("time_points", read_result(run))

    def test_heat_with_variable_time_points(self):
        self.resumes = True
        config = hook_3d()
        config["layers"]["time_points"] = "variable"
        run = self.optimize(config, 2)
        self.assertEqual(len(run.history()[-1]["time_points"]), 2)
        self.assertIn("temperature_range", run.history()[-1])

    def test_check_prints_the_variables(self):
        result = self.run_config(2, direct_2d(), "-task", "check", output="")
        self.assert_done(result)
        self.assertIn(f"design variables: {TOUCHED.sum() - 1} on nodes, 3 time points", result.stdout)


class RanksTest(FabseqTest):
    """Also in layer groups: time points belong to one rank, and get derivatives from all."""

    def compare(self, config, splits):
        arguments = ("-max_iterations", 4, "-tolerance", "1e-11", "-output_every", 4, "-checkpoint_every", 2)
        expected = self.run_config(1, config, *arguments)
        self.assert_done(expected)
        for ranks, groups in splits:
            with self.subTest(config=config["name"], ranks=ranks, groups=groups):
                run = self.run_config(ranks, config, *arguments, "-layer_groups", groups)
                self.assert_done(run)
                for line, correct in zip(run.history(), expected.history(), strict=True):
                    for key in COMPARED:
                        self.assertLess(largest_relative_difference(line[key], correct[key]), 1e-6, key)
                fields, correct = read_result(run), read_result(expected)
                self.assertEqual(set(fields), set(correct))
                for name, values in correct.items():
                    assert_close(fields[name], values, 1e-6, name)

    def test_nodes(self):
        self.compare(direct_2d("nodes"), ((4, 2),) if SANITIZED else ((2, 1), (4, 2), (3, 3)))

    def test_elements(self):
        self.compare(direct_2d("elements"), ((4, 2),) if SANITIZED else ((3, 1), (4, 2)))

    @run_fabseq.only_release
    def test_smoothed(self):
        for location in ("nodes", "elements"):
            self.compare(smoothed(location), ((4, 2),))

    @run_fabseq.only_release
    def test_solid(self):
        self.compare(direct_3d(), ((3, 1), (4, 2)))


class RestartOnOtherRanksTest(FabseqTest):
    def test_a_run_goes_on_with_other_ranks_and_groups(self):
        arguments = ("-max_iterations", 6, "-tolerance", "1e-11")
        expected = self.run_config(1, direct_2d(), *arguments)
        self.assert_done(expected)
        output = os.path.join(self.directory, "half")
        os.mkdir(output)
        for stop, ranks, groups in ((2, 2, 2), (4, 3, 1), (None, 4, 2)):
            if stop:
                with open(os.path.join(output, "stop"), "w", encoding="utf-8") as file:
                    file.write(str(stop))
            run = self.run_config(ranks, direct_2d(), *arguments, "-layer_groups", groups, "-restart", "auto", output=output)
        self.assert_done(run)
        self.assertEqual(len(run.history()), 6)
        for line, wanted in zip(run.history(), expected.history(), strict=True):
            for key in COMPARED:
                self.assertLess(largest_relative_difference(line[key], wanted[key]), 1e-6,
                                f"{key} of iteration {line['iteration']}")


class CheckGradientsTest(FabseqTest):
    def check(self, config, components, *arguments):
        run = self.run_config(2, config, "-task", "check_gradients", *arguments, timeout=900)
        self.assert_done(run)
        entries = run.json("gradient_check.json")["components"]
        self.assertEqual([entry["variables"] for entry in entries],
                         ["design"] * components + ["time_points"] * components)
        for entry in entries:
            self.assertLess(entry["best"], 1e-5, f"{entry['name']} ({entry['type']}), {entry['variables']}")
            continuity_in_time_points = entry["type"] == "continuity" and entry["variables"] == "time_points"
            self.assertEqual(entry["adjoint"] == 0, continuity_in_time_points, entry["name"])

    def test_nodes(self):
        self.check(direct_2d("nodes"), 14)

    def test_elements(self):
        self.check(direct_2d("elements"), 9)

    @run_fabseq.only_release
    def test_smoothed(self):
        self.check(smoothed("nodes"), 14)

    @run_fabseq.only_release
    def test_heat(self):
        config = hook_3d()
        config["layers"]["time_points"] = "variable"
        self.check(config, 8)

    @run_fabseq.only_release
    def test_solid(self):
        self.check(direct_3d(), 12, "-layer_groups", 2)


class RefusalsTest(FabseqTest):
    def assert_refused(self, config, *arguments, words, rank_counts=(3,)):
        path = self.write_config(config)
        for ranks in rank_counts:
            before = self.tree()
            run = self.run_program(ranks, "-config", path, *arguments)
            self.assertEqual(run.status, BAD_INPUT, str(run))
            self.assertEqual(len(run.messages()), 1, str(run))
            for word in words:
                self.assertIn(word, run.messages()[0])
            self.assertEqual(self.tree(), before)

    def test_thickness_of_times_of_elements(self):
        config = direct_2d("elements")
        config["constraints"].append({"type": "layer_thickness", "target": 0.3})
        self.assert_refused(config, words=["/constraints/3/type", "elements", "not defined"])
        config = direct_2d("elements")
        config["objective"].append({"type": "layer_uniformity"})
        self.assert_refused(config, words=["/objective/1/type", "elements", "not defined"])

    def test_start_regions(self):
        for task, location, rank_counts in (("optimize", "nodes", (1, 3)), ("evaluate", "elements", (3,)),
                                            ("check", "nodes", (3,))):
            config = direct_2d(location)
            config["sequence"]["start"] = {"box": {"min": [3, 3], "max": [4, 4]}}
            self.assert_refused(config, "-task", task, words=["/sequence/start", "needs at least one"], rank_counts=rank_counts)
        config = direct_2d()
        config["sequence"]["start"] = {"box": {"min": [0, 0], "max": [2, 1.2]}}
        self.assert_refused(config, words=["/sequence/start", "holds all"])
        config["part"] = {"union": [{"box": {"min": [0, 0], "max": [0.8, 1.2]}},
                                    {"box": {"min": [1.2, 0], "max": [2, 1.2]}}]}
        config["sequence"]["start"] = {"box": {"min": [0, 0], "max": [0, 0]}}
        self.assert_refused(config, words=["/sequence/start", "117 nodes", "cannot be reached"])

    def test_designs(self):
        path = os.path.join(self.directory, "design.h5")
        evaluate = ("-task", "evaluate", "-design", path)
        write_voxels(path, np.zeros((12, 20)), dataset="design")
        self.assert_refused(direct_2d(), *evaluate, words=["-design: dataset 'design'", "[12,20]", "[13,21]"])
        with h5py.File(path, "w") as file:
            file["design"] = np.full((13, 21), 1.5)
        self.assert_refused(direct_2d(), *evaluate, words=["-design", "outside the bounds 0.0 to 1.0", "nodes"])
        for points, words in (([0.2, 0.4], ["time_points", "[2]", "[3]"]), ([0.2, 0.4, 1.2], ["time_points", "0 to 1"])):
            with h5py.File(path, "w") as file:
                file["design"] = np.zeros((13, 21))
                file["time_points"] = points
            self.assert_refused(direct_2d(), *evaluate, words=words)

    def test_restart_of_another_location(self):
        run = self.run_config(1, direct_2d(), "-max_iterations", 2)
        self.assert_done(run)
        other = self.run_config(1, direct_2d("elements"), "-max_iterations", 3, "-restart", run.output)
        self.assertEqual(other.status, BAD_INPUT, str(other))
        self.assertIn("is of another problem", other.messages()[0])


if __name__ == "__main__":
    run_fabseq.main()
