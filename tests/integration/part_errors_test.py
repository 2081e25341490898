# SPDX-License-Identifier: MIT
"""Parts, node sets and files that do not go with the config: status 2 on every rank, one line with the key,
what was found and what is allowed, nothing written."""

import os
import time

import h5py
import numpy as np

import run_fabseq
from bad_input_case import BadInputTest
from small_parts import hook_3d, plate_2d, post_on_substrate, write_voxels


class PartErrorsTest(BadInputTest):
    rank_counts = (3,)  # on one rank everybody says the same

    def test_empty_part(self):
        config = plate_2d()
        config["part"] = {"box": {"min": [3, 3], "max": [4, 4]}}
        self.assert_refused(config, words=["/part", "no element"])

    def hanging_blocks(self):
        """A wall, a block of 4 x 2 elements 0.3 above the plate and one element in the air."""
        config = plate_2d()
        config["part"] = {"union": [{"box": {"min": [0, 0], "max": [1.0, 1.2]}},
                                    {"box": {"min": [1.4, 0.3], "max": [1.8, 0.5]}},
                                    {"box": {"min": [1.2, 0.8], "max": [1.3, 0.9]}}]}
        return config

    def test_hanging_pieces_are_listed(self):
        self.assert_refused(self.hanging_blocks(), words=["/part", "2 pieces", "8 elements in [1.4,0.3]..[1.8,0.5]",
                                                          "1 element in [1.2,0.8]..[1.3,0.9]", "part.keep"])

    def test_hanging_pieces_are_dropped_with_a_warning(self):
        config = self.hanging_blocks()
        config["part"]["keep"] = "connected"
        for ranks in self.rank_counts:
            result = self.run_config(ranks, config, "-max_iterations", 1)
            self.assert_done(result)
            messages = result.messages()
            self.assertEqual(len(messages), 1, str(result))
            self.assertTrue(messages[0].startswith("warning: /part: 2 pieces"), str(result))
            self.assertEqual(result.json("summary.json")["part_elements"], 120)

    def test_pieces_that_touch_at_an_edge_only_are_not_connected(self):
        config = hook_3d()
        config["part"] = {"union": [{"box": {"min": [0, 0, 0], "max": [0.8, 0.8, 0.8]}},
                                    {"box": {"min": [0.8, 0, 0.8], "max": [1.6, 0.8, 1.6]}}]}
        self.assert_refused(config, words=["/part", "1 piece", "64 elements in [0.8,0,0.8]..[1.6,0.8,1.6]"])

    def test_no_contact_with_the_plate(self):
        config = plate_2d()
        config["part"] = {"box": {"min": [0, 0.3], "max": [2, 1.2]}}
        self.assert_refused(config, words=["/build_plate", "y-", "180 elements in [0,0.3]..[2,1.2]"])

    def test_node_set_without_nodes(self):
        config = plate_2d()
        config["node_sets"]["far"] = {"box": {"min": [5, 5], "max": [6, 6]}}
        self.assert_refused(config, words=["/node_sets/far", "no node"])

    def test_more_samples_than_nodes(self):
        config = plate_2d()
        config["node_sets"]["top"]["samples"] = 500
        self.assert_refused(config, words=["/node_sets/top/samples", "500", "21"])

    def test_too_large_for_the_indices(self):
        """Also where the nodes can be counted and only the components of their displacements cannot."""
        for edge in (100000, 1000):
            config = hook_3d()
            config["domain"]["elements"] = [edge] * 3
            start = time.monotonic()
            self.assert_refused(config, words=["/domain/elements", f"[{edge},{edge},{edge}]"], timeout=60)
            self.assertLess(time.monotonic() - start, 60)

    def test_substrate_and_clamps(self):
        config = post_on_substrate(2)
        config["substrate"] = {"box": {"min": [5, 5], "max": [6, 6]}}
        self.assert_refused(config, words=["/substrate", "no element"])
        config = post_on_substrate(2)
        config["clamps"] = {"box": {"min": [0, 0.9], "max": [0.1, 1.2]}}
        self.assert_refused(config, words=["/clamps", "no node of part or substrate"])
        for task in ("optimize", "simulate", "check"):
            config["clamps"] = {"box": {"min": [0, 0], "max": [0, 0]}}
            self.assert_refused(config, "-task", task, words=["/clamps", "rigid motion"])
        config = post_on_substrate(2)
        config["part"] = {"box": {"min": [0.4, 0.6], "max": [1.0, 1.2]}}
        self.assert_refused(config, words=["/build_plate", "substrate"])

    def test_release_of_pieces_that_only_the_plate_holds(self):
        config = plate_2d()
        config["part"] = {"union": [{"box": {"min": [0, 0], "max": [0.5, 1.2]}}, {"box": {"min": [1, 0], "max": [2, 1.2]}}]}
        config["objective"][0]["after_release"] = True
        for task in ("optimize", "evaluate", "check"):
            self.assert_refused(config, "-task", task, words=["/objective/0/after_release", "2 pieces"])
        config["objective"][0]["after_release"] = False
        run = self.run_config(2, config, "-task", "simulate")
        self.assert_done(run)
        self.assertIn("2 pieces", run.messages()[0])
        with h5py.File(run.path("result.h5"), "r") as file:
            self.assertNotIn("release_displacement", file)
            self.assertNotIn("released_displacement", file)

    def test_strain_that_turns_with_a_time_from_a_file(self):
        config = plate_2d()
        write_voxels(os.path.join(self.directory, "time.h5"), np.full((12, 20), 0.5), dataset="time")
        config["sequence"] = {"type": "file", "file": "time.h5"}
        config["objective"], config["constraints"] = config["objective"][:1], []
        config["material"] = {"inherent_strain": {"tangential": -0.01, "normal": 0}}
        self.assert_refused(config, "-task", "simulate", words=["/material/inherent_strain", "file"])


