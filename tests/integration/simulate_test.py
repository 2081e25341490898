# SPDX-License-Identifier: MIT
"""-task simulate: stages, norms, stress and release in result.h5 fit each other, on 1 and on 2 ranks."""

import numpy as np

import run_fabseq
from read_outputs import assert_close, read_result
from run_fabseq import BAD_INPUT, FabseqTest
from small_parts import direct_2d, hook_3d, part_density, plate_2d, post_on_substrate, touched_nodes, write_voxels


def surface_normals(density, edges):
    """At each node the sum over its elements of the direction away from them, [node][axis]."""
    padded = np.pad(density, 1)
    normals = np.zeros((*(n + 1 for n in density.shape), 3))
    for before in np.ndindex(2, 2, 2):  # whether the element lies before the node, along z, y, x
        element = padded[tuple(slice(1 - side, n + 2 - side) for side, n in zip(before, density.shape))]
        normals += element[..., None] * (2 * np.array(before[::-1]) - 1)
    return normals / edges


def without_rigid_motion(displacement, places):
    """What the translation and rotation that fit best leave."""
    places = places - places.mean(0)
    motions = np.stack([motion.ravel() for axis in np.eye(3)
                        for motion in (np.broadcast_to(axis, places.shape), np.cross(axis, places))], 1)
    fit = np.linalg.lstsq(motions, displacement.ravel(), rcond=None)[0]
    return displacement - (motions @ fit).reshape(places.shape)


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
        """The time of an optimized sequence, read from its result.h5, gives the optimized sequence's
        displacement."""
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

    def test_release_from_clamps(self):
        """Extremes in summary.json are those of the fields; the sum of displacement and release is what terms
        measure."""
        for dimension in (2, 3):
            config = post_on_substrate(dimension)
            for ranks, groups in ((1, 1), (2, 1), (2, 2)):
                run = self.run_config(ranks, config, "-task", "simulate", "-layer_groups", groups)
                self.assert_done(run)
                data, summary = read_result(run), run.json("summary.json")
                part = data["density"] > 0
                self.assertFalse((part & (data["substrate"] > 0)).any())
                self.assertTrue(np.all(data["layer"][~part] == 0))
                nodes = touched_nodes(data["density"])
                released = data["released_displacement"]
                assert_close(released, data["displacement"] + data["release_displacement"], 1e-14, "released")
                for values, block in ((data["displacement"], summary), (released, summary["released"])):
                    self.assertAlmostEqual(block["displacement"]["max"] / np.linalg.norm(values[nodes], axis=1).max(), 1)
                for name, block in (("residual_stress", summary), ("released_stress", summary["released"])):
                    stress, found = data[name][part], block["residual_stress"]
                    np.testing.assert_allclose(found["lowest"], stress.min(0), rtol=1e-12)
                    np.testing.assert_allclose(found["highest"], stress.max(0), rtol=1e-12)
                    normal, shear = stress[:, :dimension], stress[:, dimension:]
                    deviator = (normal**2).sum(1) - 0.5 * ((normal.sum(1))**2 - (normal**2).sum(1))
                    self.assertAlmostEqual(found["von_mises"] / np.sqrt(deviator + 3 * (shear**2).sum(1)).max(), 1)
                    self.assertTrue(np.abs(data[name][(data["density"] == 0) & (data["substrate"] > 0)]).max() > 0)
                values = {entry["name"]: entry["value"] for entry in summary["responses"]}
                arm = np.zeros(nodes.shape, bool)
                arm[..., -1] = nodes[..., -1]
                expected = (released[arm]**2).sum(1).mean()
                self.assertAlmostEqual(values["objective_0"] / expected, 1)
                self.assertAlmostEqual(values["objective_2"] / (data["displacement"][arm]**2).sum(), 1)

    def test_skin_of_the_finished_part(self):
        """Displacement of the surface after the best rigid fit, and stock along its normals, on edges of
        which no sum is exact."""
        for edges in ((5, 5, 5), (0.7, 0.3, 1.1)):
            size, tower, foot = ([float(n * h) for n, h in zip(steps, edges)]
                                 for steps in ((4, 3, 5), (2, 3, 5), (4, 3, 3)))
            config = {"name": "angle", "domain": {"size": size, "elements": [4, 3, 5]},
                      "part": {"union": [{"box": {"min": [0, 0, 0], "max": top}} for top in (tower, foot)]},
                      "build_plate": "z-", "node_sets": {"skin": {"all": True, "surface": True}},
                      "process": {"deposition": "nominal"}, "sequence": {"type": "planar"}, "layers": {"count": 3},
                      "objective": [{"type": "distortion", "measure": "shape", "nodes": "skin"}]}
            run = self.run_config(2, config, "-task", "simulate")
            self.assert_done(run)
            data, built = read_result(run), run.json("summary.json")["finished"]["as_built"]
            away = surface_normals(data["density"], edges)
            skin = np.any(away != 0, axis=-1)
            self.assertTrue((~skin & touched_nodes(data["density"])).any())
            left = without_rigid_motion(data["displacement"][skin], np.argwhere(skin)[:, ::-1] * edges)
            self.assertAlmostEqual(built["skin"]["rms"] / np.sqrt((left**2).sum(1).mean()), 1)
            self.assertAlmostEqual(built["skin"]["max"] / np.linalg.norm(left, axis=1).max(), 1)
            along = (left * away[skin] / np.linalg.norm(away[skin], axis=1)[:, None]).sum(1)
            np.testing.assert_allclose([built["stock"]["outward"], built["stock"]["inward"]],
                                       [max(0, along.max()), max(0, -along.min())], rtol=1e-7)
            self.assertAlmostEqual(run.json("summary.json")["responses"][0]["value"] / built["skin"]["rms"]**2, 1)

    def test_planar_layers_shrink_along_themselves(self):
        """Strain that turns, for planar layers, is the constant one of their direction."""
        config = plate_2d()
        config["sequence"] = {"type": "planar", "direction": [0.6, 0.8]}
        config["material"] = {"inherent_strain": {"tangential": -0.01, "normal": 0.004}}
        turning = self.run_config(2, config, "-task", "simulate")
        xx, yy, xy = (-0.01 * (i == j) + 0.014 * n * m for i, j, n, m in
                      ((0, 0, 0.6, 0.6), (1, 1, 0.8, 0.8), (0, 1, 0.6, 0.8)))
        config["material"] = {"inherent_strain": [xx, yy, 2 * xy]}
        constant = self.run_config(1, config, "-task", "simulate")
        found, expected = read_result(turning), read_result(constant)
        for name in ("displacement", "residual_stress", "release_displacement"):
            assert_close(found[name], expected[name], 1e-5, name)

    def test_stages_are_not_written_unasked(self):
        run = self.run_config(1, plate_2d(), "-task", "simulate")
        self.assert_done(run)
        self.assertFalse([name for name in read_result(run) if name.startswith("stages")])


