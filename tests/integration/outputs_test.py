# SPDX-License-Identifier: MIT
"""What an optimization leaves in its output directory: form and values of every file, on 1 and on 2 ranks."""

import json
import os
import shutil
import unittest

import h5py
import numpy as np

import run_fabseq
from read_outputs import assert_close, read_dump, read_result
from run_fabseq import FabseqTest, largest_relative_difference
from small_parts import part_density, plate_2d, touched_nodes

ITERATIONS = 5
PHASES = {"heat", "layers", "primal", "adjoint", "responses", "optimizer", "output", "total"}
CONFIG = plate_2d()
DENSITY = part_density(CONFIG)
TOUCHED = touched_nodes(DENSITY)
RUNS = {}  # by number of ranks


def setUpModule():
    holder = FabseqTest()
    holder.setUp()
    unittest.addModuleCleanup(holder.doCleanups)
    path = holder.write_config(CONFIG)
    for ranks in (1, 2):
        RUNS[ranks] = holder.run_program(ranks, "-config", path, "-max_iterations", ITERATIONS, "-output_every", 1,
                                         "-checkpoint_every", 2, "-tolerance", "1e-11")
        holder.assert_done(RUNS[ranks])


class OutputsOfOneRankTest(FabseqTest):
    ranks = 1

    def test_files(self):
        names = {"config.json", "history.jsonl", "result.h5", "result.xdmf", "summary.json", "checkpoint/newest",
                 "checkpoint/slot_0.h5", "checkpoint/slot_1.h5"}
        for iteration in range(1, ITERATIONS + 1):
            names |= {f"fields/iteration_{iteration:04d}.bin", f"fields/iteration_{iteration:04d}.xdmf"}
        run = RUNS[self.ranks]
        found = {os.path.relpath(os.path.join(folder, name), run.output)
                 for folder, _, files in os.walk(run.output) for name in files}
        self.assertEqual(found, names)

    def test_history(self):
        run = RUNS[self.ranks]
        history = run.history()
        self.assertEqual([line["iteration"] for line in history], list(range(1, ITERATIONS + 1)))
        for line in history:
            self.assertEqual([len(line["objective"]), len(line["objective_scaled"])], [2, 2])
            self.assertEqual([len(values) for values in line["constraints"]], [4])
            worst = max(abs(value - 1) - 0.1 for value in line["constraints"][0])
            self.assertAlmostEqual(line["worst_constraint"], worst, places=12)
            self.assertAlmostEqual(line["objective_scaled"][0], 100)  # scaled at every iteration
            for key in ("beta", "change", "peak_memory_bytes"):
                self.assertGreater(line[key], 0)
            solves = line["solver_iterations"]
            self.assertEqual([len(solves[key]) for key in ("primal", "adjoint")], [4, 4])
            self.assertGreater(len(solves["heat"]), 0)
            self.assertEqual(set(line["seconds"]), PHASES)
            phases = sum(value for key, value in line["seconds"].items() if key != "total")
            self.assertLessEqual(phases, 1.01 * line["seconds"]["total"] + 1e-3)
        first = history[0]["objective"][1]
        for line in history:  # uniformity: scaled at the first iteration
            self.assertAlmostEqual(line["objective_scaled"][1], 100 * line["objective"][1] / first, places=8)

    def test_summary(self):
        run = RUNS[self.ranks]
        summary = run.json("summary.json")
        self.assertEqual((summary["status"], summary["iterations"], summary["ranks"]),
                         ("iteration_limit", ITERATIONS, self.ranks))
        self.assertIsInstance(summary["reason"], str)
        self.assertIsInstance(summary["interior_minima"], int)
        self.assertEqual(set(summary["seconds"]), PHASES)
        self.assertGreater(summary["peak_memory_bytes"], 1e6)
        names = ["objective_0", "objective_1"] + [f"constraint_0_{j}" for j in range(4)]
        types = ["distortion", "layer_uniformity"] + ["layer_thickness"] * 4
        for name in ("optimized", "binary", "baseline", "start"):
            block = summary[name]
            self.assertEqual([entry["name"] for entry in block["responses"]], names)
            self.assertEqual([entry["type"] for entry in block["responses"]], types)
            self.assertEqual(len(block["layers"]), 4)
            volume = sum(layer["volume"] for layer in block["layers"])
            self.assertAlmostEqual(volume, DENSITY.sum() * 0.1 * 0.1 * 0.5)
            for layer, response in zip(block["layers"], block["responses"][2:], strict=True):
                self.assertAlmostEqual(layer["thickness"] / 0.3, response["value"])

    def test_the_best_iterate_is_reported(self):
        run = RUNS[self.ranks]
        summary = run.json("summary.json")
        line = run.history()[summary["best_iteration"] - 1]
        values = [entry["value"] for entry in summary["optimized"]["responses"]]
        self.assertLess(largest_relative_difference(values, line["objective"] + line["constraints"][0]), 1e-8)

    def test_result(self):
        elements, nodes = (12, 20), (13, 21)
        shapes = {name: elements for name in ("density", "time", "design", "layer", "planar/time", "planar/layer",
                                              "start/time", "start/layer", "even/time", "even/layer")}
        for prefix in ("", "planar/", "start/", "even/"):
            shapes |= {prefix + "local_thickness": elements, prefix + "hanging": elements, prefix + "fault": elements,
                       prefix + "tilt": elements, prefix + "build_direction": elements + (2,),
                       prefix + "time_gradient": elements + (2,)}
        shapes["temperature"] = shapes["start/temperature"] = nodes
        for prefix in ("", "binary/", "planar/", "start/", "even/"):
            shapes |= dict.fromkeys((prefix + "displacement", prefix + "release_displacement", prefix + "released_displacement"),
                                    nodes + (2,))
        shapes |= {"model/stiffness": elements, "model/strain_factor": elements, "model/strain": (3,),
                   "model/unbuilt_stiffness": (1,), "model/node_sets/top": (21,), "model/supports": (21,)}
        run = RUNS[self.ranks]
        data = read_result(run)
        self.assertEqual({name: values.shape for name, values in data.items()}, shapes)
        part = DENSITY > 0
        np.testing.assert_array_equal(data["density"], DENSITY)
        for prefix in ("", "planar/", "start/"):
            time, layer = data[prefix + "time"], data[prefix + "layer"]
            self.assertTrue(np.all(layer[~part] == 0) and np.all(time[~part] == 0))
            np.testing.assert_array_equal(layer[part], np.clip(np.ceil(4 * time[part] - 1e-9), 1, 4))
        height = np.broadcast_to((np.arange(12)[:, None] + 0.5) / 12, elements)
        np.testing.assert_allclose(data["planar/time"][part], height[part], rtol=1e-12)
        design = data["design"]
        self.assertTrue(np.all((design[part] >= 1e-3 * (1 - 1e-12)) & (design[part] <= 1 + 1e-12)))
        self.assertTrue(np.all(design[~part] == 0))
        for name in ("displacement", "binary/displacement", "planar/displacement", "start/displacement"):
            self.assertTrue(np.all(data[name][0] == 0), "the plate does not move")
            self.assertTrue(np.all(data[name][~TOUCHED] == 0), "nothing outside the part moves")
        self.assertTrue(np.all((data["temperature"] > 0) & (data["temperature"] <= 1 + 1e-9)))
        for prefix in ("", "binary/", "planar/", "start/", "even/"):
            self.assertGreater(np.abs(data[prefix + "release_displacement"]).max(), 0)
            np.testing.assert_allclose(data[prefix + "released_displacement"],
                                       data[prefix + "displacement"] + data[prefix + "release_displacement"], atol=1e-15)

    def test_which_displacement_is_the_increment_of_the_release(self):
        with h5py.File(RUNS[self.ranks].path("result.h5"), "r") as file:
            for prefix in ("", "binary/", "planar/", "start/", "even/"):
                for name, words in (("displacement", "before the release"), ("release_displacement", "increment"),
                                    ("released_displacement", "the sum of displacement and release_displacement")):
                    self.assertIn(words, file[prefix + name].attrs["description"])
            self.assertNotIn("description", file["time"].attrs)

    def test_summary_agrees_with_the_fields(self):
        run = RUNS[self.ranks]
        summary, data = run.json("summary.json"), read_result(run)
        with h5py.File(run.path("result.h5"), "r") as file:
            attributes = dict(file.attrs)
        for block, prefix in (("optimized", ""), ("binary", "binary/"), ("baseline", "planar/"), ("start", "start/")):
            displacement = data[prefix + "displacement"]
            norms = np.sqrt((displacement**2).sum(-1))
            size, responses = summary[block]["displacement"], summary[block]["responses"]
            self.assertAlmostEqual(size["max"] / norms.max(), 1)
            self.assertAlmostEqual(size["rms"] / np.sqrt((norms[TOUCHED]**2).mean()), 1)
            self.assertAlmostEqual(responses[0]["value"] / (norms[-1]**2).sum(), 1)  # the node set is the whole top
            for response in responses:
                self.assertEqual(attributes[f"{block}/{response['name']}"], response["value"])
        for block, prefix in (("binary", ""), ("baseline", "planar/"), ("start", "start/")):
            volumes = [layer["volume"] for layer in summary[block]["layers"]]
            counts = [np.sum(data[prefix + "layer"] == j) for j in range(1, 5)]
            np.testing.assert_allclose(volumes, np.array(counts) * 0.005, rtol=1e-6, atol=1e-7)
        self.assertEqual((attributes["layers"], attributes["iteration"]), (4, summary["best_iteration"]))

    def test_dump_of_the_best_iterate_is_the_result(self):
        run = RUNS[self.ranks]
        data = read_result(run)
        for name, values in read_dump(run, run.json("summary.json")["best_iteration"]).items():
            assert_close(values, data[name].reshape(values.shape), 1e-8, name)

    def test_checkpoint(self):
        """The last one holds the end of the run: its best design, and what a further iteration would
        evaluate."""
        run = RUNS[self.ranks]
        with open(run.path("checkpoint/newest"), encoding="utf-8") as file:
            newest = file.read().strip()
        other = {"slot_0.h5": "slot_1.h5", "slot_1.h5": "slot_0.h5"}[newest]
        with h5py.File(run.path("checkpoint/" + newest), "r") as file:
            self.assertEqual(file.attrs["iteration"], ITERATIONS)
            np.testing.assert_array_equal(file["best/design"][()], read_result(run)["design"])
            self.assertTrue(all("checksum" in file[name].attrs for name in ("design", "optimizer/low", "best/design")))
        with h5py.File(run.path("checkpoint/" + other), "r") as file:
            self.assertEqual(file.attrs["iteration"], 4)
            np.testing.assert_array_equal(file["design"][()].ravel(), read_dump(run, 5)["design"].ravel())


