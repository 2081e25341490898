# SPDX-License-Identifier: MIT
"""Which points the shapes of a config hold, found independently of the program."""

import numpy as np


def contains(shape, points, slack):
    """Which of `points` (n, dimension) a shape holds, or has at most `slack` away."""
    kind, value = next(iter(shape.items()))
    if kind in ("union", "intersection", "difference"):
        first, *others = [contains(child, points, slack) for child in value]
        for other in others:
            first = first | other if kind == "union" else first & other if kind == "intersection" else first & ~other
        return first
    if kind == "box":
        return np.all((points >= np.array(value["min"]) - slack) & (points <= np.array(value["max"]) + slack), axis=1)
    if kind == "half_space":
        normal = np.array(value["normal"], dtype=float)
        return (points - value["point"]) @ normal <= slack * np.linalg.norm(normal)
    if kind == "sphere":
        return np.linalg.norm(points - value["center"], axis=1) <= value["radius"] + slack
    if kind == "cylinder":
        axis = np.subtract(value["to"], value["from"]).astype(float)
        length = np.linalg.norm(axis)
        along = (points - value["from"]) @ (axis / length)
        radius = np.linalg.norm(points - value["from"] - np.outer(along, axis / length), axis=1)
        return (along >= -slack) & (along <= length + slack) & (radius <= value["radius"] + slack)
    if kind == "polygon":
        return in_polygon(np.array(value["points"], dtype=float),
                          np.delete(points, "xyz".index(value["axis"]), axis=1) if "axis" in value else points, slack)
    raise ValueError(kind)


def in_polygon(corners, points, slack):
    """By the angle that the outline turns around a point, or because an edge is near."""
    turned, near = np.zeros(len(points)), np.zeros(len(points), bool)
    for start, end in zip(corners, np.roll(corners, -1, axis=0)):
        to_start, to_end = (start - points) @ [1, 1j], (end - points) @ [1, 1j]
        with np.errstate(divide="ignore", invalid="ignore"):
            turned += np.nan_to_num(np.angle(to_end / to_start))
        edge = end - start
        along = np.clip((points - start) @ edge / (edge @ edge), 0.0, 1.0)
        near |= np.linalg.norm(points - start - along[:, None] * edge, axis=1) <= slack
    return near | (np.abs(turned) > np.pi)
