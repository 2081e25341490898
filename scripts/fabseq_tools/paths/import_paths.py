# SPDX-License-Identifier: MIT
"""Makes a sequence of torch paths, which fabseq simulates and checks like its own.

    fabseq-tools import-paths PATHS CONFIG [--output SEQUENCE.h5] [--at SHARE] [--frame drawing|plate]

PATHS is a table (CSV) with a line per waypoint, or the paths.json of `fabseq-tools paths`. The first line of
a table names the columns: x, y, z, and layer, a whole number, or order. Further columns of that command are
used where they are there: axis_x, axis_y, axis_z and height tell layers apart, spacing says how far apart
beads lie, and pass that the way between two waypoints is deposited. CONFIG is the config.json of a run or its
directory; a config of a part from a mesh does not say where the mesh lies, so that a run's is needed.

--frame says whose coordinates and lengths these are: those of the drawing (of its mesh file, in its unit) or
of the build plate (of the config, in domain.unit). Without it, paths.json says so itself, and of a table the
JSON file of the same name beside it, if that has the same waypoints; else they are the drawing's.

Each element takes the layer of the waypoint next to it, or its order if there are no layers. SEQUENCE.h5
(default: PATHS_sequence.h5 beside the table) holds the pseudo-time. --at: height of the waypoints in their
layer, from 0 to 1 (default: 0.5); another one needs the columns of axis and height. Prints the command that
simulates the sequence.
"""

import json
import os

import h5py
import numpy as np
from scipy.spatial import KDTree

from fabseq_tools.geometry.grid import element_edges, origin_of
from fabseq_tools.geometry.placement import FRAMES, Placement
from fabseq_tools.run.command_line import RunError, parser_of
from fabseq_tools.run.read_run import Run, read_config
from fabseq_tools.run.tables import numbers, read_table

COMMAND = "import-paths"

OTHER_LAYERS = 2  # before and after that of the nearest waypoint, which an element may belong to
AXIS = ("axis_x", "axis_y", "axis_z")
LEAST_IN_BOX = 0.5  # of the waypoints: with fewer, they are in other coordinates or in another unit
COLUMNS = ("layers", "passes", "heights", "spacings", "axes")  # of waypoints, which may be missing


def main(words):
    parser = parser_of(__doc__, COMMAND)
    parser.add_argument("paths")
    parser.add_argument("config")
    parser.add_argument("--output", help="HDF5 file (default: PATHS_sequence.h5)")
    parser.add_argument("--at", type=float, default=0.5, help="height of waypoints in the layer (default: %(default)s)")
    parser.add_argument("--frame", choices=FRAMES, help="whose coordinates (default: what paths.json says, or drawing)")
    arguments = parser.parse_args(words)
    path = arguments.config
    path = os.path.join(path, "config.json") if os.path.isdir(path) else path
    config = checked_config(read_config(path), path)
    output = arguments.output or os.path.splitext(arguments.paths)[0] + "_sequence.h5"
    header, rows, frame = read_waypoints(arguments.paths)
    placement = Placement(config, arguments.frame or frame)
    print(f"coordinates of {arguments.paths}: {placement.system} (frame: {placement.frame})"
          f"{f' in {placement.unit}' if placement.unit else ''}")
    waypoints = Waypoints(arguments.paths, header, rows, placement, arguments.at)
    check_box(arguments.paths, waypoints.points, config)
    time, layer = sequence(waypoints, config)
    with h5py.File(output, "w") as file:
        file["time"] = time
        if layer is not None:
            file["layer"] = layer
    count = int(layer.max()) if layer is not None else None
    layers = f" -set 'layers={{\"type\": \"curved\", \"count\": {count}}}'" if count else layers_of_config(config, path)
    print(f"{output}: {f'{count} layers' if count else 'an order without layers'}; simulate it with")
    print(f"fabseq -config {path} -task simulate -sequence {output}{layers} -binary -output OUTPUT")


