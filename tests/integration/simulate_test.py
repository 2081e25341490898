"""-task simulate: stages, norms, stress and release in result.h5 fit each other, on 1 and on 2 ranks."""

import numpy as np

import run_fabseq
from read_outputs import assert_close, read_result
from run_fabseq import FabseqTest
from small_parts import hook_3d, part_density, plate_2d, post_on_substrate, touched_nodes


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

    def test_release_from_clamps(self):
        """Extremes in summary.json are those of the fields; the sum of displacement and release is what terms measure."""
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
                released = data["displacement"] + data["release_displacement"]
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


if __name__ == "__main__":
    run_fabseq.main()
