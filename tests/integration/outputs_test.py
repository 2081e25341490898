"""What a run leaves in its output directory: form and values of every file, on 1 and on 2 ranks."""

import os
import re
import shutil
import unittest

import h5py
import numpy as np

import run_fabseq
from run_fabseq import FabseqTest, largest_relative_difference
from small_parts import hook_3d, plate_2d, write_voxels

ITERATIONS = 5
PHASES = {"heat", "layers", "primal", "adjoint", "responses", "optimizer", "output", "total"}


def scalar_history(run):
    """Of every iteration the numbers that do not depend on clock and memory."""
    lines = run.history()
    for line in lines:
        del line["seconds"], line["peak_memory_bytes"]
    return lines


def read_result(run, name="result.h5"):
    """Datasets by path."""
    datasets = {}
    with h5py.File(run.path(name), "r") as file:
        def collect(path, entry):
            if isinstance(entry, h5py.Dataset):
                datasets[path] = entry[()]

        file.visititems(collect)
    return datasets


def assert_close(values, expected, tolerance, name):
    """`tolerance` is relative to the largest entry."""
    np.testing.assert_allclose(values, expected, rtol=0, atol=tolerance * np.abs(expected).max(), err_msg=name)


def read_dump(run, iteration):
    """Fields of fields/iteration_NNNN.bin, read as its .xdmf describes them."""
    base = run.path(f"fields/iteration_{iteration:04d}")
    with open(base + ".xdmf", encoding="utf-8") as file:
        text = file.read()
    with open(base + ".bin", "rb") as file:
        content = file.read()
    pattern = (r'<Attribute Name="(\w+)"[^>]*>\s*<DataItem Dimensions="([\d ]+)" NumberType="Float" Precision="(\d)" '
               r'Format="Binary" Endian="Little" Seek="(\d+)">([^<]+)<')
    fields, end = {}, 0
    for name, shape, precision, seek, binary in re.findall(pattern, text):
        shape = [int(n) for n in shape.split()]
        assert binary == os.path.basename(base) + ".bin"
        fields[name] = np.frombuffer(content, f"<f{precision}", int(np.prod(shape)), int(seek)).reshape(shape)
        end = max(end, int(seek) + fields[name].nbytes)
    assert end == len(content), f"{len(content)} bytes in {base}.bin, {end} described"
    return fields


def part_density(config):
    """Density of plate_2d and of hook_3d at element centres, [z][y][x]."""
    size, elements = config["domain"]["size"], config["domain"]["elements"]
    axes = [(np.arange(n) + 0.5) * edge / n for n, edge in zip(elements, size)]
    center = np.meshgrid(*axes[::-1], indexing="ij")[::-1]
    if len(size) == 2:
        return 1.0 * ((center[0] - 2.0)**2 + (center[1] - 0.6)**2 > 0.31**2)
    return 1.0 * ((center[0] < 0.8) | (center[2] > 1.0))


def touched_nodes(density):
    """Nodes of elements with density above 0."""
    touched = np.zeros([n + 1 for n in density.shape], bool)
    for corner in np.ndindex(*[2] * density.ndim):
        touched[tuple(slice(c, c + n) for c, n in zip(corner, density.shape))] |= density > 0
    return touched


