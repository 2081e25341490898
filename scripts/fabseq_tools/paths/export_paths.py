# SPDX-License-Identifier: MIT
"""Writes the torch paths of the layers of a run, and says what they take.

    fabseq-tools paths RUN --bead-width W [--output DIR] [--of optimized|planar|start] [--outlines N]
                       [--hatch ANGLE] [--turn ANGLE] [--at SHARE] [--nominal-height H] [--speed V]
                       [--frame drawing|plate]

RUN is the output directory of an optimization or a simulation in 3D. Each layer gets N outlines (default: 1),
the first half a bead inside the part's surface, and inside them parallel lines at a bead's width. DIR
(default: RUN/paths) gets
- paths.csv, paths.json: the waypoints in the order of deposition, with position, torch axis, local height and
  spacing of the bead, and factor of the wire feed; docs/reference.md lists the columns.
- paths_compas.json: print points of COMPAS Slicer. paths_irbcam.csv, .json: targets of IRBCAM.
- paths_summary.json: starts, lengths, travels and ranges per layer. paths.png: some layers' paths.
--frame says whose coordinates all files have: those of the drawing (of its mesh file, in its unit of length)
or of the build plate (of the config, in domain.unit). In either frame, IRBCAM's files are in millimetres of
the placed part. Lengths of options are the config's. The way between two passes is not checked for
collisions.
"""

import os

import numpy as np

from fabseq_tools.geometry.grid import element_edges
from fabseq_tools.geometry.layer_bodies import GROUPS, LayeredPart
from fabseq_tools.geometry.placement import FRAMES, MILLIMETRES, Placement
from fabseq_tools.paths.files import COLUMNS, compas_points, irbcam_targets, rows_of, write_compact, write_irbcam, write_table
from fabseq_tools.paths.torch_paths import all_passes, summary
from fabseq_tools.plot.virtual_display import ensure_display
from fabseq_tools.run.command_line import RunError, parser_of, warn, write_json
from fabseq_tools.run.progress import Progress

COMMAND = "paths"

RETRACT = 2.0  # beads from the part, between two passes
MOST_MISSED = 0.01  # share of a layer's area beyond the beads that goes without a word
FINEST = 0.25  # of an element's edge: least width of a bead


def main(words):
    parser = parser_of(__doc__, COMMAND)
    parser.add_argument("run")
    parser.add_argument("--bead-width", type=float, help="default: tool.bead_width of the config")
    parser.add_argument("--output", help="directory (default: RUN/paths)")
    parser.add_argument("--of", choices=list(GROUPS), default="optimized", help="whose layers (default: %(default)s)")
    parser.add_argument("--outlines", type=int, default=1, help="default: %(default)s")
    parser.add_argument("--hatch", type=float, default=0.0, help="angle with the x axis, degrees (default: %(default)s)")
    parser.add_argument("--turn", type=float, default=90.0, help="of the hatch from layer to layer (default: %(default)s)")
    parser.add_argument("--at", type=float, default=0.5, help="height of waypoints in the layer: 0 its lower, 1 its upper "
                        "side (default: %(default)s)")
    parser.add_argument("--nominal-height", type=float, help="of a bead with feed 1 (default: the target thickness)")
    parser.add_argument("--speed", type=float, default=10.0, help="of the torch, mm/s, for IRBCAM (default: %(default)s)")
    parser.add_argument("--frame", choices=FRAMES, default="drawing", help="whose coordinates (default: %(default)s)")
    parser.add_argument("--no-picture", action="store_true")
    arguments = parser.parse_args(words)
    if not arguments.no_picture:
        ensure_display()
    output = arguments.output or os.path.join(arguments.run, "paths")
    with Progress(COMMAND) as progress:
        part = LayeredPart(arguments.run, arguments.of, progress=progress)
        width = checked_width(arguments, part)
        passes = all_passes(part, width, arguments.outlines, arguments.hatch, arguments.turn, arguments.at, progress)
    placement = Placement(part.config, arguments.frame)
    record = {"name": part.name, "of": arguments.of, "outlines": arguments.outlines, "hatch": arguments.hatch,
              "turn": arguments.turn, "at": arguments.at, **export(part, passes, width, output, placement, arguments)}
    write_json(os.path.join(output, "paths_summary.json"), record)
    if not arguments.no_picture:
        from fabseq_tools.paths.picture import draw  # loads VTK's renderer, which needs a display
        draw(part, passes, width, placement, os.path.join(output, "paths.png"))
    for layer in record["layers"]:
        if layer["missed"] > MOST_MISSED:
            warn(COMMAND, f"layer {layer['layer']}: {100 * layer['missed']:.3g} % of its area lies more than a bead's width from "
                 f"all paths, up to {layer['farthest']:.3g}{unit_of(record)}: no bead fills it")
    print(table(record))
    print(f"in {output}")


