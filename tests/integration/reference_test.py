# SPDX-License-Identifier: MIT
"""Values, gradients and fields of the cases in tests/data/reference against those of an independent
implementation."""

import json
import os

import h5py
import numpy as np

import run_fabseq
from run_fabseq import FabseqTest, REFERENCE_DATA, SANITIZED

VALUE_LIMIT, FIELD_LIMIT, GRADIENT_LIMIT = 1e-5, 1e-5, 1e-4
RANK_COUNTS = (3,) if SANITIZED else (1, 4)


def without_rigid_motion(displacement, positions):
    """A displacement field less its least-squares rigid-body motion."""
    dimension = positions.shape[1]
    modes = [np.tile(axis, (len(positions), 1)) for axis in np.eye(dimension)]
    for a in range(dimension):
        for b in range(a):
            rotation = np.zeros_like(positions)
            rotation[:, a], rotation[:, b] = -positions[:, b], positions[:, a]
            modes.append(rotation)
    modes = np.stack([mode.ravel() for mode in modes], 1)
    motion, *_ = np.linalg.lstsq(modes, displacement.ravel(), rcond=None)
    return displacement - (modes @ motion).reshape(displacement.shape)


def node_positions(config):
    """Of all nodes, x fastest."""
    axes = [np.linspace(0, edge, n + 1) for edge, n in zip(config["domain"]["size"], config["domain"]["elements"])]
    return np.stack([grid.ravel() for grid in np.meshgrid(*axes[::-1], indexing="ij")[::-1]], 1)


