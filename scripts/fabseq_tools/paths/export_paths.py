# SPDX-License-Identifier: MIT
"""Writes the torch paths of the layers of a run, and says what they take.

    fabseq-tools paths RUN --bead-width W [--output DIR] [--of optimized|planar|start] [--outlines N]
                       [--hatch ANGLE] [--turn ANGLE] [--at SHARE] [--nominal-height H] [--speed V]
                       [--frame drawing|plate] [--x-axis still|travel] [--post gcode|rapid]...
                       [--tolerance L] [--axis-tolerance DEGREES] [--clearance L] [--rapid-speed V]

RUN is the output directory of an optimization or a simulation in 3D. Each layer gets N outlines (default: 1),
the first half a bead inside the part's surface, and inside them parallel lines at a bead's width. DIR
(default: RUN/paths) gets
- paths.csv, paths.json: the waypoints in the order of deposition, with position, torch axis, local height and
  spacing of the bead, and factor of the wire feed; docs/reference.md lists the columns. Heights are those
  that the run's check has judged; what a layer has more or less in a place is in the feed.
- paths_compas.json: print points of COMPAS Slicer. paths_irbcam.csv, .json: targets of IRBCAM.
- gcode/, rapid/: with --post, a program for a machine: a file per layer, and one that calls them.
- paths_summary.json: starts, lengths, travels and ranges per layer. paths.png: some layers' paths.
--frame says whose coordinates all files have: those of the drawing (of its mesh file, in its unit of length)
or of the build plate (of the config, in domain.unit). In either frame, IRBCAM's files are in millimetres of
the placed part. Lengths of options are the config's. --x-axis says how the torch stands about its own axis in
the files for COMPAS and IRBCAM: still, so that it turns no more than the axis does, or along the travel.

The first line is the run's verdict. Pieces of layers that no element of theirs stands for become part of a
neighbour; that is said, as is what of a layer no bead fills. The rapid way between two passes goes straight
from two beads beyond the end to two beads before the start. Ways that would cross what stands by then are
named; in IRBCAM's files they are raised above it. Only the tip of the torch is looked at.

Programs have the frame plate. The wire feed is constant: where a bead has its nominal section, the torch
travels at --speed, or as fast as the config's deposition rate allows, and elsewhere at that over the feed. It
pauses after a layer as the run's report on the interpass temperature says, or else by process.dwell.
Waypoints are left out while the way stays within --tolerance of them, its axis within --axis-tolerance and
the feed within 10 %. Travels retract along the torch's axis to --clearance above the bead, and go as far
above what stands by then.
"""

import os

import numpy as np

from fabseq_tools.geometry.grid import element_edges
from fabseq_tools.geometry.layer_bodies import GROUPS, LayeredPart, joined_words
from fabseq_tools.geometry.placement import FRAMES, MILLIMETRES, Placement, millimetres_of
from fabseq_tools.paths import post_process, posts
from fabseq_tools.paths.files import COLUMNS, compas_points, irbcam_targets, rows_of, write_compact, write_irbcam, write_table
from fabseq_tools.paths.frames import ABOUT_AXIS, set_frames
from fabseq_tools.paths.pace import USUAL_SPEED, pace_of, travel_speed
from fabseq_tools.paths.torch_paths import all_passes, summary
from fabseq_tools.paths.ways import rapid_ways
from fabseq_tools.plot.virtual_display import ensure_display
from fabseq_tools.run.command_line import RunError, finite, parser_of, positive, share, warn, whole_number, write_json
from fabseq_tools.run.progress import Progress
from fabseq_tools.run.read_run import target_thickness

COMMAND = "paths"

RETRACT = 2.0  # beads from the part, between two passes
MOST_NAMED = 8  # ways in a line
MOST_MISSED = 0.01  # share of a layer's area beyond the beads that goes without a word
FINEST = 0.25  # of an element's edge: least width of a bead


