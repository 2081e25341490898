# SPDX-License-Identifier: MIT
"""Shapes of a config that move with a part which is turned."""

import math

import numpy as np

AXES = "xyz"
EXACT = 1e-12   # so near to -1, 0 and 1 are entries of the matrix of quarter turns
DIGITS = 12     # of coordinates: what rounding adds is dropped


class CannotTurn(Exception):
    """Why a shape cannot be given in the turned coordinates."""


class Motion:
    """A point x of the part goes to `matrix` x + `shift`; `matrix` is a rotation. `shift` may be None, for
    the reason `unknown`: then points cannot be turned."""

    def __init__(self, turn):
        """`turn`: pairs of axis and degrees that follow one another."""
        self.matrix = np.eye(3)
        for axis, degrees in turn:
            self.matrix = rotation(axis, degrees) @ self.matrix
        near = np.round(self.matrix)
        self.matrix = np.where(np.abs(self.matrix - near) < EXACT, near, self.matrix)
        self.quarters = bool(np.array_equal(self.matrix, near))
        self.shift, self.unknown = None, ""

    def is_identity(self):
        """Whether nothing turns: then nothing moves, either."""
        return np.array_equal(self.matrix, np.eye(3))

    def point(self, point):
        if self.shift is None:
            raise CannotTurn(self.unknown)
        return tidy(self.matrix @ point + self.shift)

    def direction(self, direction):
        return tidy(self.matrix @ direction)

    def axis(self, name):
        """The axis that an axis without sign becomes."""
        found = np.flatnonzero(np.abs(self.matrix[:, AXES.index(name)]) == 1.0)
        if len(found) == 0:
            raise CannotTurn(f"its axis {name} becomes none of the axes of the box")
        return AXES[found[0]]

    def shape(self, shape):
        """A shape or a node set of a config. Keys beside the shape stay; what is near a mesh turns with the
        part by itself."""
        if "box" in shape and not self.quarters:
            return {key: value for key, value in shape.items() if key != "box"} | self.half_spaces(shape["box"])
        return {key: getattr(self, f"turn_{key}")(value) if hasattr(self, f"turn_{key}") else value
                for key, value in shape.items()}

    def turn_box(self, box):
        ends = [np.array(box[end], float) for end in ("min", "max")]
        corners = np.array([self.point(end) for end in ends])
        return {"min": corners.min(axis=0).tolist(), "max": corners.max(axis=0).tolist()}

    def turn_half_space(self, half_space):
        return {"point": self.point(half_space["point"]), "normal": self.direction(half_space["normal"])}

    def turn_cylinder(self, cylinder):
        return cylinder | {end: self.point(cylinder[end]) for end in ("from", "to")}

    def turn_sphere(self, sphere):
        return sphere | {"center": self.point(sphere["center"])}

    def turn_polygon(self, polygon):
        axis, turned = AXES.index(polygon["axis"]), AXES.index(self.axis(polygon["axis"]))
        points = [np.delete(self.point(np.insert(point, axis, 0.0)), turned).tolist() for point in polygon["points"]]
        return {"points": points, "axis": AXES[turned]}

    def turn_union(self, shapes):
        return [self.shape(shape) for shape in shapes]

    turn_intersection = turn_difference = turn_union

    def half_spaces(self, box):
        """A box that is not along the axes any more."""
        sides = [(box[end], sign * np.eye(3)[axis]) for end, sign in (("min", -1.0), ("max", 1.0)) for axis in range(3)]
        return {"intersection": [{"half_space": {"point": self.point(corner), "normal": self.direction(normal)}}
                                 for corner, normal in sides]}


def rotation(axis, degrees):
    angle = math.radians(degrees)
    first, second = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    result = np.eye(3)
    result[first, first] = result[second, second] = math.cos(angle)
    result[second, first], result[first, second] = math.sin(angle), -math.sin(angle)
    return result


def tidy(vector):
    return [float(f"{value:.{DIGITS}g}") + 0.0 for value in vector]
