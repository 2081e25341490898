# SPDX-License-Identifier: MIT
"""Waypoints of a torch that deposits a layered part: passes over all layers, with what the machine needs to
know at each waypoint."""

import dataclasses

import numpy as np
from scipy.spatial import KDTree

from fabseq_tools.paths.layer_paths import SHORTEST, PathSurface
from fabseq_tools.paths.order import ordered, passes
from fabseq_tools.run.command_line import RunError
from fabseq_tools.run.progress import SILENT

STEP = 0.5          # between waypoints, in beads
LONGEST_LINK = 1.5  # ways between lines up to so many beads are deposited, without a stop
OFF_SURFACE = 0.4   # so far may such a way be off the layer, in beads
FAR = 1.0           # from a path, in beads: beyond it nothing is welded
WINDOW = 5          # waypoints over which axes, heights and spacings are averaged


@dataclasses.dataclass
class Pass:
    """What is deposited from a start to a stop. Arrays have a row per waypoint: `points` and unit `axes` (n,
    3), local `heights` and `spacings` of the bead, `kinds` (outline, hatch or link), `levels` in the layer
    (0 at its lower side, 1 at its upper), and unit `x_axes` of the tool's frames (frames.py). Of its whole
    layer: `missed`, the share of the area that is farther than a bead from all paths, and `farthest`, how
    far."""

    layer: int
    points: np.ndarray
    kinds: np.ndarray
    axes: np.ndarray = None
    heights: np.ndarray = None
    spacings: np.ndarray = None
    levels: np.ndarray = None
    x_axes: np.ndarray = None
    missed: float = 0.0
    farthest: float = 0.0

    def lengths(self):
        """Of the bead that each waypoint stands for."""
        steps = np.linalg.norm(np.diff(self.points, axis=0), axis=1)
        return 0.5 * (np.append(steps, 0.0) + np.insert(steps, 0, 0.0))


def all_passes(part, width, outlines, angle, turn, at, progress=SILENT):
    """Passes of all layers, in order; a layer smaller than a bead has none. `angle`: of the hatch, `turn`:
    what is added to it in each layer, `at`: height of the waypoints in the layer, from 0 to 1. The thin ends
    of layers become part of their neighbours."""
    part.join_thin_ends()
    result, position = [], None
    for count, layer in enumerate(progress.steps(part.layers.values(), "paths of layer")):
        surface = PathSurface(part, layer, width)
        lines = ordered(surface.lines(outlines, angle + count * turn), position, LONGEST_LINK * width)
        found = [joined(layer.number, lines, width) for lines in
                 passes(lines, LONGEST_LINK * width, lambda a, b, s=surface: on_surface(s, a, b))]
        found = [one for one in found if one.lengths().sum() > SHORTEST * width]
        if found:
            complete(part, surface, found, at)
            position = found[-1].points[-1]
        result += found
    if not result:
        raise RunError(f"--bead-width: found {width:g}; allowed: less, no layer holds a bead so wide")
    return result


def on_surface(surface, start, end):
    ways = start + np.linspace(0.0, 1.0, 5)[:, None] * (end - start)
    return KDTree(surface.points).query(ways)[0].max() < OFF_SURFACE * surface.width


def joined(number, lines, width):
    """One pass of lines, with waypoints at even steps."""
    points, kinds = [], []
    for line in lines:
        if points:
            link = resampled(np.array([points[-1][-1], line.points[0]]), STEP * width)[1:-1]
            points.append(link)
            kinds += ["link"] * len(link)
        points.append(resampled(line.points, STEP * width))
        kinds += [line.kind] * len(points[-1])
    points, kinds = np.concatenate([p for p in points if len(p)]), np.array(kinds)
    new = np.append(True, np.linalg.norm(np.diff(points, axis=0), axis=1) > 1e-9 * width)
    return Pass(number, points[new], kinds[new])


def resampled(points, step):
    """Points at even steps along a line, no longer than `step`."""
    along = np.insert(np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1)), 0, 0.0)
    count = max(1, int(np.ceil(along[-1] / step - 1e-9)))
    places = np.linspace(0.0, along[-1], count + 1)
    return np.stack([np.interp(places, along, points[:, k]) for k in range(3)], axis=1)


def complete(part, surface, found, at):
    """Axes of the passes' waypoints from the surface, heights from what the check has judged (judged.py). The
    layer's extent at a waypoint: the volume that is nearer to it than to others over the area that is.
    Spacing: that volume over the height and the length that the waypoint stands for. Moves the waypoints to
    the share `at` of the extent, which is less than the height where the layer ends at the part's surface."""
    points = np.concatenate([one.points for one in found])
    near = KDTree(surface.points).query(points)[1]
    axes, below = surface.directions()[near], surface.below()[near]
    spots, areas = surface.spots()
    waypoints = KDTree(points)
    away, nearest = waypoints.query(spots)
    missed, farthest = areas[away > FAR * surface.width].sum() / areas.sum(), away.max()
    areas = np.bincount(nearest, areas, len(points))
    volumes = np.bincount(waypoints.query(surface.pieces)[1], surface.volumes, len(points))
    first = 0
    for one in found:
        own = slice(first, first + len(one.points))
        first = own.stop
        one.missed, one.farthest = float(missed), float(farthest)
        area, volume = moving_sum(areas[own]), moving_sum(volumes[own])
        axis = np.stack([moving_sum(component) for component in axes[own].T], axis=1)
        one.axes = axis / np.linalg.norm(axis, axis=1)[:, None]
        one.heights = extents = volume / np.maximum(area, 1e-3 * area.max())
        judged = part.judged_beads(surface.layer, points[own])
        if judged:
            one.axes, one.heights = judged
        shift = moving_sum(at * np.minimum(extents, one.heights) - below[own]) / WINDOW
        one.points = one.points + shift[:, None] * one.axes
        if judged:  # there, where the waypoints lie now
            one.axes, one.heights = part.judged_beads(surface.layer, one.points)
        one.levels = part.levels(surface.layer, one.points)
        section = volume / np.maximum(moving_sum(one.lengths()), 1e-12 * surface.width)
        one.spacings = section / np.where(one.heights > 0, one.heights, 1.0)


def moving_sum(values):
    return np.convolve(np.pad(values, WINDOW // 2, mode="reflect" if len(values) > WINDOW else "edge"), np.ones(WINDOW), "valid")


def summary(part, found, up):
    """What each layer takes: starts, lengths, ranges, and volume of wire against that of the layer. `up`:
    unit normal of the plate."""
    volumes = np.bincount(part.body.label, part.body.volumes())
    rows, position = [], None
    for number in part.layers:
        own = [one for one in found if one.layer == number]
        if not own:
            continue
        travel = 0.0
        for one in own:
            travel += 0.0 if position is None else float(np.linalg.norm(one.points[0] - position))
            position = one.points[-1]
        heights = np.concatenate([one.heights for one in own])
        tilts = np.degrees(np.arccos(np.clip(np.concatenate([one.axes for one in own]) @ up, -1.0, 1.0)))
        wire = sum(float((one.lengths() * one.spacings * one.heights).sum()) for one in own)
        rows.append({"layer": number, "starts": len(own), "waypoints": len(heights),
                     "length": float(sum(one.lengths().sum() for one in own)), "travel": travel,
                     "height": [float(heights.min()), float(heights.max())], "angle": [float(tilts.min()), float(tilts.max())],
                     "wire": wire, "volume": float(volumes[number]), "missed": own[0].missed, "farthest": own[0].farthest})
    return rows