class OptimizeOutputTest(FabseqTest):
    """One run on 1 rank, one on 2, shared by all tests of the class."""

    @classmethod
    def setUpClass(cls):
        holder = FabseqTest()
        holder.setUp()
        cls.addClassCleanup(holder.doCleanups)
        cls.config = plate_2d()
        path = holder.write_config(cls.config)
        cls.runs_by_ranks = {}
        for ranks in (1, 2):
            run = holder.run_program(ranks, "-config", path, "-max_iterations", ITERATIONS, "-output_every", 1,
                                     "-checkpoint_every", 2, "-tolerance", "1e-11")
            holder.assert_done(run)
            cls.runs_by_ranks[ranks] = run
        cls.density = part_density(cls.config)
        cls.touched = touched_nodes(cls.density)

    def each_run(self):
        for ranks, run in self.runs_by_ranks.items():
            with self.subTest(ranks=ranks):
                yield ranks, run

    def test_files(self):
        names = {"config.json", "history.jsonl", "result.h5", "result.xdmf", "summary.json", "checkpoint/newest",
                 "checkpoint/slot_0.h5", "checkpoint/slot_1.h5"}
        for iteration in range(1, ITERATIONS + 1):
            names |= {f"fields/iteration_{iteration:04d}.bin", f"fields/iteration_{iteration:04d}.xdmf"}
        for _, run in self.each_run():
            found = {os.path.relpath(os.path.join(folder, name), run.output)
                     for folder, _, files in os.walk(run.output) for name in files}
            self.assertEqual(found, names)

    def test_history(self):
        for _, run in self.each_run():
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
        for ranks, run in self.each_run():
            summary = run.json("summary.json")
            self.assertEqual((summary["status"], summary["iterations"], summary["ranks"]),
                             ("iteration_limit", ITERATIONS, ranks))
            self.assertIsInstance(summary["reason"], str)
            self.assertIsInstance(summary["interior_minima"], int)
            self.assertEqual(set(summary["seconds"]), PHASES)
            self.assertGreater(summary["peak_memory_bytes"], 1e6)
            names = ["objective_0", "objective_1"] + [f"constraint_0_{j}" for j in range(4)]
            types = ["distortion", "layer_uniformity"] + ["layer_thickness"] * 4
            for name in ("optimized", "binary", "baseline"):
                block = summary[name]
                self.assertEqual([entry["name"] for entry in block["responses"]], names)
                self.assertEqual([entry["type"] for entry in block["responses"]], types)
                self.assertEqual(len(block["layers"]), 4)
                volume = sum(layer["volume"] for layer in block["layers"])
                self.assertAlmostEqual(volume, self.density.sum() * 0.1 * 0.1 * 0.5)
                for layer, response in zip(block["layers"], block["responses"][2:]):
                    self.assertAlmostEqual(layer["thickness"] / 0.3, response["value"])

    def test_the_best_iterate_is_reported(self):
        for _, run in self.each_run():
            summary = run.json("summary.json")
            line = run.history()[summary["best_iteration"] - 1]
            values = [entry["value"] for entry in summary["optimized"]["responses"]]
            self.assertLess(largest_relative_difference(values, line["objective"] + line["constraints"][0]), 1e-8)

    def test_result(self):
        elements, nodes = (12, 20), (13, 21)
        shapes = {name: elements for name in ("density", "time", "design", "layer", "planar/time", "planar/layer")}
        shapes["temperature"] = nodes
        for name in ("displacement", "binary/displacement", "planar/displacement"):
            shapes[name] = nodes + (2,)
        for _, run in self.each_run():
            data = read_result(run)
            self.assertEqual({name: values.shape for name, values in data.items()}, shapes)
            part = self.density > 0
            np.testing.assert_array_equal(data["density"], self.density)
            for prefix in ("", "planar/"):
                time, layer = data[prefix + "time"], data[prefix + "layer"]
                self.assertTrue(np.all(layer[~part] == 0) and np.all(time[~part] == 0))
                np.testing.assert_array_equal(layer[part], np.clip(np.ceil(4 * time[part] - 1e-9), 1, 4))
            height = np.broadcast_to((np.arange(12)[:, None] + 0.5) / 12, elements)
            np.testing.assert_allclose(data["planar/time"][part], height[part], rtol=1e-12)
            design = data["design"]
            self.assertTrue(np.all((design[part] >= 1e-3 * (1 - 1e-12)) & (design[part] <= 1 + 1e-12)))
            self.assertTrue(np.all(design[~part] == 0))
            for name in ("displacement", "binary/displacement", "planar/displacement"):
                self.assertTrue(np.all(data[name][0] == 0), "the plate does not move")
                self.assertTrue(np.all(data[name][~self.touched] == 0), "nothing outside the part moves")
            self.assertTrue(np.all((data["temperature"] > 0) & (data["temperature"] <= 1 + 1e-9)))

    def test_summary_agrees_with_the_fields(self):
        for _, run in self.each_run():
            summary, data = run.json("summary.json"), read_result(run)
            with h5py.File(run.path("result.h5"), "r") as file:
                attributes = dict(file.attrs)
            for block, prefix in (("optimized", ""), ("binary", "binary/"), ("baseline", "planar/")):
                displacement = data[prefix + "displacement"]
                norms = np.sqrt((displacement**2).sum(-1))
                size, responses = summary[block]["displacement"], summary[block]["responses"]
                self.assertAlmostEqual(size["max"] / norms.max(), 1)
                self.assertAlmostEqual(size["rms"] / np.sqrt((norms[self.touched]**2).mean()), 1)
                self.assertAlmostEqual(responses[0]["value"] / (norms[-1]**2).sum(), 1)  # the node set is the whole top
                for response in responses:
                    self.assertEqual(attributes[f"{block}/{response['name']}"], response["value"])
            for block, prefix in (("binary", ""), ("baseline", "planar/")):
                volumes = [layer["volume"] for layer in summary[block]["layers"]]
                counts = [np.sum(data[prefix + "layer"] == j) for j in range(1, 5)]
                np.testing.assert_allclose(volumes, np.array(counts) * 0.005, rtol=1e-6, atol=1e-7)
            self.assertEqual((attributes["layers"], attributes["iteration"]), (4, summary["best_iteration"]))

    def test_fields_of_two_ranks_are_those_of_one(self):
        for iteration in range(1, ITERATIONS + 1):
            one, two = (read_dump(self.runs_by_ranks[ranks], iteration) for ranks in (1, 2))
            self.assertEqual(set(one), {"density", "time", "layer", "design", "temperature", "displacement"})
            self.assertEqual(set(two), set(one))
            for name in ("density", "layer"):
                np.testing.assert_array_equal(two[name], one[name])
            for name, values in one.items():
                assert_close(two[name], values, 1e-7, name)
        one, two = (read_result(self.runs_by_ranks[ranks]) for ranks in (1, 2))
        for name, values in one.items():
            assert_close(two[name], values, 1e-7, name)

    def test_dump_of_the_best_iterate_is_the_result(self):
        for _, run in self.each_run():
            data = read_result(run)
            for name, values in read_dump(run, run.json("summary.json")["best_iteration"]).items():
                assert_close(values, data[name].reshape(values.shape), 1e-8, name)

    def test_checkpoint(self):
        for _, run in self.each_run():
            with open(run.path("checkpoint/newest"), encoding="utf-8") as file:
                slot = file.read().strip()
            with h5py.File(run.path("checkpoint/" + slot), "r") as file:
                self.assertEqual(file.attrs["iteration"], 4)
                np.testing.assert_array_equal(file["design"][()].ravel(), read_dump(run, 4)["design"].ravel())

    @unittest.skipUnless(shutil.which("pvpython") and shutil.which("xvfb-run"), "ParaView is not installed")
    def test_paraview_reads_the_fields(self):
        run = self.runs_by_ranks[2]
        for name, fields in (("fields/iteration_0003.xdmf", read_dump(run, 3)), ("result.xdmf", read_result(run))):
            with self.subTest(file=name):
                arrays = self.read_with_paraview(run.path(name))
                for center, offset, counts in (("Cell", 0.5, (20, 12)), ("Node", 0.0, (21, 13))):
                    x, y = (0.1 * (np.arange(n) + offset) for n in counts)
                    expected = np.stack(np.broadcast_arrays(x[None, :], y[:, None]), -1).reshape(-1, 2)
                    np.testing.assert_allclose(arrays[f"{center} position"][:, :2], expected, rtol=0, atol=1e-12)
                found = {key.split(" ", 1)[1] for key in arrays} - {"position"}
                self.assertEqual(found, set(fields))
                for field, values in fields.items():
                    center, count = ("Cell", 240) if values.size == 240 else ("Node", 273)
                    expected = values.reshape(count, -1)
                    array = arrays[f"{center} {field}"].reshape(count, -1)[:, :expected.shape[1]]
                    np.testing.assert_array_equal(array, expected, err_msg=field)

    def read_with_paraview(self, path):
        saved = os.path.join(self.directory, "arrays.npz")
        script = os.path.join(run_fabseq.HERE, "read_arrays.py")
        command = ["xvfb-run", "-a", "pvpython", script, path, saved]
        status, stdout, stderr = run_fabseq.run_command(command, self.directory, 300)
        self.assertEqual(status, 0, stdout + stderr)
        with np.load(saved) as arrays:
            return dict(arrays)


