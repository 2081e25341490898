#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""The torch's frames turn no more about their axis than the axis itself does."""

import types
import unittest

import numpy as np
from scipy.spatial.transform import Rotation

from fabseq_tools.paths.files import irbcam_targets
from fabseq_tools.paths.frames import Reference, euler_angles, set_frames

UP = np.array([0.0, 0.0, 1.0])


def a_pass(axes, points=None):
    """A pass with these axes, by default along a circle."""
    axes = np.asarray(axes, float)
    axes = axes / np.linalg.norm(axes, axis=1)[:, None]
    turn = np.linspace(0.0, 2 * np.pi, len(axes))
    circle = np.stack([np.cos(turn), np.sin(turn), 0 * turn], axis=1)
    count = np.ones(len(axes))
    return types.SimpleNamespace(layer=1, points=circle if points is None else points, axes=axes, heights=count, spacings=count,
                                 levels=0.5 * count)


def cone(tilt, turns=1.0, steps=200):
    turn = np.linspace(0.0, 2 * np.pi * turns, steps)
    return np.stack([np.sin(tilt) * np.cos(turn), np.sin(tilt) * np.sin(turn), np.full(steps, np.cos(tilt))], axis=1)


def rotations(one):
    return Rotation.from_matrix(np.stack([one.x_axes, np.cross(-one.axes, one.x_axes), -one.axes], axis=2))


class FramesTest(unittest.TestCase):
    def assert_no_turn(self, passes):
        """From one waypoint to the next the frame turns by as much as its axis does."""
        for one in passes:
            turns = rotations(one)
            turned = (turns[:-1].inv() * turns[1:]).magnitude()
            axis = np.arccos(np.clip((one.axes[1:] * one.axes[:-1]).sum(axis=1), -1.0, 1.0))
            np.testing.assert_allclose(turned, axis, atol=1e-6)

    def test_still(self):
        random = np.random.default_rng(2)
        noise = UP + 1e-8 * random.normal(size=(100, 3))  # of planar layers
        for axes in (noise, UP + 0.3 * random.normal(size=(100, 3)), cone(1.0), cone(3.1), -noise):
            passes = [a_pass(axes), a_pass(axes[::-1])]
            set_frames(passes, UP)
            self.assert_no_turn(passes)

    def test_the_torch_turns_back_between_passes(self):
        """Around a cone of 60 degrees, a frame that does not turn comes back turned by half a turn."""
        passes = [a_pass(cone(np.pi / 3)) for _ in range(6)]
        set_frames(passes, UP)
        reference = Reference(UP)
        for one in passes:
            self.assertAlmostEqual(abs(reference.twist(one.x_axes[-1], -one.axes[-1])), 180.0, delta=0.1)
            self.assertLess(abs(reference.twist(one.x_axes[0], -one.axes[0])), 1.0)

    def test_along_the_travel(self):
        one = a_pass(np.tile(UP, (50, 1)))
        set_frames([one], UP, "travel")
        along = np.gradient(one.points, axis=0)
        np.testing.assert_allclose(np.einsum("ni,ni->n", one.x_axes, along) / np.linalg.norm(along, axis=1), -1.0)
        upwards = a_pass(np.tile(UP, (3, 1)), np.array([[0, 0, 0], [0, 0, 1], [0, 0, 2]], float))
        set_frames([upwards], UP, "travel")
        np.testing.assert_allclose(np.linalg.norm(upwards.x_axes, axis=1), 1.0)

    def test_angles(self):
        """They give the frames back, and go on without jumps where the torch stands upright."""
        random = np.random.default_rng(3)
        through = np.stack([np.linspace(-0.5, 0.5, 101), np.zeros(101), np.ones(101)], axis=1)  # over the pole
        for axes, largest in ((UP + 1e-8 * random.normal(size=(100, 3)), 1e-5), (through, 0.02), (cone(0.8, 3, 600), 0.04)):
            one = a_pass(axes)
            set_frames([one], UP)
            angles = euler_angles(one.x_axes, -one.axes)
            found = Rotation.from_euler("ZYZ", angles)
            self.assertLess((found.inv() * rotations(one)).magnitude().max(), 1e-5)
            self.assertLess(np.abs(np.diff(angles, axis=0)).max(), largest)

    def test_targets(self):
        """Rapid ones before, between and after passes; raised ways have two more."""
        passes = [a_pass(cone(0.3)[:10]), a_pass(cone(0.3)[10:30]), a_pass(cone(0.3)[30:50])]
        set_frames(passes, UP)
        straight = np.array([passes[0].points[-1], passes[1].points[0]]) + UP
        end, start = passes[1].points[-1], passes[2].points[0]
        raised = np.array([end, end + 9 * UP, start + 9 * UP, start])
        targets = irbcam_targets(passes, [straight, raised], 25.4, 7.0, 2.0)
        rapid = targets[:, 6] < 0
        np.testing.assert_array_equal(np.flatnonzero(rapid), [0, 11, 12, 33, 34, 35, 36, 57])
        np.testing.assert_allclose(targets[~rapid, :3], 25.4 * np.concatenate([one.points for one in passes]))
        np.testing.assert_allclose(targets[[11, 12, 33, 34, 35, 36], :3], 25.4 * np.concatenate([straight, raised]))
        turns = Rotation.from_euler("ZYZ", targets[:, 3:6])
        np.testing.assert_allclose(turns[~rapid].apply(UP), -np.concatenate([one.axes for one in passes]), atol=1e-9)


if __name__ == "__main__":
    unittest.main()
