#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Turned shapes: a shape that is turned holds the points that are turned."""

import unittest
from pathlib import Path

import numpy as np

from fabseq_tools.orientation.turned_shapes import CannotTurn, Motion

from inside_shapes import contains

PROJECT = Path(__file__).resolve().parents[2]

TURNS = [["x", 90]], [["y", -90], ["z", 180]], [["z", 270], ["x", 180]], [["x", 20], ["y", -35], ["z", 110]], [["z", 45]]
BOX = {"box": {"min": [1, 2, -3], "max": [4, 7, 5]}}
BALL = {"sphere": {"center": [2, 1, 0], "radius": 3.5}}
ROD = {"cylinder": {"from": [0, 1, -2], "to": [3, 4, 2], "radius": 2}}
BELOW = {"half_space": {"point": [1, 3, 0], "normal": [2, 1, -1]}}


def motion_of(turn):
    motion = Motion(turn)
    motion.shift = np.array([10.0, -4.0, 0.5])
    return motion


class TurnedShapesTest(unittest.TestCase):
    def test_points_inside(self):
        points = np.random.default_rng(2).uniform(-6, 8, (4000, 3))
        mixed = {"difference": [{"union": [BOX, BALL]}, {"intersection": [ROD, BELOW]}]}
        for turn in TURNS:
            motion = motion_of(turn)
            moved = points @ motion.matrix.T + motion.shift
            for shape in (BOX, BALL, ROD, BELOW, mixed):
                inside = contains(shape, points, 0.0)
                self.assertGreater(inside.sum(), 50)
                np.testing.assert_array_equal(contains(motion.shape(shape), moved, 0.0), inside)

    def test_turns_follow_one_another(self):
        """x up, then around the new z: y goes to z and stays there."""
        motion = motion_of([["x", 90], ["z", 90]])
        np.testing.assert_array_equal(motion.matrix, [[0, 0, 1], [1, 0, 0], [0, 1, 0]])
        self.assertEqual(motion.point([1, 2, 3]), [13.0, -3.0, 2.5])
        self.assertEqual([motion.axis(name) for name in "xyz"], ["y", "z", "x"])
        self.assertTrue(Motion([["y", 360]]).is_identity())

    def test_box_stays_a_box_and_keys_stay(self):
        given = BOX | {"samples": 4, "within": 0.1, "surface": True}
        self.assertEqual(motion_of([["x", 90]]).shape(given),
                         {"box": {"min": [11, -9, 2.5], "max": [14, -1, 7.5]}, "samples": 4, "within": 0.1, "surface": True})
        slanted = motion_of([["y", 30]]).shape(given)
        self.assertEqual(set(slanted), {"intersection", "samples", "within", "surface"})
        for given in ({"all": True, "surface": True}, {"near": {"mesh": "face.stl", "distance": 1}}):
            self.assertEqual(motion_of([["y", 30]]).shape(given), given)

    def test_polygons(self):
        """Along any axis, corners in the two others in ascending order."""
        polygon = {"polygon": {"axis": "y", "points": [[0, 0], [5, 0], [0, 3]]}}  # x, z
        self.assertEqual(motion_of([["x", 90]]).shape(polygon),  # x, y, z to x, -z, y
                         {"polygon": {"axis": "z", "points": [[10, -4], [15, -4], [10, -7]]}})
        around = motion_of([["y", 30]]).shape(polygon)["polygon"]
        self.assertEqual(around["axis"], "y")
        np.testing.assert_allclose(around["points"][1], [10 + 5 * np.cos(np.radians(30)), 0.5 - 2.5])
        with self.assertRaisesRegex(CannotTurn, "its axis y becomes none"):
            motion_of([["x", 30]]).shape(polygon)

    def test_without_a_shift(self):
        """Only what has no place can be turned."""
        motion = Motion([["x", 90]])
        motion.unknown = "nobody knows"
        self.assertEqual(motion.axis("y"), "z")
        self.assertEqual(motion.shape({"all": True}), {"all": True})
        for shape in (BOX, BALL, ROD, BELOW):
            with self.assertRaisesRegex(CannotTurn, "nobody knows"):
                motion.shape(shape)


if __name__ == "__main__":
    unittest.main()
