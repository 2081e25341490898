# SPDX-License-Identifier: MIT
"""Waypoints of a table, and at which height of their beads they lie."""

import numpy as np
from scipy.spatial import KDTree

from fabseq_tools.geometry.grid import plate_height, up_of
from fabseq_tools.geometry.length_columns import lengths, usual_unit
from fabseq_tools.paths.deposited import deposited
from fabseq_tools.run.command_line import RunError

AXIS = ("axis_x", "axis_y", "axis_z")
COLUMNS = ("layers", "given", "passes", "heights", "spacings", "axes", "levels")  # of waypoints, which may be missing
NEIGHBOURS = 12      # in the layer, which a plane is laid through
FLAT = 0.05          # ratio of the second to the largest extent of these: below, they lie in a line
NEAR_END = 0.2       # of a layer's height: so near to its top or bottom waypoints seem to lie there


class Waypoints:
    """Of those at which something is deposited, in the order of deposition: `points` (n, 3) in the config's
    coordinates; `layers` from 1, or None; `given`: layers of the table, from 1; `times`: share of the
    waypoints up to each; `axes`, `heights`, `spacings`, `levels` (of the points in their layers, from 0 to
    1): None if the table has none. `words`: lines of text on what was left out or sorted."""

    def __init__(self, table, placement, placed=False):
        unit = placement.millimetres if placed else usual_unit(placement.millimetres)
        if "layer" not in table.header and "order" not in table.header:
            raise RunError(f"{table.path}: the first line names neither a column layer nor order; needed: one of them")
        kept, self.words = deposited(table)
        gaps, table = np.cumsum(~kept)[kept], table.taken(kept)
        self.points = placement.to_config(lengths(table, ["x", "y", "z"], unit))

        def length(name):
            return lengths(table, [name], unit)[:, 0] / placement.scale if name in table.header else None

        self.layers = table.whole_numbers("layer") if "layer" in table.header else None
        self.given = None if self.layers is None else np.unique(self.layers, return_inverse=True)[1].ravel() + 1
        self.passes = table.column("pass") if "pass" in table.header else None
        if self.passes is not None:  # what was left out ends a pass
            self.passes = np.unique(np.column_stack([self.passes, gaps]), axis=0, return_inverse=True)[1].ravel()
        self.heights, self.spacings = length("height"), length("spacing")
        for name, values in (("height", self.heights), ("spacing", self.spacings)):
            if values is not None and not values.min() > 0:
                place = int(np.argmin(values))
                raise table.refusal(name, f"{values[place]:g}", table.places[place], "a length above 0")
        self.levels = table.column("level") if "level" in table.header else None
        self.times = (np.arange(len(table.rows)) + 0.5) / len(table.rows)
        self.axes = None
        if all(name in table.header for name in AXIS):
            given = table.numbers(list(AXIS))
            if not (lengths_of_axes := np.linalg.norm(given, axis=1)).min() > 0:
                place = int(np.argmin(lengths_of_axes))
                raise table.refusal(AXIS[0], "0,0,0", table.places[place], "axes that point from the plate along the torch")
            axes = given @ np.linalg.inv(placement.inverse).T
            self.axes = axes / np.maximum(np.linalg.norm(axes, axis=1), 1e-300)[:, None]
        self.sort(table)

    def sort(self, table):
        """By the column order, if there is one, against which layers do not count."""
        order = table.column("order") if "order" in table.header else None
        layers = self.layers
        if order is None:
            if layers is not None and (np.diff(layers) < 0).any():
                self.words.append("lines go back to lower layers: layers count, as there is no column order")
        elif layers is not None and len(np.unique(order)) < len(order):
            self.words.append("numbers of the column order repeat: they count within each layer")
            self.take(np.lexsort([order, layers]), "points", *COLUMNS)
        else:
            self.take(np.argsort(order, kind="stable"), "points", *COLUMNS)
        if layers is None:
            return
        if order is None:
            self.layers = self.given
            return
        runs = np.append(0, np.cumsum(np.diff(self.layers) != 0)) + 1
        if runs[-1] > self.given.max():
            self.words.append(
                f"the column order goes back to earlier layers: {self.given.max()} of the table are {runs[-1]} in this order")
        elif (np.diff(self.layers) < 0).any():
            self.words.append("the column order builds the layers in another order than that of their numbers")
        self.layers = runs

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
        for name in ("points", "axes", "heights", "spacings", "levels"):
            if (values := getattr(self, name)) is not None:
                along = share.reshape(-1, *[1] * (values.ndim - 1))
                setattr(self, name, values[first] + along * (values[second] - values[first]))
        if self.axes is not None:
            self.axes = self.axes / np.maximum(np.linalg.norm(self.axes, axis=1), 1e-300)[:, None]
        self.take(first, "times", "layers", "given", "passes")

    def middles(self):
        """Of the waypoints' layers, above or below them; the points themselves without known heights."""
        if self.heights is None:
            return self.points
        return self.points + ((0.5 - self.levels) * self.heights)[:, None] * self.axes


class Beads:
    """Completes the axes, heights and levels of waypoints where the table has none: normals of planes through
    neighbours in the layer; distances along these from the next layer below, of the first layer from the
    second (none with a single layer); `at`."""

    def __init__(self, waypoints, config, at):
        self.waypoints = waypoints
        self.up = up_of(config)
        self.above_plate = None if "substrate" in config else waypoints.points @ self.up - plate_height(config)
        waypoints.axes = waypoints.axes if waypoints.axes is not None else self.normals()
        waypoints.heights = waypoints.heights if waypoints.heights is not None else self.distances()
        if waypoints.heights is None and at != 0.5:
            raise RunError(f"--at: found {at:g}; allowed: 0.5 where there is one layer without the column height")
        self.given_levels = waypoints.levels is not None
        if not self.given_levels:
            waypoints.levels = np.full(len(waypoints.points), at)

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
        return [np.flatnonzero(self.waypoints.given == number) for number in range(1, self.waypoints.given.max() + 1)]

    def distances(self):
        """None with a single layer."""
        layers = self.own_points()
        if len(layers) < 2:
            return None
        points, heights = self.waypoints.points, np.empty(len(self.waypoints.points))
        for place, own in enumerate(layers):
            other = points[layers[place - 1 if place else 1]]
            away = points[own] - other[KDTree(other).query(points[own])[1]]
            found = np.abs(np.einsum("ni,ni->n", away, self.waypoints.axes[own]))
            usual = np.median(found)
            heights[own] = np.clip(found, 0.5 * usual, 2.0 * usual)
        return heights

    def seem_at(self):
        """1 where the first layer lies a whole layer above the plate, 0 where it lies on it, else None, as
        where the table says where its waypoints lie."""
        heights = self.waypoints.heights
        if heights is None or self.above_plate is None or self.given_levels:
            return None
        first = self.waypoints.given == 1
        height = np.median(heights[first])
        self.first, self.height = np.median(self.above_plate[first]), height
        return next((at for at in (0, 1) if abs(self.first - at * height) < NEAR_END * height), None)

    def words(self):
        at = self.seem_at()
        return (f"the first layer's waypoints lie {self.first:.3g} above the plate, and layers are {self.height:.3g} high: they "
                f"seem to be at the {'top' if at else 'bottom'} of the beads; --at {at} says so")