def checked_width(arguments, part):
    """The bead's width. Raises RunError where options are out of range."""
    width = arguments.bead_width or part.config.get("tool", {}).get("bead_width") or 0.0
    least = FINEST * min(element_edges(part.config))
    for name, value, low, high in (("bead-width", width, least, max(part.config["domain"]["size"])),
                                   ("outlines", arguments.outlines, 1, 100), ("at", arguments.at, 0.0, 1.0),
                                   ("nominal-height", arguments.nominal_height or 1.0, 1e-12, np.inf),
                                   ("speed", arguments.speed, 1e-6, np.inf)):
        if not low <= value <= high:
            raise RunError(f"--{name}: found {value:g}; allowed: {low:g} to {high:g}")
    return width


def export(part, passes, width, output, placement, options):
    """Writes the files of waypoints, and returns the summary. Leaves the passes in the placement's frame."""
    os.makedirs(output, exist_ok=True)
    scale = placement.scale
    axis, side = "xyz".index(part.config.get("build_plate", "z-")[0]), part.config.get("build_plate", "z-")[1]
    layers = summary(part, passes, np.eye(3)[axis] * (1.0 if side == "-" else -1.0))
    height = options.nominal_height or target_height(part, passes)
    for one in passes:  # from here on in the coordinates of the frame
        one.points, one.axes = placement.points(one.points), placement.directions(one.axes)
        one.heights, one.spacings = one.heights * scale, one.spacings * scale
    rows = rows_of(passes, height * width * scale**2)
    for layer in layers:
        feeds = [row[-1] for row in rows if row[1] == layer["layer"]]
        layer.update({key: layer[key] * scale for key in ("length", "travel", "farthest")}, feed=[min(feeds), max(feeds)],
                     height=[value * scale for value in layer["height"]],
                     **{key: layer[key] * scale**3 for key in ("wire", "volume")})
    common = {**placement.facts(), "bead_width": width * scale, "nominal_height": height * scale}
    write_table(os.path.join(output, "paths.csv"), rows)
    write_compact(os.path.join(output, "paths.json"), {**common, "columns": COLUMNS, "waypoints": rows})
    write_compact(os.path.join(output, "paths_compas.json"), compas_points(passes, rows, placement.facts()))
    export_irbcam(part, passes, width, output, placement, options.speed)
    volume = float(part.body.volumes().sum() * scale**3)
    total = {key: sum(layer[key] for layer in layers) for key in ("starts", "waypoints", "length", "travel", "wire")}
    return {**common, **total, "volume": volume, "layers": layers}


def export_irbcam(part, passes, width, output, placement, speed):
    """IRBCAM's files, in millimetres. Says so on the terminal where the config's unit leaves it open."""
    unit = part.config["domain"].get("unit")
    if placement.millimetres is None:
        warn(COMMAND, f"domain.unit: found {unit}; allowed for paths_irbcam, which is not written: {', '.join(MILLIMETRES)}")
        return
    if not unit:
        print("domain.unit names no unit: paths_irbcam takes the config's lengths as millimetres")
    targets = irbcam_targets(passes, placement.millimetres, speed, RETRACT * width * placement.scale)
    write_irbcam(os.path.join(output, "paths_irbcam"), targets, {**placement.facts(), "unit": "mm"})


def target_height(part, passes):
    targets = [c["target"] for c in part.config.get("constraints", []) if c["type"] == "layer_thickness"]
    return targets[0] if targets else float(np.median(np.concatenate([one.heights for one in passes])))


def unit_of(record):
    return f" {record['unit']}" if record["unit"] else ""


def table(record):
    """The summary as lines of text."""
    lines = [f"{'layer':>6}{'starts':>8}{'length':>10}{'travel':>10}{'height':>20}{'angle':>16}{'feed':>16}{'wire':>12}"]
    for row in record["layers"]:
        height, angle, feed = ("{:.3g} to {:.3g}".format(*row[key]) for key in ("height", "angle", "feed"))
        lines.append(f"{row['layer']:>6}{row['starts']:>8}{row['length']:>10.4g}{row['travel']:>10.4g}{height:>20}{angle:>16}"
                     f"{feed:>16}{row['wire']:>12.5g}")
    unit = f" in{unit_of(record)}" if record["unit"] else ""
    lines.append(f"{record['starts']} starts, {record['waypoints']} waypoints, length {record['length']:.5g}, travel "
                 f"{record['travel']:.4g}, lengths{unit}, angles of the torch with the plate's normal in degrees")
    lines.append(f"coordinates: {record['coordinates']} (frame: {record['frame']}){unit}")
    lines.append(f"volume of wire {record['wire']:.6g}, of the part {record['volume']:.6g} "
                 f"({100 * (record['wire'] / record['volume'] - 1):+.2f} %); feed 1 is a bead of "
                 f"{record['nominal_height']:.4g} x {record['bead_width']:.4g}")
    return "\n".join(lines)