class FileErrorsTest(BadInputTest):
    rank_counts = (3,)

    def voxel_config(self, **voxels):
        config = plate_2d()
        config["part"] = {"voxels": {"file": "part.h5", **voxels}}
        return config

    def write_part(self, density, **options):
        write_voxels(os.path.join(self.directory, "part.h5"), density, **options)

    def test_missing_voxel_file(self):
        self.assert_refused(self.voxel_config(), words=["/part/voxels/file", "part.h5", "No such file"])

    def test_voxel_file_that_is_no_hdf5(self):
        with open(os.path.join(self.directory, "part.h5"), "w", encoding="utf-8") as file:
            file.write("solid part\n")
        self.assert_refused(self.voxel_config(), words=["/part/voxels/file", "part.h5"])

    def test_missing_voxel_dataset(self):
        self.write_part(np.ones((12, 20)))
        self.assert_refused(self.voxel_config(dataset="rho"), words=["/part/voxels/dataset", "rho"])

    def test_wrong_voxel_shape(self):
        self.write_part(np.ones((20, 12)))
        self.assert_refused(self.voxel_config(), words=["/part/voxels/dataset", "20", "12"])
        self.write_part(np.ones((3, 12, 20)))
        self.assert_refused(self.voxel_config(), words=["/part/voxels/dataset"])

    def test_voxels_that_are_no_densities(self):
        density = np.ones((12, 20))
        density[3, 4] = np.nan
        self.write_part(density)
        self.assert_refused(self.voxel_config(), words=["/part/voxels/dataset", "1 value"])
        density[3, 4] = 1.5
        self.write_part(density)
        self.assert_refused(self.voxel_config(), words=["/part/voxels/dataset", "1.5"])

    def test_values_outside_the_dataset(self):
        """Of a pipe nobody would ever see the end."""
        os.mkfifo(os.path.join(self.directory, "pipe"))
        with h5py.File(os.path.join(self.directory, "part.h5"), "w") as file:
            file.create_dataset("density", (12, 20), "u1", external=[("pipe", 0, 240)])
        self.assert_refused(self.voxel_config(), words=["/part/voxels/dataset", "external files"], timeout=60)
        layout = h5py.VirtualLayout((12, 20), "u1")
        layout[...] = h5py.VirtualSource("other.h5", "density", (12, 20))
        with h5py.File(os.path.join(self.directory, "part.h5"), "w") as file:
            file.create_virtual_dataset("density", layout)
        self.assert_refused(self.voxel_config(), words=["/part/voxels/dataset", "is virtual"])

    def test_empty_voxel_part(self):
        self.write_part(np.full((12, 20), 0.3))
        self.assert_refused(self.voxel_config(threshold=0.5), words=["/part", "no element", "threshold"])

    def test_design_file(self):
        evaluate = ("-task", "evaluate", "-design", "design.h5")
        self.assert_refused(plate_2d(), *evaluate, words=["-design", "design.h5"])
        path = os.path.join(self.directory, "design.h5")
        write_voxels(path, np.ones((3, 3)), dataset="design")
        self.assert_refused(plate_2d(), *evaluate, words=["-design: dataset 'design'", "[3,3]", "[12,20]"])
        write_voxels(path, np.full((12, 20), 7.0), dataset="design")
        self.assert_refused(plate_2d(), *evaluate, words=["-design", "/sequence/bounds"])

    def test_file_without_a_design(self):
        """Then the initial values count, as without the option."""
        write_voxels(os.path.join(self.directory, "design.h5"), np.ones((3, 3)))
        for ranks in self.rank_counts:
            expected = self.run_config(ranks, plate_2d(), "-task", "evaluate")
            result = self.run_config(ranks, plate_2d(), "-task", "evaluate", "-design", "design.h5")
            self.assert_done(result)
            self.assertEqual(len(result.messages()), 1, str(result))
            self.assertIn("-design: 'design.h5' has no dataset 'design'", result.messages()[0])
            self.assertEqual(result.json("evaluation.json")["responses"], expected.json("evaluation.json")["responses"])

    def test_time_file(self):
        config = plate_2d()
        config["sequence"] = {"type": "file", "file": "time.h5"}
        del config["objective"][1], config["constraints"]
        self.assert_refused(config, "-task", "simulate", words=["/sequence/file", "time.h5"])
        write_voxels(os.path.join(self.directory, "time.h5"), np.full((12, 20), -3.0), dataset="time")
        self.assert_refused(config, "-task", "simulate", words=["/sequence", "time.h5"])


if __name__ == "__main__":
    run_fabseq.main()
