# SPDX-License-Identifier: MIT
"""Files of torch paths: tables of waypoints, print points of COMPAS Slicer, targets of IRBCAM."""

import json

import numpy as np

from fabseq_tools.paths.frames import across_travel, euler_angles
from fabseq_tools.run.command_line import write_rows

COLUMNS = ("order", "layer", "pass", "kind", "x", "y", "z", "axis_x", "axis_y", "axis_z", "height", "spacing", "feed",
           "level", "speed", "pause")
RAPID = -1.0  # velocity of a way without deposition, for IRBCAM


def rows_of(passes, feeds, speeds, pauses):
    """A row of COLUMNS per waypoint. `feeds`, `speeds`: of the waypoints of each pass; `pauses`: seconds
    after each layer, by number."""
    rows = []
    for number, (one, feed, speed) in enumerate(zip(passes, feeds, speeds), start=1):
        for kind, *values in zip(one.kinds, *one.points.T, *one.axes.T, one.heights, one.spacings, feed, one.levels, speed):
            rows.append((len(rows) + 1, one.layer, number, str(kind), *map(float, values), 0.0))
        if number == len(passes) or passes[number].layer != one.layer:
            rows[-1] = (*rows[-1][:-1], pauses.get(one.layer, 0.0))
    return rows


def write_table(path, rows):
    write_rows(path, [dict(zip(COLUMNS, (format(value, ".7g") if isinstance(value, float) else value for value in row)))
                      for row in rows], list(COLUMNS))


def write_compact(path, content):
    with open(path, "w", encoding="utf-8") as file:
        json.dump(content, file, separators=(",", ":"))
        file.write("\n")


def rounded(vector):
    return [round(float(value), 7) for value in vector]


def compas_points(passes, rows, facts):
    """Print points as COMPAS Slicer's output_printpoints_dict gives them: numbers of waypoints as keys, and
    no others, so that each point has the `facts` of its coordinates."""
    result, rows = {}, iter(rows)
    for one in passes:
        across, y_axes = across_travel(one), np.cross(-one.axes, one.x_axes)
        for number, row in zip(range(len(one.points)), rows):
            point, row = rounded(one.points[number]), dict(zip(COLUMNS, row))
            result[str(len(result))] = {
                "point": point, "layer_height": round(float(one.heights[number]), 7), "mesh_normal": rounded(across[number]),
                "up_vector": rounded(one.axes[number]),
                "frame": {"point": point, "xaxis": rounded(one.x_axes[number]), "yaxis": rounded(y_axes[number])},
                "extruder_toggle": number + 1 < len(one.points), "velocity": None, "wait_time": None, "blend_radius": None,
                "closest_support_pt": None, "distance_to_support": None, "is_feasible": True,
                "attributes": {**{name: row[name] for name in ("layer", "pass", "kind")},
                               **{name: round(row[name], 7) for name in ("spacing", "feed", "level")}, **facts}}
    return result


def irbcam_targets(passes, ways, millimetres, speed, retract):
    """Position in millimetres, angles rz1, ry, rz2 in radians and velocity of each target, and of the
    waypoint next to it layer, height, spacing and level, (n, 11). The torch points against the axis; it comes
    to the first start and leaves the last end by `retract`, and moves along `ways`, a list of points after
    each pass but the last, in between. `millimetres`: length of the unit that the passes, ways and `retract`
    are in."""
    first, last = passes[0], passes[-1]
    before = [first.points[:1] + retract * first.axes[:1], *(way[len(way) // 2:] for way in ways)]
    after = [*(way[:len(way) // 2] for way in ways), last.points[-1:] + retract * last.axes[-1:]]
    parts = []
    for one, coming, leaving in zip(passes, before, after):
        count = len(one.points)
        points = np.concatenate([coming, one.points, leaving])
        next_to = np.clip(np.arange(len(points)) - len(coming), 0, count - 1)  # the waypoint of each target
        velocity = np.repeat([RAPID, float(speed), RAPID], [len(coming), count, len(leaving)])
        own = np.column_stack([np.full(count, one.layer), millimetres * one.heights, millimetres * one.spacings, one.levels])
        parts.append((millimetres * points, one.x_axes[next_to], -one.axes[next_to], velocity, own[next_to]))
    points, x_axes, tool, velocity, own = map(np.concatenate, zip(*parts))
    return np.column_stack([points, euler_angles(x_axes, tool), velocity, own])


def write_irbcam(path, targets, facts):
    """As table (angles in degrees) and as JSON (in radians), without the file's ending. `facts`: of the
    coordinates, for the JSON file."""
    with open(path + ".csv", "w", encoding="utf-8") as file:
        file.write("x,y,z,rz1,ry,rz2,motion_type,velocity,tool_number,spindle_speed\n")
        for x, y, z, *angles, velocity in targets[:, :7]:
            numbers = [f"{value:.6f}" for value in (x, y, z, *np.degrees(angles))]
            file.write(",".join([*numbers, "0", f"{velocity:g}", "1", "0"]) + "\n")
    changes = np.flatnonzero(np.append(True, np.diff(targets[:, 6]) != 0))
    names = ("pX", "pY", "pZ", "rZ", "rY", "rz2")
    write_compact(path + ".json", {
        "targets": {**{name: rounded(targets[:, k]) for k, name in enumerate(names)}, "type": [0] * len(targets)},
        "velocity": {"i": changes.tolist(), "value": targets[changes, 6].tolist()},
        "tool": {"i": [0], "value": [1]}, "spindle": {"i": [0], "value": [0.0]},
        "waypoints_of_targets": {"layer": targets[:, 7].astype(int).tolist(), "height": rounded(targets[:, 8]),
                                 "spacing": rounded(targets[:, 9]), "level": rounded(targets[:, 10])}, **facts})