class RerunTest(FabseqTest):
    def first_run(self, ranks):
        """A part from a voxel file beside the config: its path must still be right from elsewhere."""
        folder = os.path.join(self.directory, "elsewhere")
        os.mkdir(folder)
        config = plate_2d()
        write_voxels(os.path.join(folder, "part.h5"), part_density(config))
        config["part"] = {"voxels": {"file": "part.h5", "threshold": 0.5}}
        path = self.write_config(config, os.path.join("elsewhere", "case.json"))
        run = self.run_program(ranks, "-config", path, "-max_iterations", ITERATIONS, "-alpha", 0.3,
                               "-set", "projection.interval=2")
        self.assert_done(run)
        return run

    def rerun(self, ranks, first):
        run = self.run_program(ranks, "-config", first.path("config.json"))
        self.assert_done(run)
        effective, again = first.json("config.json"), run.json("config.json")
        self.assertIn("-alpha 0.3", effective["run"]["command_line"])
        self.assertEqual(effective["run"]["ranks"], ranks)
        del effective["run"], again["run"]
        self.assertEqual(effective, again)
        self.assertEqual(effective["objective"][1]["weight"], 0.3)
        self.assertEqual(effective["optimizer"]["max_iterations"], ITERATIONS)
        self.assertTrue(os.path.isabs(effective["part"]["voxels"]["file"]))
        return run

    def test_config_runs_again_to_the_same_result(self):
        first = self.first_run(1)
        again = self.rerun(1, first)
        self.assertEqual(scalar_history(again), scalar_history(first))
        expected = read_result(first)
        for name, values in read_result(again).items():
            np.testing.assert_array_equal(values, expected[name], err_msg=name)
        self.assertEqual(again.json("summary.json")["optimized"], first.json("summary.json")["optimized"])

    def test_config_runs_again_on_two_ranks(self):
        first = self.first_run(2)
        again = self.rerun(2, first)
        for line, expected in zip(scalar_history(again), scalar_history(first), strict=True):
            for key in ("objective", "objective_scaled", "constraints", "change", "beta"):
                self.assertLess(largest_relative_difference(line[key], expected[key]), 1e-8, key)

    def test_overwrite_leaves_nothing_of_the_old_run(self):
        output = os.path.join(self.directory, "kept")
        first = self.run_config(2, plate_2d(), "-max_iterations", 3, "-output_every", 1, "-checkpoint_every", 1,
                                output=output)
        self.assert_done(first)
        with open(os.path.join(output, "notes.txt"), "w", encoding="utf-8") as file:
            file.write("mine\n")
        second = self.run_config(2, plate_2d(), "-max_iterations", 2, "-output_every", 2, "-overwrite", output=output)
        self.assert_done(second)
        self.assertEqual(len(second.history()), 2)
        self.assertEqual(sorted(os.listdir(second.path("fields"))), ["iteration_0002.bin", "iteration_0002.xdmf"])
        self.assertFalse(os.path.exists(second.path("checkpoint")))
        self.assertTrue(os.path.exists(second.path("notes.txt")), "-overwrite has removed a file that is not fabseq's")

    def test_overwrite_by_another_task(self):
        output = os.path.join(self.directory, "kept")
        expected = {"check_gradients": {"gradient_check.csv", "gradient_check.json", "gradient_check.svg"},
                    "evaluate": {"evaluation.json", "gradients.h5"},
                    "simulate": {"result.h5", "result.xdmf", "summary.json"}}
        for task, names in expected.items():
            run = self.run_config(2, plate_2d(), "-elements", "8,5", "-task", task, "-overwrite", output=output)
            self.assert_done(run)
            self.assertEqual(set(os.listdir(output)), names | {"config.json"}, task)

    def test_default_output_directory(self):
        run = self.run_config(1, plate_2d(), "-max_iterations", 1, output="")
        self.assert_done(run)
        self.assertTrue(os.path.exists(os.path.join(self.directory, "output", "plate", "summary.json")))


