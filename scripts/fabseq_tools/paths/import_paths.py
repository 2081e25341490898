# SPDX-License-Identifier: MIT
"""Makes a sequence of torch paths, which fabseq simulates and checks like its own.

    fabseq-tools import-paths PATHS CONFIG [--output SEQUENCE.h5] [--at SHARE] [--frame drawing|plate]
                              [--finer N]

PATHS is a table (CSV) with a line per waypoint, or any file of `fabseq-tools paths`, also those for COMPAS
and IRBCAM (whose table has layers only with the JSON file beside it). The first line of a table names the
columns: x, y, z, and layer, a whole number, or order. Further columns of that command are used where they are
there: axis_x, axis_y, axis_z and height tell layers apart, level says where in its layer a waypoint lies (0
to 1), spacing how far apart beads lie, and pass that the way between two waypoints is deposited. CONFIG is
the config.json of a run or its directory; a config of a part from a mesh does not say where the mesh lies, so
that a run's is needed.

The column order is the order of deposition: where it goes back to an earlier layer, layers count anew from
there. Waypoints at which nothing is deposited are left out: columns such as kind, type, arc or weld say so by
words such as travel, rapid or off, or by 0. Both are said. Programs of robots and G-code are refused.

--frame says whose coordinates and lengths these are: those of the drawing (of its mesh file, in its unit) or
of the build plate (of the config, in domain.unit). Without it, paths.json says so itself, and of a table the
JSON file of the same name beside it, if that has the same waypoints; else they are the drawing's.

Each element takes the layer of the waypoint next to it, or its order if there are no layers. --at: height of
the waypoints in their layer, from 0 to 1 (default: 0.5), where there is no column level. Without columns of
axis and height these follow from the waypoints of the layer and of the next one below. A warning says where
waypoints seem to lie at the top or the bottom of their layers. Prints the command that simulates the
sequence. --finer: the sequence is for N times as many elements along each axis as the config's, and so is the
command: a run judges its beads with 2.5 or more elements to each.

SEQUENCE.h5 (default: PATHS_sequence.h5 beside the table) has, for all elements [z][y][x] of the config's box:
- time: the pseudo-time. In layer j of N it goes from (j - 1)/N to j/N along the build direction, so that the
  differences between elements show that direction; where heights are not known it is (j - 0.5)/N, and without
  layers the share of the waypoints up to the element's.
- layer: 1 to N, where there are layers.
- build_direction [z][y][x][axis], local_thickness: where the table has columns of axis and height. Unit
  vectors and lengths of the config, from the waypoints around the element.
- time_gradient [z][y][x][axis]: of the time, the direction over thickness and N, by which the program checks
  the sequence; without it, it goes by differences of the times.

Cells stand apart by comma, semicolon, tab or blanks; with all but the first a decimal comma is taken, too.
Columns may name a unit, such as "x [mm]", which is then converted. UTF-8 and UTF-16 are read.
"""

import json
import os
import shlex

import h5py
import numpy as np
from scipy.spatial import KDTree

from fabseq_tools.geometry.grid import element_centres, element_edges, origin_of, refined, up_of
from fabseq_tools.geometry.placement import FRAMES, MILLIMETRES, Placement
from fabseq_tools.paths.path_files import read_paths
from fabseq_tools.paths.path_sequence import sequence_fields
from fabseq_tools.paths.waypoints import Beads, Waypoints
from fabseq_tools.run.command_line import RunError, parser_of, share, warn, whole_number
from fabseq_tools.run.read_run import Run, bead_thickness, read_config

COMMAND = "import-paths"

