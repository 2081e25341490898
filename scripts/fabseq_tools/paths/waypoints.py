# SPDX-License-Identifier: MIT
"""Waypoints of a table, and at which height of their beads they lie."""

import numpy as np
from scipy.spatial import KDTree

from fabseq_tools.geometry.grid import origin_of
from fabseq_tools.geometry.length_columns import lengths, usual_unit
from fabseq_tools.run.command_line import RunError

AXIS = ("axis_x", "axis_y", "axis_z")
COLUMNS = ("layers", "passes", "heights", "spacings", "axes")  # of waypoints, which may be missing
NEIGHBOURS = 12      # in the layer, which a plane is laid through
FLAT = 0.05          # ratio of the second to the largest extent of these: below, they lie in a line
NEAR_END = 0.2       # of a layer's height: so near to its top or bottom waypoints seem to lie there


class Waypoints:
    """`points` (n, 3) in the middle of their layers, in the config's coordinates; `layers` from 1, or None;
    `times`: share of the waypoints up to each; `axes`, `heights`, `spacings`: None if the table has none."""

    def __init__(self, table, placement):
        unit = usual_unit(placement.millimetres)
        self.points = placement.to_config(lengths(table, ["x", "y", "z"], unit))
        if "layer" not in table.header and "order" not in table.header:
            raise RunError(f"{table.path}: the first line names neither a column layer nor order; needed: one of them")

        def length(name):
            return lengths(table, [name], unit)[:, 0] / placement.scale if name in table.header else None

        self.layers = table.whole_numbers("layer") if "layer" in table.header else None
        self.passes = table.column("pass") if "pass" in table.header else None
        self.heights, self.spacings = length("height"), length("spacing")
        self.times = (np.arange(len(table.rows)) + 0.5) / len(table.rows)
        self.axes = None
        if all(name in table.header for name in AXIS):
            axes = table.numbers(list(AXIS)) @ np.linalg.inv(placement.inverse).T
            self.axes = axes / np.maximum(np.linalg.norm(axes, axis=1), 1e-300)[:, None]
        if "order" in table.header:
            self.take(np.argsort(table.column("order"), kind="stable"), "points", *COLUMNS)
        if self.layers is not None:
            self.layers = np.unique(self.layers, return_inverse=True)[1] + 1

    def take(self, chosen, *names):
        for name in names:
            values = getattr(self, name)
            setattr(self, name, None if values is None else values[chosen])

    def filled(self, step):
        """With waypoints at such steps, at most, between those of a pass."""
        if self.passes is None:
            return
        same = self.passes[1:] == self.passes[:-1]
        if self.layers is not None:
            same &= self.layers[1:] == self.layers[:-1]
        count = np.where(same, np.ceil(np.linalg.norm(np.diff(self.points, axis=0), axis=1) / step), 1).astype(int)
        count = np.append(np.maximum(count, 1), 1)
        first = np.repeat(np.arange(len(count)), count)
        share = (np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)) / count[first]
        second = np.minimum(first + 1, len(count) - 1)
        self.points = self.points[first] + share[:, None] * (self.points[second] - self.points[first])
        self.take(first, "times", *COLUMNS)


class Beads:
    """Axes and heights of the layers at the waypoints: those of the table, or else the normals of planes
    through neighbours in the layer, and the distances along these from the next layer below; of the first
    layer, from the second."""

    def __init__(self, waypoints, config):
        self.waypoints = waypoints
        plate = config.get("build_plate", "z-")
        axis, sign = "xyz".index(plate[0]), 1.0 if plate[1] == "-" else -1.0
        self.up = sign * np.eye(3)[axis]
        face = origin_of(config) + (np.array(config["domain"]["size"]) if sign < 0 else 0.0)
        self.above_plate = None if "substrate" in config else (waypoints.points - face) @ self.up
        self.axes = waypoints.axes if waypoints.axes is not None else self.normals()
        self.heights = waypoints.heights if waypoints.heights is not None else self.distances()

    def normals(self):
        axes = np.tile(self.up, (len(self.waypoints.points), 1))
        for own in self.own_points():
            points = self.waypoints.points[own]
            _, near = KDTree(points).query(points, k=min(NEIGHBOURS, len(points)))
            near = points[near.reshape(len(points), -1)]
            sizes, directions = np.linalg.eigh(np.einsum("nki,nkj->nij", *[near - near.mean(axis=1, keepdims=True)] * 2))
            normals = directions[:, :, 0]
            normals = normals * np.where(normals @ self.up < 0, -1.0, 1.0)[:, None]
            plane = sizes[:, 1] > FLAT**2 * np.maximum(sizes[:, 2], 1e-300)
            axes[own[plane]] = normals[plane]
        return axes

    def own_points(self):
        return [np.flatnonzero(self.waypoints.layers == number) for number in range(1, self.waypoints.layers.max() + 1)]

    def distances(self):
        """None with a single layer."""
        layers = self.own_points()
        if len(layers) < 2:
            return None
        points, heights = self.waypoints.points, np.empty(len(self.waypoints.points))
        for place, own in enumerate(layers):
            other = points[layers[place - 1 if place else 1]]
            away = points[own] - other[KDTree(other).query(points[own])[1]]
            found = np.abs(np.einsum("ni,ni->n", away, self.axes[own]))
            usual = np.median(found)
            heights[own] = np.clip(found, 0.5 * usual, 2.0 * usual)
        return heights

    def move(self, at):
        """The waypoints from that height of their layers into the middle."""
        if at == 0.5:
            return
        if self.heights is None:
            raise RunError(f"--at: found {at:g}; allowed: 0.5 where there is one layer without the column height")
        self.waypoints.points = self.waypoints.points + ((0.5 - at) * self.heights)[:, None] * self.axes

    def seem_at(self):
        """1 where the first layer lies a whole layer above the plate, 0 where it lies on it, else None."""
        if self.heights is None or self.above_plate is None:
            return None
        first = self.waypoints.layers == 1
        height = np.median(self.heights[first])
        self.first, self.height = np.median(self.above_plate[first]), height
        return next((at for at in (0, 1) if abs(self.first - at * height) < NEAR_END * height), None)

    def words(self):
        at = self.seem_at()
        return (f"the first layer's waypoints lie {self.first:.3g} above the plate, and layers are {self.height:.3g} high: they "
                f"seem to be at the {'top' if at else 'bottom'} of the beads; --at {at} says so")
