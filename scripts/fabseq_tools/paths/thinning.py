# SPDX-License-Identifier: MIT
"""Fewer points on a path that still keep to it (Douglas and Peucker, 1973).

Between two kept points the torch moves straight, turns evenly and has one speed. For each waypoint left out,
three deviations count: its distance from the straight way, the angle between its axis and the one that the
torch has there, and the ratio of its step's feed to the mean feed of the way. None may exceed its
tolerance."""

import dataclasses

import numpy as np


@dataclasses.dataclass
class Tolerances:
    """`distance`: a length; `angle`: degrees; `feed`: ratio less 1."""

    distance: float
    angle: float
    feed: float = 0.1


def kept(points, axes, feeds, tolerances):
    """Numbers of the waypoints that are kept, ascending, with the first and the last. `axes`: unit
    vectors."""
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    along, step_feeds = np.insert(np.cumsum(steps), 0, 0.0), 0.5 * (feeds[1:] + feeds[:-1])
    wire = np.insert(np.cumsum(steps * step_feeds), 0, 0.0)
    result, ways = {0, len(points) - 1}, [(0, len(points) - 1)]
    while ways:
        first, last = ways.pop()
        if last - first < 2:
            continue
        worst, place = deviation(points[first:last + 1], axes[first:last + 1], tolerances)
        own, mean = slice(first, last + 1), (wire[last] - wire[first]) / max(along[last] - along[first], 1e-300)
        ratio = np.abs(step_feeds[first:last] / max(mean, 1e-300) - 1.0).max() / tolerances.feed
        if ratio > worst:  # where most wire is missing or too much
            worst, place = ratio, 1 + int(np.argmax(np.abs(wire[own] - wire[first] - mean * (along[own] - along[first]))[1:-1]))
        if worst > 1.0:
            result.add(first + place)
            ways += [(first, first + place), (first + place, last)]
    return np.array(sorted(result))


def deviation(points, axes, tolerances):
    """The largest of the inner points of a way from its ends', over the tolerance, and where it is."""
    way = points[-1] - points[0]
    length = way @ way
    share = np.clip((points - points[0]) @ way / length, 0.0, 1.0) if length > 0 else np.linspace(0.0, 1.0, len(points))
    distances = np.linalg.norm(points - points[0] - share[:, None] * way, axis=1)
    angles = angle_between(axes, turned(axes[0], axes[-1], share))
    worst = np.maximum(distances / tolerances.distance, np.degrees(angles) / tolerances.angle)[1:-1]
    place = int(np.argmax(worst))
    return worst[place], place + 1


def turned(first, last, share):
    """Unit vectors on the shortest way from one to another, (n, 3)."""
    angle = angle_between(first[None], last[None])[0]
    if angle < 1e-9:
        return np.tile(first, (len(share), 1))
    parts = np.sin(np.stack([1.0 - share, share]) * angle) / np.sin(angle)
    result = parts[0][:, None] * first + parts[1][:, None] * last
    return result / np.linalg.norm(result, axis=1)[:, None]


def angle_between(one, other):
    """Radians between unit vectors, row by row."""
    return 2.0 * np.arctan2(np.linalg.norm(one - other, axis=1), np.linalg.norm(one + other, axis=1))


def speeds_of_ways(points, speeds, numbers):
    """Of the ways between kept waypoints, for which they take as long as through all of them; one fewer than
    these. `speeds`: at all waypoints."""
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    seconds = steps * 0.5 * (1.0 / speeds[1:] + 1.0 / speeds[:-1])
    ways = np.add.reduceat(steps, numbers[:-1])
    return ways / np.add.reduceat(seconds, numbers[:-1])
