#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Reads torch paths back as a sequence, which fabseq simulates and checks like its own.

    scripts/use/import_paths.py PATHS.csv CONFIG [--output SEQUENCE.h5] [--at SHARE]

PATHS.csv has a line per waypoint. Its first line names the columns: x, y, z, in the part's own coordinates,
and layer, a whole number, or order. Further columns of paths.csv of export_paths.py are used where they are
there: axis_x, axis_y, axis_z and height tell layers apart, spacing says how far apart beads lie, and pass
that the way between two waypoints is deposited. CONFIG is the config.json of a run or its directory; a config
of a part from a mesh does not say where the mesh lies, so that a run's is needed.

Each element takes the layer of the waypoint next to it, or its order if there are no layers. SEQUENCE.h5
(default: PATHS_sequence.h5 beside the table) holds the pseudo-time. --at: height of the waypoints in their
layer, from 0 to 1 (default: 0.5); another one needs the columns of axis and height. Prints the command that
simulates the sequence.
"""

import os

from command_line import RunError, parser_of, run_script  # before any package

import h5py
import numpy as np

from layer_bodies import Placement
from measured_points import numbers, read_table
from nearest_points import nearest
from read_run import origin_of, read_config
from report_views import element_edges

OTHER_LAYERS = 2  # before and after that of the nearest waypoint, which an element may belong to
AXIS = ("axis_x", "axis_y", "axis_z")
COLUMNS = ("layers", "passes", "heights", "spacings", "axes")  # of waypoints, which may be missing


def main():
    parser = parser_of(__doc__)
    parser.add_argument("paths")
    parser.add_argument("config")
    parser.add_argument("--output", help="HDF5 file (default: PATHS_sequence.h5)")
    parser.add_argument("--at", type=float, default=0.5, help="height of waypoints in the layer (default: %(default)s)")
    arguments = parser.parse_args()
    path = arguments.config
    path = os.path.join(path, "config.json") if os.path.isdir(path) else path
    config = checked_config(read_config(path), path)
    output = arguments.output or os.path.splitext(arguments.paths)[0] + "_sequence.h5"
    time, layer = sequence(Waypoints(arguments.paths, config, arguments.at), config)
    with h5py.File(output, "w") as file:
        file["time"] = time
        if layer is not None:
            file["layer"] = layer
    count = int(layer.max()) if layer is not None else None
    layers = f" -set 'layers={{\"type\": \"curved\", \"count\": {count}}}'" if count else ""
    print(f"{output}: {f'{count} layers' if count else 'an order without layers'}; simulate it with")
    print(f"fabseq -config {path} -task simulate -sequence {output}{layers} -binary -output OUTPUT")


def checked_config(config, path):
    domain = config.get("domain", {})
    if "elements" not in domain or "mesh" in config.get("part", {}) and "mesh_placement" not in config.get("run", {}):
        raise RunError(f"{path}: does not say where the part's mesh lies; allowed: the config.json of a run")
    if len(domain["elements"]) != 3:
        raise RunError(f"{path}: /domain/elements: found {len(domain['elements'])} numbers; allowed: 3, paths are in 3D")
    return config


class Waypoints:
    """`points` (n, 3) in the middle of their layers, in the config's coordinates; `layers` from 1, or None;
    `times`: share of the waypoints up to each; `axes`, `heights`, `spacings`: None if the table has none."""

    def __init__(self, path, config, at):
        header, rows = read_table(path)
        placement = Placement(config)
        self.points = placement.to_config(numbers(path, header, rows, ["x", "y", "z"]))
        if "layer" not in header and "order" not in header:
            raise RunError(f"{path}: the first line names neither a column layer nor order; needed: one of them")

        def column(name, unit=1.0):
            return numbers(path, header, rows, [name])[:, 0] / unit if name in header else None

        self.layers, self.passes = column("layer"), column("pass")
        self.heights, self.spacings = column("height", placement.scale), column("spacing", placement.scale)
        self.times = (np.arange(len(rows)) + 0.5) / len(rows)
        self.axes = None
        if all(name in header for name in AXIS):
            axes = numbers(path, header, rows, list(AXIS)) @ np.linalg.inv(placement.inverse).T
            self.axes = axes / np.linalg.norm(axes, axis=1)[:, None]
        if at != 0.5:
            if self.axes is None or self.heights is None:
                raise RunError(f"--at: found {at:g}; allowed: 0.5, or {path} with the columns {', '.join(AXIS)}, height")
            self.points = self.points + ((0.5 - at) * self.heights)[:, None] * self.axes
        if "order" in header:
            self.take(np.argsort(column("order"), kind="stable"), "points", *COLUMNS)
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


def sequence(waypoints, config):
    """Pseudo-time of all elements [z][y][x], and their layers, None where the table has none."""
    edges = np.array(element_edges(config))
    waypoints.filled(0.5 * edges.min())
    counts = config["domain"]["elements"]
    axes = [origin + edge * (np.arange(n) + 0.5) for origin, edge, n in zip(origin_of(config), edges, counts)]
    centres = np.stack([grid.ravel() for grid in np.meshgrid(*axes[::-1], indexing="ij")[::-1]], axis=1)
    if waypoints.layers is None:
        return waypoints.times[nearest(waypoints.points, centres)[0]].reshape(counts[::-1]), None
    first = waypoints.layers[nearest(waypoints.points, centres)[0]]
    layer = first.copy()
    best = np.full(len(centres), np.inf)
    for number in range(1, waypoints.layers.max() + 1):
        near = np.flatnonzero(np.abs(first - number) <= OTHER_LAYERS)
        if len(near):
            distance = distances(waypoints, np.flatnonzero(waypoints.layers == number), centres[near])
            layer[near[distance < best[near]]] = number
            best[near] = np.minimum(best[near], distance)
    return ((layer - 0.5) / layer.max()).reshape(counts[::-1]), layer.reshape(counts[::-1])


def distances(waypoints, own, centres):
    """How far elements are from a layer's waypoints: where axes and heights are known, relative to half the
    height along the axis, and to a bead's spacing across it."""
    found, distance = nearest(waypoints.points[own], centres)
    if waypoints.axes is None or waypoints.heights is None:
        return distance
    chosen = own[found]
    above = np.einsum("ni,ni->n", centres - waypoints.points[chosen], waypoints.axes[chosen])
    aside = np.sqrt(np.maximum(distance**2 - above**2, 0.0))
    spacing = np.median(waypoints.spacings if waypoints.spacings is not None else waypoints.heights)
    return np.hypot(2.0 * above / np.maximum(waypoints.heights[chosen], 1e-300), aside / spacing)


if __name__ == "__main__":
    run_script(main)
