#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Programs for machines say what the paths say: each is read back, point by point."""

import argparse
import types
import unittest

import numpy as np
from scipy.spatial.transform import Rotation

from fabseq_tools.paths import thinning
from fabseq_tools.paths.frames import set_frames
from fabseq_tools.paths.posts import find_posts, gcode, rapid
from fabseq_tools.paths.programs import program_of
from fabseq_tools.paths.torch_paths import Pass
from fabseq_tools.paths.travels import Travel
from fabseq_tools.run.command_line import RunError

from program_readers import read_gcode, read_rapid, weld_speeds

UP = np.array([0.0, 0.0, 1.0])
CONFIG = {"domain": {"size": [4.0, 4.0, 4.0], "elements": [4, 4, 4], "unit": "cm", "origin": [0, 0, 1]}}
POSITION, DEGREES = 1e-3, 1e-3  # mm, degrees
TOLERANCES = thinning.Tolerances(0.002, 0.5)


def a_pass(layer, axes, turns=1.0):
    """Around a circle, in centimetres."""
    axes = np.asarray(axes, float)
    angle = np.linspace(0.0, 2.0 * np.pi * turns, len(axes))
    points = np.stack([2.0 + np.cos(angle), 2.0 + np.sin(angle), 1.0 + 0.2 * layer + 0.02 * angle], axis=1)
    count = len(axes)
    return Pass(layer, points, np.array(["outline"] * count), axes / np.linalg.norm(axes, axis=1)[:, None],
                np.full(count, 0.2), 0.3 + 0.05 * np.sin(angle), np.full(count, 0.5))


def cone(tilt, turns=1.0, steps=200):
    turn = np.linspace(0.0, 2.0 * np.pi * turns, steps)
    return np.stack([np.sin(tilt) * np.cos(turn), np.sin(tilt) * np.sin(turn), np.full(steps, np.cos(tilt))], axis=1)


def ways(passes):
    """As travels() has them, risen in the first and the last."""
    leaving = [np.empty((0, 3)), *(one.points[-1:] + one.axes[-1:] for one in passes)]
    coming = [*(one.points[:1] + one.axes[:1] for one in passes), np.empty((0, 3))]
    coming[0] = np.concatenate([coming[0] + UP, coming[0]])
    return [Travel(number, *both, 0.0) for number, both in enumerate(zip(leaving, coming))]


def program():
    """Three layers: upright with noise, over the pole, and three times around cones, below the plane, too."""
    random = np.random.default_rng(3)
    through = np.stack([np.linspace(-0.5, 0.5, 101), np.zeros(101), np.ones(101)], axis=1)
    passes = [a_pass(1, UP + 1e-9 * random.normal(size=(60, 3))), a_pass(2, through), a_pass(3, cone(0.9, 3.0, 600), 3.0),
              a_pass(3, cone(2.0)), a_pass(3, cone(0.5))]
    set_frames(passes, UP)
    part = types.SimpleNamespace(name="ring of fire", config=CONFIG, up=UP)
    speeds = [0.6 / one.spacings for one in passes]
    return program_of(part, passes, ways(passes), speeds, {1: 12.5, 2: 0.0, 3: 7.0}, TOLERANCES, 40.0, 10.0), passes


def options(post, *words):
    parser = argparse.ArgumentParser()
    post.add_options(parser)
    return parser.parse_args(words)


def angles(one, other):
    """Degrees between unit vectors."""
    return np.degrees(2.0 * np.arcsin(np.clip(0.5 * np.linalg.norm(one - other, axis=-1), 0.0, 1.0)))


