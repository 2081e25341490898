# SPDX-License-Identifier: MIT
"""Guided sequences: defaults, refusals, ranks and groups, coarse grids, restarts, plates and substrate."""

import itertools
import os

import h5py
import numpy as np

import run_fabseq
from compare_runs import assert_same_run
from run_fabseq import BAD_INPUT, FabseqTest, STOPPED, distinct, largest_relative_difference
from small_parts import hook_3d, plate_2d, post_on_substrate

TOOL = {"profile": [[0.1, 0.05], [0.5, 0.3]], "max_tilt": 50, "thickness": [0.7, 1.5]}


def guided(config, **keys):
    config["sequence"] = {"type": "guided", **keys}
    return config


def without_uniformity(config, **keys):
    """Its first value, by which it is scaled, is nearly 0."""
    config["objective"] = [term for term in config["objective"] if term["type"] != "layer_uniformity"]
    return guided(config, **keys)


class GuidedTest(FabseqTest):
    def evaluated(self, config, *options):
        """Values, and the shape of a gradient."""
        run = self.run_config(1, config, "-task", "evaluate", *options)
        self.assert_done(run)
        with h5py.File(run.path("gradients.h5"), "r") as file:
            return [response["value"] for response in run.json("evaluation.json")["responses"]], file["objective_0/design"].shape

    def test_defaults_follow_from_tool_target_and_grid(self):
        """What is left out does the same as the value that it stands for."""
        lengths = {"filter_radius": 0.2, "characteristic_length": 1.2}  # 4 layers of 0.3, elements of 0.1
        given = guided(plate_2d(), max_tilt=60, stretch="none", void=1e-4, initial="distance", **lengths)
        self.assertEqual(self.evaluated(guided(plate_2d())), self.evaluated(given))
        self.assertEqual(self.evaluated(given)[1], (12, 20))

        config, given = guided(plate_2d()), guided(plate_2d(), max_tilt=50, stretch=[0.7, 1.5], **lengths)
        for one in (config, given):
            one["tool"] = TOOL
        self.assertEqual(self.evaluated(config), self.evaluated(given))
        self.assertEqual(self.evaluated(config)[1], (12, 20, 2))
        config["sequence"]["stretch"] = "none"
        self.assertEqual(self.evaluated(config)[1], (12, 20))
        # Of the other sections.
        first, last = ("-set", "optimizer.move_limit=0.03"), ("-set", "optimizer.final_move_limit=0.003")
        histories = [self.run_config(1, without_uniformity(plate_2d()), "-max_iterations", 3, *options).history()
                     for options in ((), first + last)]
        self.assertEqual(*([line["objective"] for line in history] for history in histories))

    def test_without_a_target_the_height_is_the_length(self):
        config = guided(plate_2d())
        config["constraints"], config["part"] = [], {"box": {"min": [0, 0], "max": [2, 1.2]}}
        given = {**config, "sequence": {"type": "guided", "characteristic_length": 1.2}}
        for one, other in zip(self.evaluated(config)[0], self.evaluated(given)[0], strict=True):
            self.assertAlmostEqual(one, other, delta=1e-9 * abs(other))

    def test_the_design_keeps_to_its_bounds(self):
        """The tool's tilt, or 60 degrees beside a tool that may tilt further than layers can."""
        for tilt, bound in ((50, 50.0), (90, 60.0)):
            config = without_uniformity(hook_3d(), stretch=[0.9, 1.2])
            config["tool"] = {"max_tilt": tilt}
            run = self.run_config(2, config, "-max_iterations", 4, "-move_limit", 1)
            self.assert_done(run)
            with h5py.File(run.path("result.h5"), "r") as file:
                design = file["design"][()]
                time, nodal = file["time"][()], file["nodal_time"][()]
                part = file["density"][()] > 0
            self.assertLess(np.degrees(np.abs(design[..., :2]).max()), bound * (1 + 1e-12))
            self.assertGreater(np.degrees(np.abs(design[..., :2]).max()), 0.9 * bound)
            self.assertLess(np.exp(design[..., 2]).max(), 1.2 * (1 + 1e-12))
            self.assertGreater(np.exp(design[..., 2]).min(), 0.9 * (1 - 1e-12))
            corners = [nodal[tuple(slice(c, c + n) for c, n in zip(corner, time.shape))] for corner in np.ndindex(2, 2, 2)]
            np.testing.assert_allclose(time[part], np.mean(corners, 0)[part], atol=1e-12)

    def test_upright_directions_are_planar_layers(self):
        for plate, height in (("y-", 1.2), ("y+", 1.2), ("x-", 2.0), ("x+", 2.0)):
            with self.subTest(plate=plate):
                config = guided(plate_2d(), initial="planar", void=1e-7, characteristic_length=height)
                config["constraints"], config["build_plate"] = [], plate
                run = self.run_config(2, config, "-task", "simulate")
                self.assert_done(run)
                with h5py.File(run.path("result.h5"), "r") as file:
                    time, part = file["time"][()], file["density"][()] > 0
                    axis = 1 if plate[0] == "x" else 0
                    place = (np.arange(time.shape[axis]) + 0.5) / time.shape[axis]
                    place = place if plate[1] == "-" else place[::-1]
                    expected = np.broadcast_to(place if axis == 1 else place[:, None], time.shape)
                    np.testing.assert_allclose(time[part], expected[part], atol=1e-4)

    def test_refusals(self):
        def refused(config):
            run = self.run_config(1, config, "-task", "evaluate")
            self.assertEqual(run.status, BAD_INPUT, str(run))
            return run.messages()[0]
        for keys, words in (({"stretch": [1.1, 2]}, "/sequence/stretch: found [1.1,2]; allowed: two ascending numbers"),
                            ({"stretch": [2, 0.5]}, "/sequence/stretch: found [2,0.5]; allowed: "),
                            ({"max_tilt": 95}, "/sequence/max_tilt: found 95; allowed: "),
                            ({"initial": [0, 0]}, "/sequence/initial: found [0,0]; allowed: "),
                            ({"initial": [1, 0.1]}, "/sequence/initial: found [1.0,0.1]; allowed: a direction "),
                            ({"initial": [0, -1]}, "/sequence/initial: found [0.0,-1.0]; allowed: a direction "),
                            ({"drain": 1}, "/sequence/drain: unknown key for type \"guided\"")):
            with self.subTest(keys=keys):
                self.assertIn(words, refused(guided(plate_2d(), **keys)))

    def test_ranks_and_groups(self):
        """In 2D and 3D, on every kind of plate face and on a substrate, by both paths."""
        tall = guided(hook_3d(), stretch=[0.6, 1.6], initial=[0.3, 0, 1])
        upper = guided(plate_2d(), filter_radius=0.25)
        upper["build_plate"] = "x+"
        standing = guided(post_on_substrate(3), stretch=[0.6, 1.6])
        for name, config in (("tall", tall), ("upper", upper), ("standing", standing)):
            config["solver"] = {"reference_method": "direct"}
            reference = self.run_config(1, config, "-task", "evaluate", "-tolerance", "1e-11", "-solver_path", "reference")
            self.assert_done(reference)
            splits = [(1, 1), (2, 1), (2, 2), (3, 1), (4, 2)]
            for ranks, groups in distinct(*splits):
                with self.subTest(case=name, ranks=ranks, groups=groups):
                    run = self.run_config(ranks, config, "-task", "evaluate", "-tolerance", "1e-11", "-layer_groups", groups)
                    self.assert_done(run)
                    self.assert_same_evaluation(run, reference)

    def assert_same_evaluation(self, run, reference):
        found, expected = (one.json("evaluation.json")["responses"] for one in (run, reference))
        for one, other in zip(found, expected, strict=True):
            self.assertLess(abs(one["value"] - other["value"]), 1e-7 * abs(other["value"]) + 1e-14, one["name"])
        with h5py.File(run.path("gradients.h5"), "r") as file, h5py.File(reference.path("gradients.h5"), "r") as correct:
            for response in correct:
                gradient, values = file[response]["design"][()], correct[response]["design"][()]
                self.assertLess(np.abs(gradient - values).max(), 1e-6 * np.abs(values).max() + 1e-14, response)

    def test_derivatives_on_all_plates(self):
        for (plate, stretch), substrate in itertools.product(distinct(("z+", True), ("x-", False), ("x+", True)), (False, True)):
            config = guided(post_on_substrate(3) if substrate else hook_3d(), filter_radius=0.3)
            if substrate:
                plate = "z-"
            config["sequence"]["stretch"] = [0.6, 1.6] if stretch else "none"
            config["build_plate"] = plate
            with self.subTest(plate=plate, stretch=stretch, substrate=substrate):
                run = self.run_config(2, config, "-task", "check_gradients")
                self.assert_done(run)
                for entry in run.json("gradient_check.json")["components"]:
                    self.assertLess(entry["best"], 1e-5, entry)

    def test_a_coarse_grid_first(self):
        config = without_uniformity(hook_3d(), stretch=[0.6, 1.6])
        run = self.run_config(2, config, "-max_iterations", 2, "-coarse_iterations", 3)
        self.assert_done(run)
        sequence = run.json("coarse/config.json")["sequence"]
        self.assertAlmostEqual(sequence["filter_radius"], 0.4)  # of the fine grid
        with h5py.File(run.path("coarse/result.h5"), "r") as coarse, h5py.File(run.path("coarse/refined.h5"), "r") as refined, \
                h5py.File(run.path("result.h5"), "r") as fine:
            parents = coarse["design"][()]
            self.assertEqual(parents.shape, (4, 2, 4, 3))
            for axis in range(3):
                parents = np.repeat(parents, 2, axis)
            there = fine["density"][()] > 0
            np.testing.assert_array_equal(refined["design"][()], np.where(there[..., None], parents, 0.0))
        for line in run.history():
            self.assertEqual(len(line["solver_iterations"]["heat"]), 1 + 6)  # time, objective, three thicknesses, two speeds

    def test_restart(self):
        config = without_uniformity(hook_3d(), stretch=[0.6, 1.6])
        arguments = ("-max_iterations", 4, "-checkpoint_every", 2, "-output_every", 2)
        # The systems of the reference path last until a checkpoint.
        for ranks, path, cut in distinct((2, "lanes", 3), (1, "lanes", 1), (1, "reference", 2)):
            arguments = (*arguments[:6], "-solver_path", path)
            expected = self.run_config(ranks, config, *arguments)
            self.assert_done(expected)
            output = os.path.join(self.directory, f"cut_{ranks}_{path}")
            os.makedirs(output)
            with open(os.path.join(output, "stop"), "w", encoding="utf-8") as file:
                file.write(str(cut))
            run = self.run_config(ranks, config, *arguments, output=output)
            self.assertEqual(run.status, STOPPED, str(run))
            run = self.run_config(ranks, config, *arguments, "-restart", "auto", output=output)
            self.assert_done(run)
            assert_same_run(self, run, expected, ranks)

    def test_a_result_is_a_start(self):
        config = without_uniformity(hook_3d())
        first = self.run_config(2, config, "-max_iterations", 2)
        self.assert_done(first)
        again = self.run_config(1, config, "-task", "evaluate", "-design", first.path("result.h5"))
        self.assert_done(again)
        with h5py.File(first.path("result.h5"), "r") as file:
            value = file.attrs["optimized/objective_0"]
        self.assertLess(largest_relative_difference(again.json("evaluation.json")["responses"][0]["value"], value), 1e-4)
        for shape in ((8, 4, 8, 2), (512,)):  # as a list, too
            design = os.path.join(self.directory, "list.h5")
            with h5py.File(first.path("result.h5"), "r") as file, h5py.File(design, "w") as copy:
                copy["design"] = file["design"][()].reshape(shape)
            same = self.run_config(1, config, "-task", "evaluate", "-design", design)
            self.assertEqual(*([one["value"] for one in run.json("evaluation.json")["responses"]] for run in (same, again)))
        refused = self.run_config(1, config, "-task", "evaluate", "-design", first.path("result.h5"), "-set",
                                  "sequence.stretch=[0.9, 1.1]")
        self.assertEqual(refused.status, BAD_INPUT)
        self.assertIn("-design: ", refused.messages()[0])


if __name__ == "__main__":
    run_fabseq.main()