def main(words):
    parser = parser_of(__doc__, COMMAND)
    parser.add_argument("run")
    parser.add_argument("--bead-width", type=positive, help="default: tool.bead_width of the config")
    parser.add_argument("--output", help="directory (default: RUN/paths)")
    parser.add_argument("--of", choices=list(GROUPS), default="optimized", help="whose layers (default: %(default)s)")
    parser.add_argument("--outlines", type=whole_number(1, 100), default=1, help="default: %(default)s")
    parser.add_argument("--hatch", type=finite, default=0.0, help="angle with the x axis, degrees (default: %(default)s)")
    parser.add_argument("--turn", type=finite, default=90.0, help="of the hatch from layer to layer (default: %(default)s)")
    parser.add_argument("--at", type=share, default=0.5, help="height of waypoints in the layer: 0 its lower, 1 its upper "
                        "side (default: %(default)s)")
    parser.add_argument("--nominal-height", type=positive, help="of a bead with feed 1 (default: the target thickness)")
    parser.add_argument("--speed", type=positive, help="of the torch at feed 1, mm/s (default: by process.deposition_rate, "
                        f"else tool.travel_speed, else {USUAL_SPEED:g}; for IRBCAM the last two)")
    parser.add_argument("--frame", choices=FRAMES, default="drawing", help="whose coordinates (default: %(default)s)")
    parser.add_argument("--x-axis", choices=ABOUT_AXIS, default=ABOUT_AXIS[0],
                        help="of the tool's frames, for COMPAS and IRBCAM (default: %(default)s)")
    parser.add_argument("--no-picture", action="store_true")
    machines = posts.add_options(parser)
    post_process.add_options(parser)
    arguments = parser.parse_args(words)
    if not arguments.no_picture:
        ensure_display()
    output = arguments.output or os.path.join(arguments.run, "paths")
    with Progress(COMMAND) as progress:
        part = LayeredPart(arguments.run, arguments.of, progress=progress)
        print(part.judged.words(), flush=True)
        width = checked_width(arguments, part)
        passes = all_passes(part, width, arguments.outlines, arguments.hatch, arguments.turn, arguments.at, progress)
        ways = rapid_ways(part, passes, RETRACT * width, progress)
        section = width * (arguments.nominal_height or target_height(part, passes))
        feeds = [one.heights * one.spacings / section for one in passes]
        millimetres = millimetres_of(part.config["domain"].get("unit"))
        pace = pace_of(part, arguments.speed, millimetres, section)
        programs = post_process.post_process(part, passes, pace, feeds, width, millimetres, arguments, machines, output, progress)
    placement = Placement(part.config, arguments.frame)
    record = {"name": part.name, "of": arguments.of, "outlines": arguments.outlines, "hatch": arguments.hatch,
              "turn": arguments.turn, "at": arguments.at, "verdict": part.judged.verdict or None,
              **export(part, passes, ways, width, (feeds, pace), output, placement, arguments), "programs": programs}
    write_json(os.path.join(output, "paths_summary.json"), record)
    if not arguments.no_picture:
        from fabseq_tools.paths.picture import draw  # loads VTK's renderer, which needs a display
        draw(part, passes, width, placement, os.path.join(output, "paths.png"))
    for words in [*warnings(record), *post_process.program_warnings(programs, pace, unit_of(record))]:
        warn(COMMAND, words)
    for words in joined_words(record):
        print(words)
    print(table(record))
    for words in post_process.program_lines(programs, pace):
        print(words)
    print(f"in {output}")


def warnings(record):
    unit = unit_of(record)
    for layer in record["layers"]:
        if layer["missed"] > MOST_MISSED:
            yield (f"layer {layer['layer']}: {100 * layer['missed']:.3g} % of its area lies more than a bead's width from all "
                   f"paths, up to {layer['farthest']:.3g}{unit}: no bead fills it")
    for layer in record["without_path"]:
        yield f"layer {layer['layer']}, volume {layer['volume']:.4g}, is smaller than a bead: it has no path"
    ways = record["ways"]
    if ways["crossing"]:
        many, worst = ways["crossing"], max(way["depth"] for way in ways["crossing"])
        named = ", ".join(f"{way['from']} to {way['to']} ({way['depth']:.3g}{unit})" for way in many[:MOST_NAMED])
        left = [way for way in many if way["raised"] is None or way["raised"] > 0]
        yield (f"{len(many)} of {ways['count']} straight rapid ways between passes cross what stands, up to {worst:.3g}{unit} "
               f"deep: passes {named}{', ...' * (len(many) > MOST_NAMED)}; "
               + (f"in paths_irbcam they are raised above it, but {len(left)} cross something still: passes "
                  f"{', '.join(str(way['from']) for way in left[:MOST_NAMED])}{', ...' * (len(left) > MOST_NAMED)}" if left else
                  "in paths_irbcam they are raised above it"))


def checked_width(arguments, part):
    """The bead's width. Raises RunError where it is out of range."""
    width = arguments.bead_width or part.config.get("tool", {}).get("bead_width") or 0.0
    low, high = FINEST * min(element_edges(part.config)), max(part.config["domain"]["size"])
    if not low <= width <= high:
        raise RunError(f"--bead-width: found {width:g}; allowed: {low:g} to {high:g}")
    return width


