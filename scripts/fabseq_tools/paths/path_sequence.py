# SPDX-License-Identifier: MIT
"""The pseudo-time of all elements that torch paths mean, with build direction and local thickness."""

import numpy as np
from scipy.spatial import KDTree

from fabseq_tools.geometry.grid import element_centres, element_edges
from fabseq_tools.paths.hermite import interpolate

OTHER_LAYERS = 2   # before and after that of the nearest waypoint, which an element may belong to
NEIGHBOURS = 20    # waypoints that say when an element is built
FEWEST = 5         # of them
FARTHEST = 2       # layers from that of the element's first guess, beyond which a waypoint is not heard
AGREE = 1.0        # of a layer: what one may differ by from that guess, to be heard
REACH = 2.0        # spacings: beyond it, an element is in no bead
BEYOND = 0.5       # of the waypoints' range: so far outside it an element's slope may lie where layers meet
PLANE = 1e-5       # relative: waypoints whose slopes differ by less lie in parallel planes
WITHIN = 0.02      # of a layer: so far an element's time stays from the ends of its layer
STEP = 0.5         # between waypoints, in elements or spacings


def sequence_fields(waypoints, config, exact):
    """Fields [z][y][x] by name, as the docstring of import_paths.py has them. `exact`: axes and heights are
    the table's own."""
    edges = np.array(element_edges(config))
    spacing = np.median(waypoints.spacings) if exact and waypoints.spacings is not None else 0.0
    waypoints.filled(STEP * max(edges.min(), spacing) * (1.0 + 1e-6))
    counts = config["domain"]["elements"]
    centres = element_centres(config, np.indices(counts[::-1]).reshape(len(counts), -1).T)
    if waypoints.layers is None:
        fields = {"time": waypoints.times[KDTree(waypoints.points).query(centres)[1]]}
    elif exact:
        fields = exact_fields(waypoints, centres)
    else:
        fields = nearest_fields(waypoints, centres)
    return {name: values.reshape(*counts[::-1], *values.shape[1:]) for name, values in fields.items()}


def nearest_fields(waypoints, centres):
    """Each element takes the layer of the waypoint next to it."""
    chosen = KDTree(waypoints.middles()).query(centres)[1]
    layer, count = waypoints.layers[chosen], waypoints.layers.max()
    level = np.full(len(centres), 0.5)
    if waypoints.heights is not None:
        level = np.clip(Predictions(waypoints, centres, chosen).levels, WITHIN, 1.0 - WITHIN)
    return {"time": (layer - 1 + level) / count, "layer": layer}


def usual_spacing(waypoints):
    return np.median(waypoints.spacings if waypoints.spacings is not None else waypoints.heights)


class Predictions:
    """What the `chosen` waypoints (n) or (n, k) say of elements. `levels`: how high these lie in the
    waypoint's layer, 0 at its lower side and 1 at its upper; `distances`: from the middle of its bead, in
    half heights and half spacings."""

    def __init__(self, waypoints, centres, chosen):
        away = centres.reshape(-1, *[1] * (chosen.ndim - 1), 3) - waypoints.points[chosen]
        above = np.einsum("...i,...i->...", away, waypoints.axes[chosen])
        heights = np.maximum(waypoints.heights[chosen], 1e-300)
        aside = np.sqrt(np.maximum((away**2).sum(axis=-1) - above**2, 0.0))
        self.levels = waypoints.levels[chosen] + above / heights
        self.distances = np.hypot(2.0 * self.levels - 1.0, 2.0 * aside / usual_spacing(waypoints))


def exact_fields(waypoints, centres):
    """An element's layer is first that of the waypoint whose bead it is nearest to. Then the waypoints around
    it, which say where their layers lie and along which axis these grow, say where it lies."""
    count = waypoints.layers.max()
    away, around = KDTree(waypoints.points).query(centres, k=min(NEIGHBOURS, len(waypoints.points)))
    around = around.reshape(len(centres), -1)
    near = nearest_bead(waypoints, centres, waypoints.layers[around])
    first = Predictions(waypoints, centres, near)
    start = waypoints.layers[near] - 1 + first.levels
    found = Predictions(waypoints, centres, around)
    layers = waypoints.layers[around]
    heights = layers - 1 + found.levels  # in layers
    agree = (np.abs(layers - waypoints.layers[near][:, None]) <= FARTHEST) & (np.abs(heights - start[:, None]) < AGREE)
    slopes = waypoints.axes / waypoints.heights[:, None]
    height, slope = start.copy(), slopes[near]
    in_bead = away.reshape(len(centres), -1)[:, 0] < REACH * usual_spacing(waypoints)
    chosen = np.flatnonzero((agree.sum(axis=1) >= FEWEST) & in_bead)
    low, high = ends(slopes[around[chosen]], agree[chosen])
    varied = (high - low).max(axis=1) > PLANE * np.abs(high).max(axis=1)
    chosen, low, high = chosen[varied], low[varied], high[varied]
    if len(chosen):
        nodes, room = around[chosen], BEYOND * (high - low)
        result = interpolate(centres[chosen], waypoints.points[nodes], layers[chosen] - 1 + waypoints.levels[nodes],
                             slopes[nodes], agree[chosen])
        good = np.abs(result[0] - start[chosen]) < AGREE
        height[chosen[good]], slope[chosen[good]] = result[0][good], np.clip(result[1], low - room, high + room)[good]
    layer = np.clip(np.ceil(height), 1, count).astype(int)
    time = (layer - 1 + np.clip(height - (layer - 1), WITHIN, 1.0 - WITHIN)) / count
    length = np.linalg.norm(slope, axis=1)
    direction = np.where(length[:, None] > 1e-300, slope / np.maximum(length, 1e-300)[:, None], waypoints.axes[near])
    thickness = np.clip(1.0 / np.maximum(length, 1e-300), waypoints.heights.min(), waypoints.heights.max())
    return {"time": time, "layer": layer, "build_direction": direction, "local_thickness": thickness,
            "time_gradient": direction / (count * thickness)[:, None]}


def ends(values, counts):
    """The least and the largest, (n, 3) each, of the values (n, k, 3) of waypoints around; `counts` (n, k):
    which of them are heard."""
    heard = counts[..., None]
    return np.where(heard, values, np.inf).min(axis=1), np.where(heard, values, -np.inf).max(axis=1)


def nearest_bead(waypoints, centres, around):
    """The waypoint whose bead an element is nearest to. `around` (n, k): layers of the waypoints around it.
    In each layer near one of these the waypoint next to the element is compared."""
    best, result = np.full(len(centres), np.inf), np.zeros(len(centres), int)
    for number in range(1, waypoints.layers.max() + 1):
        near = np.flatnonzero((np.abs(around - number) <= OTHER_LAYERS).any(axis=1))
        own = np.flatnonzero(waypoints.layers == number)
        if len(near):
            chosen = own[KDTree(waypoints.points[own]).query(centres[near])[1]]
            distance = Predictions(waypoints, centres[near], chosen).distances
            nearer = distance < best[near]
            result[near[nearer]], best[near[nearer]] = chosen[nearer], distance[nearer]
    return result
