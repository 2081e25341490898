"""-task simulate: stages, norms, stress and release in result.h5 fit each other, on 1 and on 2 ranks."""

import numpy as np

import run_fabseq
from read_outputs import assert_close, read_result
from run_fabseq import FabseqTest
from small_parts import hook_3d, part_density, plate_2d


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
