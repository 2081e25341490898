# SPDX-License-Identifier: MIT
"""Optimizations that begin at half or a quarter of the resolution."""

import os

import h5py
import numpy as np

import run_fabseq
from compare_runs import assert_same_run
from run_fabseq import BAD_INPUT, STOPPED, FabseqTest, largest_relative_difference
from small_parts import direct_2d, hook_3d, plate_2d, post_on_substrate, write_voxels

OPTIONS = ("-max_iterations", 3, "-coarse_iterations", 4, "-set", "projection.interval=2", "-checkpoint_every", 1)


def odd_plate():
    """Odd numbers of elements, a wall of one element, and a node set between nodes of the coarse grid."""
    config = plate_2d()
    config["domain"] = {"size": [2.1, 1.3], "elements": [21, 13]}
    config["part"] = {"union": [{"box": {"min": [0, 0], "max": [1.2, 1.3]}},
                                {"intersection": [{"half_space": {"point": [0, 0.9], "normal": [0, -1]}},
                                                  {"half_space": {"point": [0, 1.0], "normal": [0, 1]}}]}]}
    config["node_sets"] = {"top": {"box": {"min": [0, 1.3], "max": [1.2, 1.3]}, "samples": 5}}
    config["constraints"] = []
    return config


class CoarseTest(FabseqTest):
    def optimize(self, config, ranks, *arguments, output=None):
        run = self.run_config(ranks, config, *OPTIONS, "-tolerance", "1e-11", *arguments, output=output)
        self.assert_done(run)
        return run

    def coarse(self, run):
        return run_fabseq.Result([], 0, "", "", run.path("coarse"))

    def test_schedules_go_on(self):
        config = plate_2d()
        run, whole = self.optimize(config, 2), self.run_config(1, config, "-max_iterations", 7, "-set", "projection.interval=2")
        lines = self.coarse(run).history() + run.history()
        self.assertEqual([line["beta"] for line in lines], [line["beta"] for line in whole.history()])
        self.assertEqual([line["iteration"] for line in lines], [1, 2, 3, 4, 1, 2, 3])
        self.assertEqual(self.coarse(run).json("config.json")["domain"]["elements"], [10, 6])
        # The uniformity is scaled by the design that the fine grid would have begun with.
        first, start = run.history()[0], whole.history()[0]
        self.assertEqual(run.json("summary.json")["coarse_iterations"], 4)
        self.assertAlmostEqual(first["objective_scaled"][1] / first["objective"][1] * start["objective"][1], 100.0, places=4)

    def test_the_design_is_the_parents(self):
        run = self.optimize(odd_plate(), 3)
        with h5py.File(run.path("coarse/result.h5"), "r") as coarse, h5py.File(run.path("coarse/refined.h5"), "r") as refined, \
                h5py.File(run.path("result.h5"), "r") as fine:
            parents = np.repeat(np.repeat(coarse["design"][()], 2, 0), 2, 1)[:13, :21]
            there = fine["density"][()] > 0
            np.testing.assert_array_equal(refined["design"][()], np.where(there, parents, 0.0))
            mean = np.zeros((14, 22))
            mean[:13, :21] = fine["density"][()]
            np.testing.assert_allclose(coarse["density"][()], mean.reshape(7, 2, 11, 2).mean((1, 3)), atol=1e-14)

    def test_ranks_and_groups(self):
        reference = self.optimize(hook_3d(), 1)
        for ranks, groups in ((2, 1), (2, 2), (3, 1)):
            run = self.optimize(hook_3d(), ranks, "-layer_groups", groups)
            for line, expected in zip(run.history(), reference.history(), strict=True):
                self.assertLess(largest_relative_difference(line["objective"], expected["objective"]), 1e-6)

    def test_a_quarter_first(self):
        run = self.optimize(hook_3d(), 2, "-elements", "16,8,16", "-coarse_grids", 2, "-coarse_iterations", 5)
        folders = [run.path("coarse/coarse"), run.path("coarse"), run.output]
        counts = [len(run_fabseq.Result([], 0, "", "", folder).history()) for folder in folders]
        self.assertEqual(counts, [2, 3, 3])

    def test_the_coarse_run_can_be_repeated(self):
        """config.json of the folder is the coarse problem."""
        voxels = os.path.join(self.directory, "part.h5")
        density = np.ones((13, 21))
        density[:9, 12:] = 0.0
        write_voxels(voxels, density)
        config = odd_plate()
        config["part"] = {"voxels": {"file": voxels, "threshold": 0.5}}
        run = self.optimize(config, 2)
        again = self.run_program(2, "-config", run.path("coarse/config.json"))
        self.assert_done(again)
        self.assertEqual([line["objective"] for line in again.history()], [line["objective"]
                         for line in self.coarse(run).history()])

    def test_more_samples_than_nodes(self):
        config = plate_2d()
        config["node_sets"]["top"]["samples"] = 21
        run = self.optimize(config, 2)
        self.assertEqual(self.coarse(run).json("config.json")["node_sets"]["top"]["samples"], 0)

    def test_times_of_elements(self):
        self.optimize(direct_2d("elements"), 2)

    def test_restart_on_either_grid(self):
        expected = self.optimize(plate_2d(), 2)
        for folder, done in (("coarse", 2), ("", 1)):
            for word in ("auto", "directory"):
                with self.subTest(folder=folder, restart=word):
                    output = os.path.join(self.directory, f"cut_{folder}_{word}")
                    os.makedirs(os.path.join(output, folder))
                    with open(os.path.join(output, folder, "stop"), "w", encoding="utf-8") as file:
                        file.write(str(done))
                    cut = self.run_config(2, plate_2d(), *OPTIONS, "-tolerance", "1e-11", output=output)
                    self.assertEqual(cut.status, STOPPED, str(cut))
                    summary = cut.json("summary.json")
                    self.assertEqual((summary["status"], summary["coarse_iterations"]), ("stopped", 4))
                    run = self.optimize(plate_2d(), 2, "-restart", "auto" if word == "auto" else output + "/", output=output)
                    assert_same_run(self, run, expected, 2)
                    assert_same_run(self, self.coarse(run), self.coarse(expected), 2)

    def test_a_stop_file_of_the_run_itself(self):
        output = os.path.join(self.directory, "stopped")
        os.makedirs(output)
        with open(os.path.join(output, "stop"), "w", encoding="utf-8"):
            pass
        cut = self.run_config(2, plate_2d(), *OPTIONS, output=output)
        self.assertEqual(cut.status, STOPPED, str(cut))
        self.assertTrue(os.path.exists(cut.path("coarse/checkpoint/newest")))
        self.assertFalse(os.path.exists(cut.path("stop")))

    def test_overwrite_removes_it(self):
        run = self.optimize(plate_2d(), 1)
        self.assert_done(self.run_config(1, plate_2d(), "-max_iterations", 1, "-overwrite", output=run.output))
        self.assertFalse(os.path.exists(run.path("coarse")))

    def test_refusals(self):
        nodes, small, upper = direct_2d("nodes"), plate_2d(), odd_plate()
        small["domain"]["elements"] = [20, 3]
        upper["build_plate"] = "y+"
        for config, reason in ((nodes, "on nodes"), (small, "fewer than 4"), (upper, "build plate y+")):
            with self.subTest(reason=reason):
                run = self.run_config(2, config, *OPTIONS)
                self.assertEqual(run.status, BAD_INPUT, str(run))
                self.assertEqual(len(run.messages()), 1, str(run))
                self.assertIn("/optimizer/coarse_iterations: found 4, but ", run.messages()[0])
                self.assertIn(reason, run.messages()[0])
                self.assertFalse(os.path.exists(run.output))

    def test_elements_without_a_coarse_variable(self):
        """The substrate ends within a row of coarse elements, all of which belong to it: fine elements above
        it have no design."""
        config = post_on_substrate(2)
        config["substrate"]["box"]["max"][1], config["part"]["union"][0]["box"]["min"][1] = 0.14, 0.1
        for ranks in (1, 2):
            run = self.run_config(ranks, config, *OPTIONS)
            self.assertEqual(run.status, BAD_INPUT, str(run))
            self.assertIn(run.path("coarse/refined.h5") + " has values outside the bounds 0.001 to 1.0 of /sequence/bounds",
                          run.messages()[-1])


if __name__ == "__main__":
    run_fabseq.main()