class ThinningTest(unittest.TestCase):
    def test_what_is_left_out_is_near(self):
        """Positions against the way, axes against SciPy's turn between the kept ones."""
        one = a_pass(1, cone(0.7))
        for distance, angle in ((0.001, 5.0), (1.0, 0.3), (0.01, 1.0)):
            numbers = thinning.kept(one.points, one.axes, np.ones(200), thinning.Tolerances(distance, angle))
            self.assertLess(len(numbers), 190)
            self.assertEqual((numbers[0], numbers[-1]), (0, 199))
            for first, last in zip(numbers[:-1], numbers[1:]):
                start, way = one.points[first], one.points[last] - one.points[first]
                turn = least_turn(one.axes[first], one.axes[last])
                for number in range(first + 1, last):
                    share = np.clip((one.points[number] - start) @ way / (way @ way), 0.0, 1.0)
                    self.assertLessEqual(np.linalg.norm(one.points[number] - start - share * way), distance * (1 + 1e-9))
                    there = Rotation.from_rotvec(share * turn).apply(one.axes[first])
                    self.assertLessEqual(angles(there, one.axes[number]), angle * (1 + 1e-6))

    def test_straight_lines_and_feeds(self):
        """A straight line keeps its ends, and the places where the feed changes; time is kept."""
        points = np.stack([np.arange(21.0), np.zeros(21), np.zeros(21)], axis=1)
        axes = np.tile(UP, (21, 1))
        self.assertEqual(thinning.kept(points, axes, np.ones(21), TOLERANCES).tolist(), [0, 20])
        feeds = np.where(np.arange(21) < 10, 1.0, 1.5)
        numbers = thinning.kept(points, axes, feeds, TOLERANCES)
        self.assertTrue({9, 10} <= set(numbers.tolist()))
        self.assertLess(len(numbers), 7)
        speeds = thinning.speeds_of_ways(points, 1.0 / feeds, numbers)
        self.assertAlmostEqual((np.diff(points[numbers, 0]) / speeds).sum(), 9 + 1.25 + 10 * 1.5)


def least_turn(first, last):
    """From one unit vector to another, as a rotation vector."""
    across = np.cross(first, last)
    length = np.linalg.norm(across)
    return across / max(length, 1e-300) * np.arctan2(length, first @ last)