class ReslicingTest(FabseqTest):
    """-sequence: a result's pseudo-time, cut into any number of layers."""

    def reslice(self, first, *arguments, ranks=2):
        run = self.run_program(ranks, "-config", first.path("config.json"), "-task", "simulate",
                               "-sequence", first.path("result.h5"),
                               "-tolerance", "1e-10", *arguments)
        self.assert_done(run)
        return run

    def assert_block(self, run, block):
        """Terms that a file has, and volumes and displacements, are those of a run's summary."""
        found = run.json("summary.json")
        expected = {r["type"]: r["value"] for r in block["responses"] if r["type"] == "distortion"}
        self.assertEqual(len(expected), 1)
        for response in found["responses"]:
            self.assertNotIn(response["type"], ("layer_thickness", "layer_uniformity"))
            if response["type"] == "distortion":
                self.assertAlmostEqual(response["value"] / expected["distortion"], 1, places=7)
        np.testing.assert_allclose([layer["volume"] for layer in found["layers"]], [layer["volume"] for layer in block["layers"]],
                                   rtol=1e-9, atol=1e-12)
        for key in ("max", "rms"):
            self.assertAlmostEqual(found["displacement"][key] / block["displacement"][key], 1, places=7)

    def test_the_same_layers_give_the_same_numbers(self):
        """Also with variable time points, whose sharpness and places come from the file."""
        for config in (plate_2d(), direct_2d("elements"), direct_2d("nodes")):
            with self.subTest(config["name"]):
                first = self.run_config(2, config, "-max_iterations", 3, "-tolerance", "1e-10", "-beta_interval", 1)
                self.assert_done(first)
                summary = first.json("summary.json")
                smooth, binary = self.reslice(first), self.reslice(first, "-binary", ranks=1)
                self.assert_block(smooth, summary["optimized"])
                self.assert_block(binary, summary["binary"])
                self.assertEqual(smooth.json("config.json")["projection"]["beta"], summary["beta"])
                np.testing.assert_array_equal(read_result(binary)["layer"], read_result(first)["layer"])

    def test_more_and_fewer_layers(self):
        """Each layer of the result is cut into equal steps of time; sharpness grows with the number of
        layers."""
        first = self.run_config(2, direct_2d("elements"), "-max_iterations", 3)
        self.assert_done(first)
        result, beta = read_result(first), first.json("summary.json")["beta"]
        for count in (12, 2):
            run = self.reslice(first, "-layers", count)
            self.assertAlmostEqual(run.json("config.json")["projection"]["beta"], beta * count / 4)
            cut = read_result(run)
            np.testing.assert_array_equal(cut["time"], result["time"])
            self.assertEqual(len(run.json("summary.json")["layers"]), count)
            part = result["density"] > 0
            if count == 12:
                np.testing.assert_array_equal((cut["layer"][part] + 2) // 3, result["layer"][part])
            else:
                np.testing.assert_array_equal(cut["layer"][part], (result["layer"][part] + 1) // 2)

    def test_a_design_keeps_its_times(self):
        """The config that a run leaves says what its characteristic length came to, which follows from the
        layers: with it, the design means the same times in any layers."""
        config = plate_2d()
        config["sequence"] = {"type": "heat"}
        first = self.run_config(2, config, "-max_iterations", 2, "-tolerance", "1e-10")
        self.assert_done(first)
        self.assertAlmostEqual(first.json("config.json")["sequence"]["characteristic_length"], 4 * 0.3, places=12)
        design = ("-task", "simulate", "-design", first.path("result.h5"), "-layers", 7, "-tolerance", "1e-10")
        kept = self.run_program(1, "-config", first.path("config.json"), *design)
        derived = self.run_config(1, config, *design)
        self.assert_done(kept)
        self.assert_done(derived)
        expected = read_result(first)["time"]
        assert_close(read_result(kept)["time"], expected, 1e-8, "time")
        self.assertGreater(np.abs(read_result(derived)["time"] - expected).max(), 0.01)

    def test_a_time_of_ones_own(self):
        """A file without a word about layers: those of the config, with its sharpness; terms it cannot have
        are named."""
        config = plate_2d()
        density = part_density(config)
        time = np.broadcast_to((np.arange(12) + 0.5)[:, None] / 12, density.shape)
        path = self.directory + "/mine.h5"
        write_voxels(path, time, dataset="time")
        given = self.run_config(1, config, "-task", "simulate", "-sequence", path, "-binary")
        self.assert_done(given)
        self.assertEqual(len(given.messages()), 2, str(given))
        for words in ("/objective/1 (layer_uniformity) is left out", "/constraints/0 (layer_thickness) is left out"):
            self.assertIn(words, given.stderr)
        config["sequence"] = {"type": "planar"}
        planar = self.run_config(1, config, "-task", "simulate")
        self.assert_done(planar)
        assert_close(read_result(given)["displacement"], read_result(planar)["displacement"], 1e-9, "displacement")
        config = plate_2d() | {"constraints": [{"type": "tool_clearance"}], "tool": {"profile": [[1, 0.1], [30, 1]]}}
        for axis, messages in (({}, 2), ({"axis": [0, 1]}, 1)):
            tool = {"tool": config["tool"] | axis}
            torch = self.run_config(1, config | tool, "-task", "simulate", "-sequence", path, "-binary")
            self.assert_done(torch)
            self.assertEqual(len(torch.messages()), messages, str(torch))
        smooth = self.run_config(1, plate_2d(), "-task", "simulate", "-sequence", path, "-layers", 6)
        self.assertEqual(smooth.json("config.json")["projection"]["beta"], "auto")

    def test_refusals(self):
        path = self.write_config(plate_2d())
        for arguments, word in ((("-sequence", "none.h5"), "/sequence/file"), (("-sequence",), "missing value"),
                                (("-sequence", path), "not an HDF5 file"),
                                (("-sequence", "a.h5", "-design", "a.h5"), "one of the two")):
            run = self.run_program(2, "-config", path, "-task", "simulate", *arguments)
            self.assertEqual(run.status, BAD_INPUT, str(run))
            self.assertIn(word, run.messages()[-1])
        run = self.run_program(2, "-config", path, "-sequence", "a.h5")
        self.assertEqual(run.status, BAD_INPUT, str(run))
        self.assertIn("with -task simulate", run.messages()[0])


if __name__ == "__main__":
    run_fabseq.main()
