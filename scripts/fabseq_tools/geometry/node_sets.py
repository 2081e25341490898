# SPDX-License-Identifier: MIT
"""Which nodes a config's shapes and node sets hold, found once more from config and result."""

import numpy as np

from fabseq_tools.geometry.grid import node_positions, nodes_of, origin_of, surface_nodes_of


def measured_nodes(run):
    """Numbers of the nodes whose distortion is a run's first term; empty if the config does not tell them."""
    shape = run.config.get("node_sets", {}).get(run.distortion_config.get("nodes"))
    if shape is None or shape.get("all") or shape.get("surface"):
        return np.array([], dtype=int)  # or so many that marks would hide the part
    try:
        return nodes_of_set(run, shape)
    except NotImplementedError:
        return np.array([], dtype=int)


def nodes_of_set(run, node_set):
    """Numbers of the part's nodes in a node set of a run's config. Samples, what is near the shape and a
    substrate are not looked at. Raises NotImplementedError for polygons."""
    shape = {key: value for key, value in node_set.items() if key not in ("all", "surface", "samples", "within")}
    built = run.fields["density"] > 0
    chosen = surface_nodes_of(built) if node_set.get("surface") else nodes_of(built)
    if shape:
        size = run.config["domain"]["size"]
        slack = 1e-6 * min(length / n for length, n in zip(size, built.shape[::-1]))
        chosen &= contains(shape, node_positions(size, built.shape[::-1]) + origin_of(run.config), slack)
    return np.flatnonzero(chosen)


def contains(shape, points, slack):
    """Which of `points` (n, dimension) a shape of a config holds. Raises NotImplementedError for polygons."""
    kind, value = next((k, v) for k, v in shape.items() if k != "samples")
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
    raise NotImplementedError(kind)