FAR, MOST_MISFIT = 4.0, 0.05  # times the quarter of distances that is least; of elements and waypoints beyond
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
    parser.add_argument("--finer", type=whole_number(1, 8), default=1, metavar="N",
                        help="elements along each axis (default: %(default)s)")
    arguments = parser.parse_args(words)
    path = arguments.config
    path = os.path.join(path, "config.json") if os.path.isdir(path) else path
    config = checked_config(read_config(path), path)
    finer = finer_grid(config, arguments.finer)
    output = arguments.output or os.path.splitext(arguments.paths)[0] + "_sequence.h5"
    found = read_paths(arguments.paths)
    placement = Placement(config, arguments.frame or found.frame)
    if found.placed and placement.millimetres is None:
        raise RunError(
            f"domain.unit: found {config['domain']['unit']}; allowed for targets in millimetres: {', '.join(MILLIMETRES)}")
    print(f"coordinates of {arguments.paths}: {placement.system} (frame: {placement.frame})"
          f"{' in mm' if found.placed else f' in {placement.unit}' if placement.unit else ''}")
    waypoints = Waypoints(found.table, placement, found.placed)
    for words in waypoints.words:
        print(words)
    check_box(arguments.paths, waypoints.points, config)
    exact = waypoints.axes is not None and waypoints.heights is not None
    if waypoints.layers is not None:
        beads = Beads(waypoints, config, arguments.at)
        if arguments.at == 0.5 and beads.seem_at() is not None:
            warn(COMMAND, beads.words())
    elif arguments.at != 0.5:
        raise RunError(f"--at: found {arguments.at:g}; allowed: 0.5 where {arguments.paths} has no column layer")
    points = waypoints.points.copy()
    if exact and (waypoints.axes @ up_of(config)).mean() < 0:
        warn(COMMAND, f"{arguments.paths}: the axes point towards the plate; expected: from it, along the torch")
    fields = sequence_fields(waypoints, config, exact)
    for words in misfits(points, config, os.path.join(os.path.dirname(path), "result.h5")):
        warn(COMMAND, f"{arguments.paths}: {words}")
    with h5py.File(output, "w") as file:
        for name, values in fields.items():
            file[name] = values
    layer = fields.get("layer")
    count = int(layer.max()) if layer is not None else None
    layers = f" -set {shlex.quote(f'layers={layers_of_paths(config, count)}')}" if count else layers_of_config(config, path)
    print(f"{output}: {f'{count} layers' if count else 'an order without layers'}; simulate it with")
    print(f"fabseq -config {shlex.quote(path)} -task simulate -sequence {shlex.quote(output)}{finer}{layers} -binary "
          "-output OUTPUT")


def finer_grid(config, finer):
    """Divides the config's elements. Returns the option that does so in the program."""
    if finer == 1:
        return ""
    if "voxels" in config["part"]:
        raise RunError(f"--finer: found {finer}; allowed: 1 for a part in voxels, since their file fits one grid only")
    config["domain"] = refined(config["domain"], finer)
    return f" -set domain.elements={json.dumps(config['domain']['elements'], separators=(',', ':'))}"


def misfits(points, config, result):
    """Lines of text on elements of the run's part that no waypoint is near to, and on waypoints off it."""
    if not os.path.exists(result):
        return
    with h5py.File(result) as file:
        part = file["density"][()] > 0 if "density" in file else np.zeros(())
    if part.shape != tuple(config["domain"]["elements"][::-1]) or not part.any():
        return
    centres = element_centres(config, np.argwhere(part))
    away, off = KDTree(points).query(centres)[0], KDTree(centres).query(points)[0]
    reach = np.linalg.norm(element_edges(config)) + FAR * np.quantile(away, 0.25)
    if (far := (away > reach).mean()) > MOST_MISFIT:
        yield (f"{100 * far:.0f} % of the part's elements lie farther than {reach:.3g} from all waypoints; expected: paths of "
               "the whole part")
    if (far := (off > reach).mean()) > MOST_MISFIT:
        yield f"{100 * far:.0f} % of the waypoints lie farther than {reach:.3g} from the part; expected: its place and its axes"


def layers_of_paths(config, count):
    """The section of as many layers, with the target thickness that the config's beads are judged by."""
    target = bead_thickness(config)
    return json.dumps({"type": "curved", "count": count} | ({} if target is None else {"target": target}))


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
