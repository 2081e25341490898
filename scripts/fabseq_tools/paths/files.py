# SPDX-License-Identifier: MIT
"""Files of torch paths: tables of waypoints, print points of COMPAS Slicer, targets of IRBCAM."""

import json

import numpy as np

from fabseq_tools.run.command_line import write_rows

COLUMNS = ("order", "layer", "pass", "kind", "x", "y", "z", "axis_x", "axis_y", "axis_z", "height", "spacing", "feed")
RAPID = -1.0  # velocity of a way without deposition, for IRBCAM


def rows_of(passes, nominal):
    """A row of COLUMNS per waypoint. `nominal`: area of a bead's section for which the feed is 1."""
    rows = []
    for number, one in enumerate(passes, start=1):
        for kind, point, axis, height, spacing in zip(one.kinds, one.points, one.axes, one.heights, one.spacings):
            rows.append((len(rows) + 1, one.layer, number, str(kind), *map(float, (*point, *axis)), float(height),
                         float(spacing), float(height * spacing / nominal)))
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
        along = np.gradient(one.points, axis=0)
        across = np.cross(one.axes, along)
        across /= np.maximum(np.linalg.norm(across, axis=1), 1e-300)[:, None]
        first = np.cross(one.axes, across)
        for number, row in zip(range(len(one.points)), rows):
            point = rounded(one.points[number])
            result[str(len(result))] = {
                "point": point, "layer_height": round(float(one.heights[number]), 7), "mesh_normal": rounded(across[number]),
                "up_vector": rounded(one.axes[number]),
                "frame": {"point": point, "xaxis": rounded(first[number]), "yaxis": rounded(across[number])},
                "extruder_toggle": number + 1 < len(one.points), "velocity": None, "wait_time": None, "blend_radius": None,
                "closest_support_pt": None, "distance_to_support": None, "is_feasible": True,
                "attributes": {"layer": row[1], "pass": row[2], "kind": row[3], "feed": round(row[-1], 7), **facts}}
    return result


def irbcam_targets(passes, millimetres, speed, retract):
    """Position in millimetres, angles rz1, ry, rz2 in radians and velocity of each target, (n, 7). The torch
    points against the axis; between passes it moves to `retract` beyond the end and the next start.
    `millimetres`: length of the unit that the passes and `retract` are in."""
    targets = []
    for one in passes:
        points = np.concatenate([one.points[:1] + retract * one.axes[:1], one.points, one.points[-1:] + retract * one.axes[-1:]])
        tool = -np.concatenate([one.axes[:1], one.axes, one.axes[-1:]])
        level = np.hypot(tool[:, 0], tool[:, 1])
        first = np.where(level > 1e-9, np.arctan2(tool[:, 1], tool[:, 0]), 0.0)
        velocity = np.full(len(points), float(speed))
        velocity[[0, -1]] = RAPID
        targets.append(np.column_stack([millimetres * points, first, np.arctan2(level, tool[:, 2]), -first, velocity]))
    return np.concatenate(targets)


def write_irbcam(path, targets, facts):
    """As table (angles in degrees) and as JSON (in radians), without the file's ending. `facts`: of the
    coordinates, for the JSON file."""
    with open(path + ".csv", "w", encoding="utf-8") as file:
        file.write("x,y,z,rz1,ry,rz2,motion_type,velocity,tool_number,spindle_speed\n")
        for x, y, z, *angles, velocity in targets:
            numbers = [f"{value:.6f}" for value in (x, y, z, *np.degrees(angles))]
            file.write(",".join([*numbers, "0", f"{velocity:g}", "1", "0"]) + "\n")
    changes = np.flatnonzero(np.append(True, np.diff(targets[:, 6]) != 0))
    names = ("pX", "pY", "pZ", "rZ", "rY", "rz2")
    write_compact(path + ".json", {
        "targets": {**{name: rounded(targets[:, k]) for k, name in enumerate(names)}, "type": [0] * len(targets)},
        "velocity": {"i": changes.tolist(), "value": targets[changes, 6].tolist()},
        "tool": {"i": [0], "value": [1]}, "spindle": {"i": [0], "value": [0.0]}, **facts})
