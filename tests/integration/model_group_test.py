# SPDX-License-Identifier: MIT
"""The group model of result.h5: node sets, supports, stiffness and strain are those of the config, found once
more here."""

import os

import h5py
import numpy as np

import run_fabseq
from inside_shapes import contains
from mesh_test import box_triangles, stl_text
from multi_planar_test import tee_2d
from read_outputs import read_result
from run_fabseq import FabseqTest, distinct
from small_parts import direct_2d, hook_3d, part_density, plate_2d, post_on_substrate, touched_nodes, write_voxels

VOIGT = {2: ((0, 0), (1, 1), (0, 1)), 3: ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))}
FACE = np.array([[0.0, 0.0, 1.6], [0.8, 0.8, 1.6]])  # of the hook: part of its top


def sets_2d():
    return {"box": {"box": {"min": [0, 1.2], "max": [2, 1.2]}},
            "polygon": {"polygon": {"points": [[0.1, 0.1], [1.9, 0.2], [1.0, 0.55], [1.3, 1.2], [0.1, 1.1]]}},
            "ring": {"difference": [{"sphere": {"center": [1, 0.6], "radius": 0.5}},
                                    {"sphere": {"center": [1, 0.6], "radius": 0.31}}]},
            "wide": {"sphere": {"center": [2, 0.6], "radius": 0.3}, "within": 0.15},
            "few": {"box": {"min": [0, 0], "max": [2, 0]}, "samples": 5}, "all": {"all": True},
            "skin": {"all": True, "surface": True}, "a b~c": {"box": {"min": [0, 0], "max": [0, 1]}, "surface": True},
            "Kante ü": {"box": {"min": [0, 0.5], "max": [1, 0.5]}}}


def sets_3d():
    return {"box": {"box": {"min": [1.6, 0, 1.6], "max": [1.6, 0.8, 1.6]}},
            "polygon": {"polygon": {"axis": "y", "points": [[0, 0], [0.8, 0.9], [1.5, 1.6], [0, 1.6]]}},
            "rod": {"union": [{"cylinder": {"from": [0, 0.4, 0.2], "to": [1.6, 0.4, 1.5], "radius": 0.3}},
                              {"half_space": {"point": [1.4, 0, 0], "normal": [-1, 0, 0]}}], "surface": True},
            "face": {"near": {"mesh": "face.stl", "distance": 0.25}}, "all": {"all": True},
            "few": {"box": {"min": [0, 0.8, 1.6], "max": [1.6, 0.8, 1.6]}, "samples": 3}}


class Expected:
    """What the config says of nodes and elements."""

    def __init__(self, config, data):
        domain = config["domain"]
        axes = [np.linspace(0, edge, n + 1) for edge, n in zip(domain["size"], domain["elements"])]
        self.points = np.stack([grid.ravel() for grid in np.meshgrid(*axes[::-1], indexing="ij")[::-1]], axis=1)
        self.part, self.substrate = data["density"] > 0, data.get("substrate", 0 * data["density"]) > 0
        self.solid, self.config = self.part | self.substrate, config
        self.slack = 1e-6 * min(edge / n for edge, n in zip(domain["size"], domain["elements"]))

    def node_set(self, description):
        shape = {key: value for key, value in description.items() if key not in ("all", "surface", "samples", "within", "near")}
        chosen = touched_nodes(1.0 * (self.part if description.get("all") else self.solid)).ravel()
        if "near" in description:
            nearest = np.clip(self.points, *FACE)
            chosen &= np.linalg.norm(self.points - nearest, axis=1) <= description["near"]["distance"] + self.slack
        elif shape:
            chosen &= contains(shape, self.points, max(self.slack, description.get("within", 0)))
        if description.get("surface"):
            around = np.pad(1.0 * self.solid, 1)
            inner = sum(around[tuple(slice(c, c + n + 1) for c, n in zip(corner, self.solid.shape))]
                        for corner in np.ndindex(*(2,) * self.solid.ndim)) == 2**self.solid.ndim
            chosen &= ~inner.ravel()
        numbers = np.flatnonzero(chosen)  # along x, the longest edge of sets with samples here
        if description.get("samples"):
            steps = description["samples"] - 1
            numbers = numbers[[int(i * (len(numbers) - 1) / steps + 0.5) for i in range(steps + 1)]]
        return numbers

    def supports(self):
        whole = np.ones_like(self.solid) if self.config.get("process", {}).get("void") == "quiet" else self.solid
        there = touched_nodes(1.0 * whole).ravel()
        if "clamps" in self.config:
            return np.flatnonzero(there & contains(self.config["clamps"], self.points, self.slack))
        plate = self.config.get("build_plate", "yz"[self.part.ndim - 2] + "-")
        height = self.points[:, "xyz".index(plate[0])] * (1 if plate[1] == "-" else -1)
        foot = touched_nodes(1.0 * self.substrate).ravel() if self.substrate.any() else np.ones_like(there)
        return np.flatnonzero(there & foot & (height <= height[foot].min() + self.slack))


