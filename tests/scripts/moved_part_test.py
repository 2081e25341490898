#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Parts whose geometry moves: the pseudo-time moves with the part, displacements are those of its nodes."""

import os
import tempfile
import unittest
from pathlib import Path

import numpy as np

from fabseq_tools.geometry import surface_files
from fabseq_tools.geometry.moved_part import MovedPart
from fabseq_tools.geometry.vtk_data import poly_data

from fake_results import element_centres, node_coordinates
from layered_results import write_layers

PROJECT = Path(__file__).resolve().parents[2]

SIZE, COUNTS = (3.0, 2.0, 2.4), (12, 8, 12)
SLOPE = np.array([0.1, -0.05, 0.3])
CONFIG = {"material": {"inherent_strain": [-0.01, -0.01, -0.01, 0, 0, 0]}}


class MovedPartTest(unittest.TestCase):
    def part(self, largest, **more):
        """A box in a larger one, of linear pseudo-time. Elements beside it have another time."""
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        x, y, z = element_centres(COUNTS, SIZE)
        built = (abs(x - 1.5) < 1.0) & (abs(y - 1.0) < 0.7) & (z < 2.0)
        time = 0.2 + SLOPE[0] * x + SLOPE[1] * y + SLOPE[2] * z
        displacement = np.zeros([n + 1 for n in COUNTS[::-1]] + [3])
        displacement[0:5] = largest
        run = write_layers(os.path.join(folder.name, "run"), SIZE, built, 3, time=np.where(built, time, 7.0),
                           config={**CONFIG, **more}, displacement=displacement)
        return MovedPart(run, 1.0), built

    def test_room(self):
        part, built = self.part([0.3, 0.1, 0.0])
        np.testing.assert_array_equal(part.fields["density"][:12, 1:-1, 2:-2], built)  # edges of 0.25, 0.25, 0.2
        self.assertEqual(part.fields["density"].shape, (13, 10, 16))
        np.testing.assert_allclose(part.config["domain"]["origin"], [-0.5, -0.25, 0.0])
        np.testing.assert_allclose(part.config["domain"]["size"], [4.0, 2.5, 2.6])

    def test_time_moves_along(self):
        """Exact at first, and of linear times under a linear map everywhere near the part."""
        part, built = self.part([0.3, 0.3, 0.3])
        before = part.time(part.places())
        x, y, z = node_coordinates(COUNTS, SIZE)
        self.assertEqual(len(part.drawn) - part.corner_count, ((abs(x - 1.5) < 1.01) & (abs(y - 1) < 0.76) & (z < 2.01)).sum())
        np.testing.assert_allclose(before[:12, 2:-2, 2:-2][built], part.fields["time"][part.fields["density"] > 0], rtol=1e-12)
        stretch, shift = np.diag([1.05, 0.97, 1.1]), np.array([0.13, -0.06, 0.0])
        stretch[0, 2] = 0.06
        part.move(part.drawn @ stretch.T + shift - part.drawn)
        centres = np.stack(np.meshgrid(*part.centre_axes[::-1], indexing="ij")[::-1], axis=-1)
        places = (centres - shift) @ np.linalg.inv(stretch).T
        near = np.all((abs(places - [1.5, 1.0, 1.0]) < [1.1, 0.8, 1.1]), axis=-1)
        expected = np.clip(0.2 + places @ SLOPE, *np.array([before.min(), before.max()]))
        self.assertGreater(near.sum(), built.sum())
        np.testing.assert_allclose(part.time(part.places())[near], expected[near], atol=1e-5)

    def test_gradient_moves_along(self):
        """Each element has that of its place in the drawing; beyond the part the nearest goes on."""
        part, built = self.part([0.3, 0.3, 0.3])
        own = np.zeros((*part.fields["density"].shape, 3))
        x = np.broadcast_to(part.centre_axes[0], own.shape[:-1])
        own[..., 0], own[..., 2] = np.sign(x - 1.5), 2.0
        own[part.fields["density"] <= 0] = 7.0
        part.fields["time_gradient"] = own
        by = np.zeros(part.drawn.shape)
        by[:, 0] = 0.25  # an element
        part.move(by)
        found = part.gradient(part.places())
        places = x - 0.25
        np.testing.assert_allclose(found[..., 2], 2.0)
        np.testing.assert_allclose(found[..., 0], np.sign(places - 1.5))
        np.testing.assert_allclose(np.linalg.norm(found[:12, 2:-2, 3:-1][built], axis=-1), np.sqrt(5.0))

    def test_points_on_the_plate_keep_their_height(self):
        part, _ = self.part([0.1, 0.1, 0.1])
        part.move(np.full(part.drawn.shape, 0.01))
        by, foot = part.moved - part.drawn, part.drawn[:, 2] < 1e-6
        np.testing.assert_allclose(by[:, :2], 0.01)
        np.testing.assert_allclose(by[:, 2], np.where(foot, 0.0, 0.01), atol=1e-15)
        self.assertGreater(foot.sum(), 50)

    def test_displacement_is_that_of_the_parts_nodes(self):
        """Where no element is, nodes have another displacement, which does not count."""
        part, _ = self.part([0.1, 0.1, 0.1])
        there = np.zeros(part.node_shape(), bool).ravel()
        there[part.nodes] = True
        field = np.where(there[:, None], part.node_positions() @ np.diag([0.01, -0.02, 0.03]), 99.0)
        fields = {"density": part.fields["density"], "displacement": field.reshape(*part.node_shape(), 3)}
        part.move(np.random.default_rng(1).uniform(-0.1, 0.1, part.drawn.shape))
        found = part.displacement_at(fields, released=False)
        fields["release_displacement"] = fields["displacement"]
        np.testing.assert_allclose(part.displacement_at(fields, released=True), 2 * found)
        inside = part.moved[:, 2] >= 0
        np.testing.assert_allclose(found[inside], (part.moved @ np.diag([0.01, -0.02, 0.03]))[inside], atol=1e-12)


class FinerTest(unittest.TestCase):
    def test_edges(self):
        """Corners that are there twice become one, and no edge is too long; the area stays."""
        corners = np.array([[[0, 0, 0], [3, 0, 0], [3, 1, 0]], [[0, 0, 0], [3, 1, 0], [0, 1, 0]]], float)
        points, faces = surface_files.finer(poly_data(corners.reshape(-1, 3), np.arange(6).reshape(-1, 3)), 0.4)
        self.assertEqual(len(np.unique(points, axis=0)), len(points))
        edges = points[faces] - points[np.roll(faces, 1, axis=1)]
        self.assertLessEqual(np.linalg.norm(edges, axis=2).max(), 0.4)
        self.assertAlmostEqual(0.5 * np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1).sum(), 3.0)


if __name__ == "__main__":
    unittest.main()
