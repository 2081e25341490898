# SPDX-License-Identifier: MIT
"""Programs for machines from the paths of a run."""

import os

from fabseq_tools.paths.frames import set_frames
from fabseq_tools.paths.programs import program_of, write_files
from fabseq_tools.paths.thinning import Tolerances
from fabseq_tools.paths.travels import travels
from fabseq_tools.paths.ways import Standing
from fabseq_tools.run.command_line import RunError, positive
from fabseq_tools.run.words import duration

CLEARANCE, TOLERANCE = 2.0, 0.05  # beads
AXIS_TOLERANCE = 1.0  # degrees
RAPID_SPEED = 50.0  # mm/s


def add_options(parser):
    parser.add_argument("--tolerance", type=positive, help=f"of thinned points (default: {TOLERANCE:g} bead widths)")
    parser.add_argument("--axis-tolerance", type=positive, default=AXIS_TOLERANCE, help="degrees (default: %(default)s)")
    parser.add_argument("--clearance", type=positive, help=f"of travels (default: {CLEARANCE:g} bead widths)")
    parser.add_argument("--rapid-speed", type=positive, default=RAPID_SPEED, help="mm/s, arc off (default: %(default)s)")


def post_process(part, passes, pace, feeds, width, millimetres, options, posts, output, progress):
    """Writes the programs that the options name, each into its folder in `output`, and returns their record;
    None without any. Sets the frames of the passes, which are in the config's coordinates. `feeds`: of each;
    `pace`: of pace.py; `width`: of a bead; `millimetres`: of a length of the config, None where that is not
    known. Raises RunError before anything is written."""
    if not options.post:
        return None
    if millimetres is None:
        raise RunError(f"domain.unit: found {part.config['domain']['unit']}; allowed for --post: a unit of length, such as mm")
    if part.judged.layer is None:
        raise RunError("result.h5 does not tell the layers of elements; allowed for --post: results of this version")
    set_frames(passes, part.up, options.x_axis)
    tolerances = Tolerances(options.tolerance or TOLERANCE * width, options.axis_tolerance)
    clearance = options.clearance or CLEARANCE * width
    ways = travels(Standing(part, passes), passes, clearance, progress)
    program = program_of(part, passes, ways, [pace.speeds(one) for one in feeds], pace.known_pauses(), tolerances,
                         options.rapid_speed, millimetres)
    texts = {name: posts[name].program_files(program, options) for name in options.post}
    for name, files in texts.items():
        write_files(files, os.path.join(output, name), posts[name].ENDINGS, posts[name].KEPT)
    welding, travelling, pausing = program.seconds()
    return {"tolerance": tolerances.distance, "axis_tolerance": tolerances.angle, "clearance": clearance,
            "rapid_speed": options.rapid_speed, "files": {name: len(files) for name, files in texts.items()},
            "waypoints": sum(len(one.points) for one in passes),
            "points": program.points(), "welded_points": program.points(True),
            "seconds": {"welding": welding, "travels": travelling, "pauses": pausing},
            "crossing": [{"after": way.number, "depth": way.depth} for way in ways if way.depth > 0]}


def program_lines(record, pace):
    """What the record says, as lines of text."""
    if not record:
        return []
    seconds = record["seconds"]
    return [f"programs: {', '.join(f'{name} ({count} files)' for name, count in record['files'].items())}; "
            f"{record['welded_points']} of {record['waypoints']} waypoints; welding {duration(seconds['welding'])} "
            f"(speed: {pace.origin}), travels {duration(seconds['travels'])}, pauses {duration(seconds['pauses'])} "
            f"({pace.pauses_from})"]


def program_warnings(record, pace, unit):
    """What is not as it should be: in lines of text."""
    for number, pause in pace.pauses.items():
        if pause is None:
            yield f"layer {number}: no pause keeps the interpass limit; programs pause as after the layer with the longest"
    if record and record["crossing"]:
        worst = max(record["crossing"], key=lambda one: one["depth"])
        yield (f"{len(record['crossing'])} ways of the programs with the arc off cross what stands, up to "
               f"{worst['depth']:.3g}{unit} deep: worst after pass {worst['after']}")