def export(part, passes, ways, width, rates, output, placement, options):
    """Writes the files of waypoints, and returns the summary. Leaves the passes and ways in the placement's
    frame. `rates`: feeds of each pass, and the pace."""
    os.makedirs(output, exist_ok=True)
    scale = placement.scale
    layers = summary(part, passes, part.up)
    height = options.nominal_height or target_height(part, passes)
    for one in passes:  # from here on in the coordinates of the frame
        one.points, one.axes = placement.points(one.points), placement.directions(one.axes)
        one.heights, one.spacings = one.heights * scale, one.spacings * scale
    for way in ways:
        way.points, way.at, way.straight, way.depth = placement.points(
            way.points), placement.points(way.at), way.straight * scale, way.depth * scale
    set_frames(passes, placement.directions(part.up), options.x_axis)
    feeds, pace = rates
    rows = rows_of(passes, feeds, [scale * pace.speeds(one) for one in feeds], pace.pauses)
    for layer in layers:
        own = np.array([[row[COLUMNS.index(name)] for name in ("feed", "speed")] for row in rows if row[1] == layer["layer"]])
        layer.update({key: layer[key] * scale for key in ("length", "travel", "farthest")}, pause=pace.pauses[layer["layer"]],
                     **dict(zip(("feed", "speed"), np.stack([own.min(axis=0), own.max(axis=0)], axis=1).tolist())),
                     height=[value * scale for value in layer["height"]],
                     **{key: layer[key] * scale**3 for key in ("wire", "volume")})
    common = {**placement.facts(), "bead_width": width * scale, "nominal_height": height * scale}
    write_table(os.path.join(output, "paths.csv"), rows)
    write_compact(os.path.join(output, "paths.json"), {**common, "columns": COLUMNS, "waypoints": rows})
    write_compact(os.path.join(output, "paths_compas.json"), compas_points(passes, rows, placement.facts()))
    export_irbcam(part, passes, ways, width, output, placement, options.speed or travel_speed(part.config))
    volumes = np.bincount(part.body.label, part.body.volumes()) * scale**3
    without = sorted(set(part.layers) - {layer["layer"] for layer in layers})
    total = {key: sum(layer[key] for layer in layers) for key in ("starts", "waypoints", "length", "travel", "wire")}
    return {**common, **total, "volume": float(volumes.sum()), "layers": layers,
            "without_path": [{"layer": number, "volume": float(volumes[number])} for number in without],
            "joined": part.joined_rows(scale), "ways": ways_record(ways, passes)}


def ways_record(ways, passes):
    """How many there are, and those that cross what stands: straight, and as IRBCAM's files have them."""
    return {"count": len(ways), "crossing": [
        {"from": way.number, "to": way.number + 1, "layers": [passes[way.number - 1].layer, passes[way.number].layer],
         "depth": way.straight, "raised": way.depth if way.raised else None, "at": way.at.tolist()}
        for way in ways if way.straight > 0]}


def export_irbcam(part, passes, ways, width, output, placement, speed):
    """IRBCAM's files, in millimetres. Says so on the terminal where the config's unit leaves it open."""
    unit = part.config["domain"].get("unit")
    if placement.millimetres is None:
        warn(COMMAND, f"domain.unit: found {unit}; allowed for paths_irbcam, which is not written: {', '.join(MILLIMETRES)}")
        return
    if not unit:
        print("domain.unit names no unit: paths_irbcam takes the config's lengths as millimetres")
    targets = irbcam_targets(passes, [way.points for way in ways], placement.millimetres,
                             speed, RETRACT * width * placement.scale)
    write_irbcam(os.path.join(output, "paths_irbcam"), targets, {**placement.facts(), "unit": "mm"})


def target_height(part, passes):
    return target_thickness(part.config) or float(np.median(np.concatenate([one.heights for one in passes])))


def unit_of(record):
    return f" {record['unit']}" if record["unit"] else ""


def table(record):
    """The summary as lines of text."""
    lines = [f"{'layer':>6}{'starts':>8}{'length':>10}{'travel':>10}{'height':>20}{'angle':>16}{'feed':>16}{'wire':>12}"
             f"{'unfilled':>10}"]
    for row in record["layers"]:
        height, angle, feed = ("{:.3g} to {:.3g}".format(*row[key]) for key in ("height", "angle", "feed"))
        lines.append(f"{row['layer']:>6}{row['starts']:>8}{row['length']:>10.4g}{row['travel']:>10.4g}{height:>20}{angle:>16}"
                     f"{feed:>16}{row['wire']:>12.5g}{100 * row['missed']:>8.3g} %")
    unit = f" in{unit_of(record)}" if record["unit"] else ""
    lines.append(f"{record['starts']} starts, {record['waypoints']} waypoints, length {record['length']:.5g}, travel "
                 f"{record['travel']:.4g}, lengths{unit}, angles of the torch with the plate's normal in degrees")
    lines.append(f"coordinates: {record['coordinates']} (frame: {record['frame']}){unit}")
    lines.append(f"volume of wire {record['wire']:.6g}, of the part {record['volume']:.6g} "
                 f"({100 * (record['wire'] / record['volume'] - 1):+.2f} %); feed 1 is a bead of "
                 f"{record['nominal_height']:.4g} x {record['bead_width']:.4g}")
    return "\n".join(lines)