class ReferenceTest(FabseqTest):
    def run_case(self, name, ranks, task=None):
        with open(os.path.join(REFERENCE_DATA, "expected", name + ".json"), encoding="utf-8") as file:
            expected = json.load(file)
        case = os.path.join(REFERENCE_DATA, "cases", name)
        options = ["-design", case + ".design.h5"] if os.path.exists(case + ".design.h5") else []
        with open(case + ".json", encoding="utf-8") as file:
            if "deposition" not in json.load(file).get("process", {}):
                options += ["-deposition", "follow"]  # older than the choice
        run = self.run_program(ranks, "-config", case + ".json", "-task", task or expected["task"], "-tolerance", "1e-10",
                               *options)
        self.assert_done(run)
        return run, expected

    def check_values(self, found, expected):
        values = {entry["name"]: entry for entry in found["responses"]}
        # Component N of deposition_speed is 0 by definition and may be left out.
        wanted = [entry for entry in expected["responses"]
                  if entry["type"] != "deposition_speed" or entry["value"] != 0]
        self.assertEqual(set(values) - {entry["name"] for entry in expected["responses"]}, set())
        for entry in wanted:
            self.assertEqual(values[entry["name"]]["type"], entry["type"])
            error = abs(values[entry["name"]]["value"] - entry["value"]) / entry["scale"]
            self.assertLess(error, VALUE_LIMIT, entry["name"])
        if "stages" in expected:
            return self.check_slabs(found, expected)
        self.assertEqual(len(found["layers"]), len(expected["layers"]))
        mean = np.mean([layer["volume"] for layer in expected["layers"]])
        for layer, reference in zip(found["layers"], expected["layers"], strict=True):
            self.assertLess(abs(layer["volume"] - reference["volume"]), VALUE_LIMIT * mean)
            self.assertLess(abs(layer["thickness"] - reference["thickness"]), VALUE_LIMIT * reference["thickness"])
            self.assertLess(abs(layer["cv"] - reference["cv"]), VALUE_LIMIT * max(reference["cv"], 1e-2))

    def check_slabs(self, found, expected):
        """Volumes of multi-planar layers; those that are left out have next to none."""
        volumes = {(layer["subpart"], layer["slab"]): layer["volume"] for layer in found["layers"]}
        total = sum(layer["volume"] for layer in expected["layers"])
        for place, layer in zip(expected["stages"], expected["layers"], strict=True):
            self.assertLess(abs(volumes.pop(tuple(place), 0.0) - layer["volume"]), VALUE_LIMIT * total, place)
        self.assertEqual(volumes, {})

    def check_gradients(self, name, run, expected):
        with h5py.File(os.path.join(REFERENCE_DATA, "expected", name + ".h5"), "r") as reference, \
                h5py.File(run.path("gradients.h5"), "r") as found:
            for entry in expected["responses"]:
                for kind, values in reference["gradients/" + entry["name"]].items():
                    variable = reference["variables/" + kind][()].ravel().astype(bool)
                    correct = values[()].ravel()
                    if entry["name"] not in found:
                        self.assertFalse(correct.any(), entry["name"])
                        continue
                    gradient = found[f"{entry['name']}/{kind}"][()].ravel()
                    self.assertEqual(gradient.size, correct.size)
                    self.assertFalse(gradient[~variable].any(), f"{entry['name']}: not 0 where nothing is variable")
                    size = np.abs(correct).max()
                    error = np.abs(gradient - correct)[variable].max() / size if size > 0 else np.abs(gradient).max()
                    self.assertLess(error, GRADIENT_LIMIT, f"{entry['name']}/{kind}")

    def check_fields(self, name, run, more=()):
        with open(run.path("config.json"), encoding="utf-8") as file:
            positions = node_positions(json.load(file))
        with h5py.File(os.path.join(REFERENCE_DATA, "expected", name + ".h5"), "r") as reference, \
                h5py.File(run.path("result.h5"), "r") as found:
            touched, part = reference["touch"][()].astype(bool), reference["fields/density"][()] > 0
            if "layer" in reference["fields"]:
                self.assertTrue(np.array_equal(found["layer"][()].ravel(), reference["fields/layer"][()]))
            for field in ("displacement", "release_displacement", "residual_stress", "layer_displacement_norms", *more):
                correct = reference["fields/" + field][()]
                values = found[field][()].reshape(correct.shape)
                if field in ("displacement", "release_displacement"):
                    values, correct = values[touched], correct[touched]
                if field == "release_displacement":
                    values, correct = (without_rigid_motion(u, positions[touched]) for u in (values, correct))
                if field in ("residual_stress", *more):
                    values, correct = values[part], correct[part]
                self.assertLess(np.abs(values - correct).max() / np.abs(correct).max(), FIELD_LIMIT, field)

    def check_evaluation(self, name):
        for ranks in RANK_COUNTS:
            with self.subTest(ranks=ranks):
                run, expected = self.run_case(name, ranks)
                self.check_values(run.json("evaluation.json"), expected)
                self.check_gradients(name, run, expected)

    def test_table_2d(self):
        self.check_evaluation("table_2d")

    def test_nominal_arm_2d(self):
        self.check_evaluation("nominal_arm_2d")

    def test_thermal_arm_2d(self):
        self.check_evaluation("thermal_arm_2d")
        run, _ = self.run_case("thermal_arm_2d", 1)
        with h5py.File(os.path.join(REFERENCE_DATA, "expected", "thermal_arm_2d.h5"), "r") as reference:
            correct = reference["fields/interpass"][()]
        found = [layer["interpass_temperature"] for layer in run.json("evaluation.json")["layers"]]
        self.assertLess(np.abs(np.array(found) - correct).max() / correct.max(), VALUE_LIMIT)

    def test_hook_nodes_2d(self):
        self.check_evaluation("hook_nodes_2d")

    def test_arch_quiet_3d(self):
        self.check_evaluation("arch_quiet_3d")

    def test_tee_two_parts_2d(self):
        self.check_evaluation("tee_two_parts_2d")

    def test_released_bracket_2d(self):
        self.check_evaluation("released_bracket_2d")

    def test_scenarios_arm_3d(self):
        self.check_evaluation("scenarios_arm_3d")

    def test_post_substrate_3d(self):
        self.check_evaluation("post_substrate_3d")

    def test_guided_3d(self):
        self.check_evaluation("guided_3d")

    def test_steps_planar_3d(self):
        for ranks in RANK_COUNTS:
            with self.subTest(ranks=ranks):
                run, expected = self.run_case("steps_planar_3d", ranks)
                self.check_values(run.json("summary.json"), expected)
                self.check_fields("steps_planar_3d", run)

    def check_flow(self, name):
        """In smooth layers."""
        self.check_evaluation(name)
        for ranks in RANK_COUNTS:
            with self.subTest(ranks=ranks):
                run, expected = self.run_case(name, ranks, task="simulate")
                summary = run.json("summary.json")
                self.check_values(summary, expected)
                self.assertTrue(summary["words"]["stress"][0].startswith("residual stress, with plastic flow: up to "))
                self.check_fields(name, run, ("plastic_strain", "released_stress", "released_plastic_strain"))

    def test_plastic_arm_3d(self):
        self.check_flow("plastic_arm_3d")

    def test_plastic_heat_3d(self):
        self.check_flow("plastic_heat_3d")


if __name__ == "__main__":
    run_fabseq.main()