class ModelGroupTest(FabseqTest):
    def setUp(self):
        super().setUp()
        with open(os.path.join(self.directory, "face.stl"), "w", encoding="utf-8") as file:
            low, high = FACE
            file.write(stl_text(box_triangles(low - [0, 0, 1], high)[-2:]))

    def simulated(self, config, ranks=1, groups=1):
        run = self.run_config(ranks, config, "-task", "simulate", "-layer_groups", groups)
        self.assert_done(run)
        return run

    def check_nodes(self, config):
        """Written as found here, and as one rank does it by two ranks and by two groups."""
        run = self.simulated(config)
        data = read_result(run)
        expected = Expected(config, data)
        self.assertEqual({name for name in data if name.startswith("model/node_sets/")},
                         {"model/node_sets/" + name for name in config["node_sets"]})
        for name, description in config["node_sets"].items():
            found = data["model/node_sets/" + name]
            self.assertEqual(found.dtype, np.int64)
            np.testing.assert_array_equal(found, expected.node_set(description), name)
        np.testing.assert_array_equal(data["model/supports"], expected.supports())
        for ranks, groups in distinct((2, 1), (3, 1), (2, 2)):
            other = read_result(self.simulated(config, ranks, groups))
            for name in data:
                if name.startswith("model/") and name != "model/strain":  # which may follow from a solve
                    np.testing.assert_array_equal(other[name], data[name], f"{name} on {ranks} ranks")
                    self.assertEqual(other[name].dtype, data[name].dtype)

    def test_nodes_2d(self):
        for plate in ("y-", "x+"):
            config = plate_2d() | {"build_plate": plate, "node_sets": sets_2d(), "constraints": []}
            config["part"] = {"difference": [{"box": {"min": [0, 0], "max": [2, 1.2]}},
                                             {"sphere": {"center": [0.7, 1.2], "radius": 0.35}}]}
            config["objective"] = [{"type": "distortion", "nodes": "polygon"}]
            self.check_nodes(config)

    def test_nodes_3d(self):
        for plate in ("z-", "z+", "x-"):
            config = hook_3d() | {"build_plate": plate, "node_sets": sets_3d(), "constraints": []}
            config["objective"] = [{"type": "distortion", "nodes": "face"}]
            self.check_nodes(config)

    def test_substrate_and_clamps(self):
        for dimension in (2, 3):
            config = post_on_substrate(dimension)
            config["node_sets"]["skin"] = {"all": True, "surface": True}
            self.check_nodes(config)
            del config["clamps"]
            self.check_nodes(config)
        config["process"] = {"void": "quiet", "min_stiffness": 1e-3}
        self.check_nodes(config)

    def test_stiffness_and_strain(self):
        """Of grey elements, in soft void."""
        config = plate_2d()
        path = os.path.join(self.directory, "part.h5")
        density = part_density(config) * np.random.default_rng(1).uniform(0.3, 1.0, (12, 20))
        write_voxels(path, density)
        config["part"] = {"voxels": {"file": path}}
        config["material"] = {"young": 210e3, "inherent_strain": [-0.01, -0.004, 0.002], "strain_scale": [1.21, 1.0]}
        for void in ("quiet", "absent"):
            config["process"] = {"void": void, "min_stiffness": 1e-3, "stiffness_penalty": 2.5, "strain_penalty": 4}
            data = read_result(self.simulated(config, 2))
            stiffness = 1e-3 + (1 - 1e-3) * density**2.5
            found = data["model/stiffness"]
            np.testing.assert_allclose(found, np.where((density > 0) | (void == "quiet"), stiffness, 0), rtol=1e-14)
            np.testing.assert_allclose(data["model/strain_factor"], density**4 / stiffness, rtol=1e-14)
            np.testing.assert_array_equal(data["model/unbuilt_stiffness"], [1e-3])
            np.testing.assert_allclose(data["model/strain"], [-0.0121, -0.004, 0.0022], rtol=1e-14)
        data = read_result(self.simulated(post_on_substrate(2)))
        np.testing.assert_array_equal(data["model/stiffness"], 1.0 * ((data["density"] > 0) | (data["substrate"] > 0)))
        np.testing.assert_array_equal(data["model/strain_factor"], data["density"])

    def test_strain_that_turns(self):
        """Along the direction in which material is added; of an optimization and of a simulation."""
        for config in (post_on_substrate(3), tee_2d()):
            config["material"]["strain_scale"] = [1.3, 0.9, 1.1][:len(config["domain"]["size"])]
            runs = [self.simulated(config, 2), self.run_config(2, config, "-max_iterations", 2, "-layer_groups", 2)]
            self.assert_done(runs[1])
            for data in map(read_result, runs):
                dimension, strain = data["density"].ndim, config["material"]["inherent_strain"]
                direction, scale = data["build_direction"], np.sqrt(config["material"]["strain_scale"])
                for component, (a, b) in enumerate(VOIGT[dimension]):
                    across = direction[..., a] * direction[..., b]
                    expected = strain["tangential"] * ((a == b) - across) + strain["normal"] * across
                    expected = np.where(data["density"] > 0, expected * scale[a] * scale[b] * (1 if a == b else 2), 0)
                    np.testing.assert_allclose(data["model/strain"][..., component], expected, atol=1e-8)

    def test_nodal_time(self):
        """Written where the sequence has it, smoothed times, too: time is its mean over each element."""
        for radius in (0, 0.3):
            config = direct_2d("nodes")
            config["sequence"]["filter_radius"] = radius
            run = self.run_config(2, config, "-max_iterations", 2)
            self.assert_done(run)
            data = read_result(run)
            self.assertEqual(np.array_equal(data["nodal_time"], data["design"]), radius == 0)
            part = data["density"] > 0
            for prefix in ("", "start/"):
                nodal = data[prefix + "nodal_time"]
                mean = (nodal[1:, 1:] + nodal[1:, :-1] + nodal[:-1, 1:] + nodal[:-1, :-1]) / 4
                np.testing.assert_allclose(data[prefix + "time"][part], mean[part], rtol=1e-14)
        for location in ("elements", "heat"):
            config = direct_2d("elements") if location == "elements" else plate_2d()
            self.assertNotIn("nodal_time", read_result(self.simulated(config)))

    def test_it_is_small(self):
        """At most a tenth of the values of a file, and not among ParaView's fields."""
        for words in (("-max_iterations", 1), ("-task", "simulate")):
            run = self.run_config(1, plate_2d(), *words)
            self.assert_done(run)
            sizes = {name: values.nbytes for name, values in read_result(run).items()}
            own = sum(size for name, size in sizes.items() if name.startswith("model/"))
            self.assertLessEqual(own, 0.1 * sum(sizes.values()), words)
            with open(run.path("result.xdmf"), encoding="utf-8") as file:
                self.assertNotIn("model/", file.read())
            with h5py.File(run.path("result.h5"), "r") as file:
                for name in ("node_sets/top", "strain", "stiffness"):
                    self.assertIn("checksum", file["model/" + name].attrs)


if __name__ == "__main__":
    run_fabseq.main()
