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
layer, from 0 to 1 (default: 0.5); without the columns of axis and height these follow from the waypoints of
the layer and of the next one below. A warning says where waypoints seem to lie at the top or the bottom of
their layers. Prints the command that simulates the sequence.

Cells stand apart by comma, semicolon or tab; with the last two a decimal comma is taken, too. Columns may
name a unit, such as "x [mm]", which is then converted. UTF-8 and UTF-16 are read.
"""

import json
import os
import shlex

import h5py
import numpy as np
from scipy.spatial import KDTree

from fabseq_tools.geometry.grid import element_edges, origin_of
from fabseq_tools.geometry.placement import FRAMES, Placement
from fabseq_tools.paths.waypoints import Beads, Waypoints
from fabseq_tools.run.command_line import RunError, parser_of, warn
from fabseq_tools.run.read_run import Run, read_config
from fabseq_tools.run.tables import Table, read_table, text_of

COMMAND = "import-paths"

OTHER_LAYERS = 2  # before and after that of the nearest waypoint, which an element may belong to
LEAST_IN_BOX = 0.5  # of the waypoints: with fewer, they are in other coordinates or in another unit
LEAST_EXTENT = 0.02  # of the box's longest edge: paths that reach over less are in another unit
USUAL_FACTORS = 1000.0, 25.4, 10.0, 100.0, 1e6  # between units


def main(words):
    parser = parser_of(__doc__, COMMAND)
    parser.add_argument("paths")
    parser.add_argument("config")
    parser.add_argument("--output", help="HDF5 file (default: PATHS_sequence.h5)")
    parser.add_argument("--at", type=share, default=0.5, help="height of waypoints in the layer (default: %(default)s)")
    parser.add_argument("--frame", choices=FRAMES, help="whose coordinates (default: what paths.json says, or drawing)")
    arguments = parser.parse_args(words)
    path = arguments.config
    path = os.path.join(path, "config.json") if os.path.isdir(path) else path
    config = checked_config(read_config(path), path)
    output = arguments.output or os.path.splitext(arguments.paths)[0] + "_sequence.h5"
    table, frame = read_waypoints(arguments.paths)
    placement = Placement(config, arguments.frame or frame)
    print(f"coordinates of {arguments.paths}: {placement.system} (frame: {placement.frame})"
          f"{f' in {placement.unit}' if placement.unit else ''}")
    waypoints = Waypoints(table, placement)
    check_box(arguments.paths, waypoints.points, config)
    if waypoints.layers is not None:
        beads = Beads(waypoints, config)
        beads.move(arguments.at)
        if arguments.at == 0.5 and beads.seem_at() is not None:
            warn(COMMAND, beads.words())
    elif arguments.at != 0.5:
        raise RunError(f"--at: found {arguments.at:g}; allowed: 0.5 where {arguments.paths} has no column layer")
    time, layer = sequence(waypoints, config)
    with h5py.File(output, "w") as file:
        file["time"] = time
        if layer is not None:
            file["layer"] = layer
    count = int(layer.max()) if layer is not None else None
    layers = f" -set 'layers={{\"type\": \"curved\", \"count\": {count}}}'" if count else layers_of_config(config, path)
    print(f"{output}: {f'{count} layers' if count else 'an order without layers'}; simulate it with")
    print(f"fabseq -config {shlex.quote(path)} -task simulate -sequence {shlex.quote(output)}{layers} -binary -output OUTPUT")


def share(text):
    value = float(text)
    if not 0 <= value <= 1:
        raise ValueError(text)
    return value


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
    """The table and its frame."""
    stem, ending = os.path.splitext(path)
    if ending.lower() == ".json":
        return read_record(path)
    table = read_table(path)
    if not os.path.exists(stem + ".json"):
        return table, "drawing"
    try:
        same, frame = read_record(stem + ".json")
    except RunError:  # something else of that name
        return table, "drawing"
    return table, frame if len(same.rows) == len(table.rows) else "drawing"


def read_record(path):
    """The same of paths.json; before there were frames, all was in the drawing's."""
    try:
        record = json.loads(text_of(path))
        header, rows = list(map(str, record["columns"])), [list(map(str, row)) for row in record["waypoints"]]
        frame = record.get("frame", "drawing")
    except (ValueError, KeyError, TypeError, RecursionError) as error:
        raise RunError(f"{path}: has no columns and waypoints; allowed: a table (CSV), or paths.json of "
                       "fabseq-tools paths") from error
    if not rows or frame not in FRAMES:
        raise RunError(f"{path}: holds {len(rows)} waypoints, frame {frame}; allowed: one or more, frame {' or '.join(FRAMES)}")
    return Table(path, header, rows, [f"waypoint {number}" for number in range(1, len(rows) + 1)]), frame


def check_box(path, points, config):
    """Refuses waypoints most of which lie more than an element outside of the config's box, or that reach
    over next to nothing of it."""
    edges, low = np.array(element_edges(config)), origin_of(config)
    high = low + config["domain"]["size"]
    within = np.all((points >= low - edges) & (points <= high + edges), axis=1)
    extent = np.ptp(points, axis=0).max()
    small = len(points) > 1 and extent < LEAST_EXTENT * np.max(high - low)
    if within.mean() >= LEAST_IN_BOX and not small:
        return
    spans = [f"[{','.join(f'{x:.6g}' for x in end)}]" for end in (points.min(axis=0), points.max(axis=0), low, high)]
    found = (f"{len(points)} waypoints reach over {extent:.3g} only of the config's box" if small else
             f"{np.count_nonzero(~within)} of {len(points)} waypoints lie outside of the config's box")
    raise RunError(f"{path}: {found}, which goes "
                   f"from {spans[2]} to {spans[3]}: placed there, they go from {spans[0]} to {spans[1]}"
                   f"{factor_words(extent / np.max(high - low))}; allowed: coordinates of "
                   "the drawing in its unit (--frame drawing), or of the config in its own (--frame plate), or columns that "
                   "name theirs, such as x [mm]")


def factor_words(ratio):
    """Of the extent of paths over that of the box."""
    for factor in USUAL_FACTORS:
        if 0.6 < ratio / factor < 1.4 or 0.6 < ratio * factor < 1.4:
            return f", about {factor:g} times as {'far' if ratio > 1 else 'little'} as the box, as in another unit"
    return ""


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