class OutputsOfTwoRanksTest(OutputsOfOneRankTest):
    ranks = 2

    def test_fields_of_two_ranks_are_those_of_one(self):
        for iteration in range(1, ITERATIONS + 1):
            one, two = (read_dump(RUNS[ranks], iteration) for ranks in (1, 2))
            self.assertEqual(set(one), {"density", "time", "layer", "design", "temperature", "displacement",
                                        "build_direction", "tilt", "local_thickness", "hanging"})
            self.assertEqual(set(two), set(one))
            for name in ("density", "layer"):
                np.testing.assert_array_equal(two[name], one[name])
            for name, values in one.items():
                assert_close(two[name], values, 1e-7, name)
        one, two = (read_result(RUNS[ranks]) for ranks in (1, 2))
        for name, values in one.items():
            assert_close(two[name], values, 1e-7, name)

    @unittest.skipUnless(shutil.which("pvpython") and shutil.which("Xvfb"), "ParaView is not installed")
    def test_paraview_reads_the_fields(self):
        run = RUNS[2]
        for name, fields in (("fields/iteration_0003.xdmf", read_dump(run, 3)),
                             ("result.xdmf", {name: values for name, values in read_result(run).items()
                                              if not name.startswith("model/")})):
            with self.subTest(file=name):
                arrays = self.read_with_paraview(run.path(name))
                for center, offset, counts in (("Cell", 0.5, (20, 12)), ("Node", 0.0, (21, 13))):
                    x, y = (0.1 * (np.arange(n) + offset) for n in counts)
                    expected = np.stack(np.broadcast_arrays(x[None, :], y[:, None]), -1).reshape(-1, 2)
                    np.testing.assert_allclose(arrays[f"{center} position"][:, :2], expected, rtol=0, atol=1e-12)
                found = {key.split(" ", 1)[1] for key in arrays} - {"position"}
                self.assertEqual(found, set(fields))
                for field, values in fields.items():
                    center, count = ("Cell", 240) if values.size % 240 == 0 else ("Node", 273)
                    expected = values.reshape(count, -1)
                    array = arrays[f"{center} {field}"].reshape(count, -1)[:, :expected.shape[1]]
                    np.testing.assert_array_equal(array, expected, err_msg=field)

    @unittest.skipUnless(shutil.which("pvpython") and shutil.which("Xvfb"), "ParaView is not installed")
    def test_paraview_shows_the_iterations_as_a_film(self):
        """Its times are their numbers."""
        run = RUNS[2]
        files = [run.path(f"fields/iteration_{number:04d}.xdmf") for number in (2, 3, 5)]
        times, values = map(json.loads, self.run_in_paraview("read_times.py", "time", *files).splitlines())
        self.assertEqual(times, [2, 3, 5])
        np.testing.assert_array_equal(values, read_dump(run, 5)["time"].ravel())

    def read_with_paraview(self, path):
        saved = os.path.join(self.directory, "arrays.npz")
        self.run_in_paraview("read_arrays.py", path, saved)
        with np.load(saved) as arrays:
            return dict(arrays)

    def run_in_paraview(self, script, *words):
        tools = os.path.join(run_fabseq.ROOT, "scripts", "fabseq-tools")
        command = [tools, "virtual-display", "pvpython", os.path.join(run_fabseq.HERE, script), *words]
        status, stdout, stderr = run_fabseq.run_command(command, self.directory, 300)
        self.assertEqual(status, 0, stdout + stderr)
        return stdout


if __name__ == "__main__":
    run_fabseq.main()