class ProgramTest(unittest.TestCase):
    def setUp(self):
        self.program, self.passes = program()

    def expected(self, layer):
        """Points, axes, x axes, whether the arc burns on the way to them, and speeds."""
        stretches = layer.stretches
        arc = np.concatenate([np.arange(len(one.points)) > (0 if one.arc else len(one.points)) for one in stretches])
        values = [np.concatenate([getattr(one, name) for one in stretches]) for name in ("points", "axes", "x_axes", "speeds")]
        return [*values, arc]

    def test_program(self):
        """Millimetres, kept waypoints, pauses but for the last, and the time that all waypoints take."""
        self.assertEqual([layer.pause for layer in self.program.layers], [12.5, 0.0, 0.0])
        self.assertAlmostEqual(self.program.plate, 10.0)
        arcs = [one for layer in self.program.layers for one in layer.stretches if one.arc]
        welding = 0.0
        for one, found in zip(self.passes, arcs):
            away = np.linalg.norm(10.0 * one.points[:, None] - found.points, axis=2).min(axis=0)
            self.assertLess(away.max(), 1e-9)
            steps = np.linalg.norm(np.diff(one.points, axis=0), axis=1)
            welding += (steps * 0.5 * (one.spacings[1:] + one.spacings[:-1]) / 0.6).sum()
        self.assertLess(sum(len(one.points) for one in arcs), 700)
        self.assertAlmostEqual(self.program.seconds()[0] / welding, 1.0, delta=2e-3)  # chords are shorter

    def test_gcode(self):
        for control in gcode.CONTROLS:
            for rotary in ("AC", "BC"):
                for sign in (1.0, -1.0):
                    words = ["--control", control, "--rotary", rotary] + ["--table-signs"] * (sign < 0)
                    files = gcode.program_files(self.program, options(gcode, *words))
                    self.check_gcode(files, control, rotary, sign)

    def check_gcode(self, files, control, rotary, sign):
        names = sorted(name for name in files if not name.startswith("main"))
        self.assertEqual(len(names), 3)
        before = None
        for layer, name in zip(self.program.layers, names):
            told, turned = read_gcode(files[name], rotary, sign)
            points, axes, _, speeds, arc = self.expected(layer)
            np.testing.assert_allclose(told.points, points, atol=POSITION)
            self.assertLess(angles(told.turns, axes).max(), DEGREES)
            if sign < 0:
                self.assertLess(angles(of_linuxcnc(rotary, -turned), axes).max(), DEGREES)
            np.testing.assert_array_equal(told.arc, arc)
            np.testing.assert_allclose(told.speeds, speeds, atol=0.1 / 60)
            np.testing.assert_allclose(told.pauses, [layer.pause] if layer.pause else [])
            coming = np.concatenate([np.arange(len(one.points)) < one.coming for one in layer.stretches])
            steps = np.abs(np.diff(turned, axis=0))
            self.assertLess(steps[~coming[1:]].max(), 30.0)  # no jumps with the arc on, nor near the part
            before = turned if before is None else np.concatenate([before, turned])
        self.assertLess(before[:, 0].max() - before[:, 0].min(), 3.5 * 360.0)
        starts = before[1:][np.abs(np.diff(before[:, 0])) > 360.0]
        self.assertEqual(len(starts), 1)  # three times around, and back before the next pass
        main = files["main.nc" if control == "fanuc" else "main.ngc"]
        self.assertRegex(main, r"G21 G90 G94")
        calls = [line for line in main.splitlines() if "M98" in line or line.startswith("o<")]
        self.assertEqual(len(calls), 3)
        self.assertEqual(("G43.4 H1" in main, "G64 P0.0200\nG43 H1\nM428" in main), (control == "fanuc", control != "fanuc"))

    def test_gcode_of_another_plate(self):
        self.program.up = np.array([1.0, 0.0, 0.0])
        with self.assertRaisesRegex(RunError, "build_plate: found another face than z-; allowed for --post gcode: z-"):
            gcode.program_files(self.program, options(gcode))

    def test_rapid(self):
        """Frames against SciPy's matrices, quaternions against the formulas of ABB's manual."""
        files = rapid.program_files(self.program, options(rapid))
        weld, travel = weld_speeds(files["fabseq_main.mod"])
        self.assertEqual(travel, 40.0)
        for layer in self.program.layers:
            name = f"layer_{layer.number:03d}"
            told, quaternions = read_rapid(files[name + ".mod"], weld, travel)
            points, axes, x_axes, speeds, arc = self.expected(layer)
            np.testing.assert_allclose(told.points, points, atol=POSITION)
            frames = np.stack([x_axes, np.cross(-axes, x_axes), -axes], axis=2)
            turned = (Rotation.from_matrix(told.turns).inv() * Rotation.from_matrix(frames)).magnitude()
            self.assertLess(np.degrees(turned).max(), DEGREES)
            np.testing.assert_allclose(np.abs(quaternions), np.abs(by_manual(frames)), atol=2e-8 + 1e-7)
            self.assertTrue((np.einsum("nq,nq->n", quaternions[1:], quaternions[:-1]) > 0).all())
            np.testing.assert_array_equal(told.arc, arc)
            np.testing.assert_allclose(told.speeds, np.where(arc, speeds, travel), atol=0.051)
            self.assertEqual(told.pauses, [layer.pause] if layer.pause else [])
            self.assertIn(f"<Module>{name}.mod</Module>", files["fabseq.pgf"])
            self.assertIn(f"layer{layer.number:03d};", files["fabseq_main.mod"])

    def test_quaternions_of_the_manual(self):
        """Its two examples: a tool along x, and one that is turned by 30 degrees about y."""
        for turn, expected in ((90.0, [0.707107, 0, 0.707107, 0]), (30.0, [0.965926, 0, 0.258819, 0])):
            matrix = Rotation.from_euler("y", turn, degrees=True).as_matrix()
            np.testing.assert_allclose(rapid.quaternions(*(matrix[None, :, k] for k in range(3)))[0], expected, atol=1e-6)

    def test_posts_register_themselves(self):
        self.assertEqual(set(find_posts()), {"gcode", "rapid"})


def of_linuxcnc(rotary, words):
    """The tool's axis by the third columns of LinuxCNC's xyzac-trt-kins and xyzbc-trt-kins; `words`: C and
    the other angle, degrees."""
    c, tilt = np.radians(words).T
    x, y = (np.sin(c), np.cos(c)) if rotary == "AC" else (-np.cos(c), np.sin(c))
    return np.stack([x * np.sin(tilt), y * np.sin(tilt), np.cos(tilt)], axis=1)


def by_manual(frames):
    """Sizes of q1 to q4 (n, 4) by the formulas of ABB's manual."""
    (x1, y1, z1), (x2, y2, z2), (x3, y3, z3) = np.moveaxis(frames, 0, -1)
    traces = np.stack([x1 + y2 + z3, x1 - y2 - z3, y2 - x1 - z3, z3 - x1 - y2], axis=1)
    return 0.5 * np.sqrt(np.maximum(traces + 1.0, 0.0))


if __name__ == "__main__":
    unittest.main()