class SimulateOutputTest(FabseqTest):
    def check_simulation(self, config, ranks):
        dimension = len(config["domain"]["size"])
        layers = config["layers"]["count"]
        density = part_density(config)
        nodes = tuple(n + 1 for n in density.shape)
        run = self.run_config(ranks, config, "-task", "simulate", "-stages")
        self.assert_done(run)
        data = read_result(run)
        self.assertEqual(data["stages/displacement"].shape, (layers, *nodes, dimension))
        self.assertEqual(data["stages/displacement"].dtype, np.float32)
        self.assertEqual(data["displacement"].shape, (*nodes, dimension))
        self.assertEqual(data["release_displacement"].shape, (*nodes, dimension))
        self.assertEqual(data["residual_stress"].shape, (*density.shape, 3 if dimension == 2 else 6))
        assert_close(data["stages/displacement"][-1], data["displacement"], 1e-6, "last stage")
        increments = np.diff(data["stages/displacement"].astype(float), axis=0, prepend=0)
        norms = np.sqrt((increments**2).reshape(layers, -1).sum(1))
        np.testing.assert_allclose(data["layer_displacement_norms"], norms, rtol=1e-5)
        self.assertTrue(np.all(data["residual_stress"][density == 0] == 0))
        summary = run.json("summary.json")
        np.testing.assert_allclose(summary["layer_displacement_norms"], data["layer_displacement_norms"], rtol=1e-14)
        components = {"layer_thickness": layers, "deposition_speed": layers - 1}
        constraints = sum(components[entry["type"]] for entry in config["constraints"])
        self.assertEqual(len(summary["responses"]), len(config["objective"]) + constraints)
        self.assertEqual(len(summary["layers"]), layers)
        return data

    def test_simulate(self):
        for config in (plate_2d(), hook_3d()):
            one, two = (self.check_simulation(config, ranks) for ranks in (1, 2))
            for name, values in one.items():
                assert_close(two[name], values, 1e-4, name)  # of two solutions with tolerance 1e-6

    def test_sequence_of_a_result_can_be_simulated_again(self):
        """The time of an optimized sequence, read from its result.h5, gives the optimized sequence's displacement."""
        config = plate_2d()
        first = self.run_config(2, config, "-max_iterations", 2, "-tolerance", "1e-10")
        self.assert_done(first)
        config["sequence"] = {"type": "file", "file": first.path("result.h5"), "dataset": "time"}
        config["objective"], config["constraints"] = config["objective"][:1], []
        config["projection"] = {"binary": True}
        again = self.run_config(2, config, "-task", "simulate", "-tolerance", "1e-10")
        self.assert_done(again)
        expected, found = read_result(first), read_result(again)
        np.testing.assert_array_equal(found["layer"], expected["layer"])
        assert_close(found["displacement"], expected["binary/displacement"], 1e-7, "displacement")

    def test_stages_are_not_written_unasked(self):
        run = self.run_config(1, plate_2d(), "-task", "simulate")
        self.assert_done(run)
        self.assertFalse([name for name in read_result(run) if name.startswith("stages")])


if __name__ == "__main__":
    run_fabseq.main()