def layers_of_config(config, path):
    """The option for as many layers as the config's run has, where the config says "auto": the program does
    not look at the constraint that counts them when it simulates a file."""
    if config.get("layers", {}).get("count") != "auto":
        return ""
    try:
        return f" -layers {Run(os.path.dirname(path) or '.', with_fields=False, simulations=True).layer_count()}"
    except RunError:
        return " -layers NUMBER"


def checked_config(config, path):
    domain = config.get("domain", {})
    if "elements" not in domain or "mesh" in config.get("part", {}) and "mesh_placement" not in config.get("run", {}):
        raise RunError(f"{path}: does not say where the part's mesh lies; allowed: the config.json of a run")
    if len(domain["elements"]) != 3:
        raise RunError(f"{path}: /domain/elements: found {len(domain['elements'])} numbers; allowed: 3, paths are in 3D")
    return config


def read_waypoints(path):
    """Names of the columns, rows as texts, and the frame."""
    stem, ending = os.path.splitext(path)
    if ending.lower() == ".json":
        return read_record(path)
    header, rows = read_table(path)
    if not os.path.exists(stem + ".json"):
        return header, rows, "drawing"
    try:
        _, same_rows, frame = read_record(stem + ".json")
    except RunError:  # something else of that name
        return header, rows, "drawing"
    return header, rows, frame if len(same_rows) == len(rows) else "drawing"


def read_record(path):
    """The same of paths.json; before there were frames, all was in the drawing's."""
    with open(path, encoding="utf-8") as file:
        try:
            record = json.load(file)
            header, rows = record["columns"], [list(map(str, row)) for row in record["waypoints"]]
            frame = record.get("frame", "drawing")
        except (ValueError, KeyError, TypeError) as error:
            raise RunError(f"{path}: has no columns and waypoints; allowed: a table (CSV), or paths.json of "
                           "fabseq-tools paths") from error
    if not rows or frame not in FRAMES:
        raise RunError(f"{path}: holds {len(rows)} waypoints, frame {frame}; allowed: one or more, frame {' or '.join(FRAMES)}")
    return header, rows, frame


def check_box(path, points, config):
    """Refuses waypoints most of which lie more than an element outside of the config's box."""
    edges, low = np.array(element_edges(config)), origin_of(config)
    high = low + config["domain"]["size"]
    within = np.all((points >= low - edges) & (points <= high + edges), axis=1)
    if within.mean() >= LEAST_IN_BOX:
        return
    spans = [f"[{','.join(f'{x:.6g}' for x in end)}]" for end in (points.min(axis=0), points.max(axis=0), low, high)]
    raise RunError(f"{path}: {np.count_nonzero(~within)} of {len(points)} waypoints lie outside of the config's box, which goes "
                   f"from {spans[2]} to {spans[3]}: placed there, they go from {spans[0]} to {spans[1]}; allowed: coordinates of "
                   "the drawing in its unit (--frame drawing), or of the config in its own (--frame plate)")


class Waypoints:
    """`points` (n, 3) in the middle of their layers, in the config's coordinates; `layers` from 1, or None;
    `times`: share of the waypoints up to each; `axes`, `heights`, `spacings`: None if the table has none."""

    def __init__(self, path, header, rows, placement, at):
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
        return waypoints.times[KDTree(waypoints.points).query(centres)[1]].reshape(counts[::-1]), None
    first = waypoints.layers[KDTree(waypoints.points).query(centres)[1]]
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
    distance, found = KDTree(waypoints.points[own]).query(centres)
    if waypoints.axes is None or waypoints.heights is None:
        return distance
    chosen = own[found]
    above = np.einsum("ni,ni->n", centres - waypoints.points[chosen], waypoints.axes[chosen])
    aside = np.sqrt(np.maximum(distance**2 - above**2, 0.0))
    spacing = np.median(waypoints.spacings if waypoints.spacings is not None else waypoints.heights)
    return np.hypot(2.0 * above / np.maximum(waypoints.heights[chosen], 1e-300), aside / spacing)
