# SPDX-License-Identifier: MIT
"""Plans how a machine builds a part: from a mesh to layers, a compensated drawing, paths and one page.

    fabseq-tools plan PART --machine CELL [-o DIR] [--unit mm] [--material NAME] [--rotate X,Y,Z]
                      [--fill-holes | --keep-holes] [--keep connected|all] [--share 0.9] [--optimize]
                      [--minutes M] [--elements N] [--iterations N] [--heat-input J] [--film W]
                      [--post gcode|rapid]... [--yes] [--ranks 2] [--program build/release/fabseq]
                      [-- OPTIONS OF THE PROGRAM]

PART is a file that part.mesh takes: STL, OBJ, PLY or 3MF. CELL is a machine file, or the name of one of
configs/machines. On a terminal the command asks what no option says: the file's unit, and whether holes are
closed whose roofs no layers carry; --yes takes what stands in brackets. Each step says what it found:

1 part         size, volume and mass, with the unit
2 orientation  six orientations are simulated with some thousand elements: the part is turned where layers
               can be built that could not, or where it distorts at least a fifth less. --rotate says
               otherwise (0,0,0: as drawn)
3 holes        what the part stands on, what lies in the air, and the holes
4 layers       with some thousand elements: planar layers, the best tilted ones, layers in two sub-parts and
               guided ones. Where planar or tilted layers have 90 % of what the optimized ones gain
               (--share), they are what is built, unless --optimize asks for more
5 build        the best of them with as many elements as a run of --minutes allows, repaired and judged at
               the height of beads; planar layers and the best alternative beside it
6 drawing      the mesh moved against the distortion, and its layers judged like those of the drawing
7 paths        a file per layer for the machine (--post), with the pauses that its interpass limit needs

Pauses follow from heat that is assumed unless measured: --heat-input, J per kg of wire (default: 3e6), and
--film, W per mm² and K (default: 5e-5). They change no length here.

DIR (default: output/PART_plan) gets plan.html, a page of one screen, plan.json with what it shows, PART.json,
the config of the build, report.html on it, compensated.stl, paths/, and the folders of all runs. A command
that was interrupted goes on where it was when it is given again; what has changed since is done anew.
"""

import os

from fabseq_tools.geometry.placement import MILLIMETRES
from fabseq_tools.paths import posts
from fabseq_tools.plan.build import build
from fabseq_tools.plan.drawing import compensate_drawing
from fabseq_tools.plan.holes import settle_holes
from fabseq_tools.plan.layers import compare_layers
from fabseq_tools.plan.machine_paths import write_paths
from fabseq_tools.plan.orientation import settle_orientation
from fabseq_tools.plan.page import write_page
from fabseq_tools.plan.part import settle_part
from fabseq_tools.plan.steps import Steps
from fabseq_tools.plot.virtual_display import ensure_display
from fabseq_tools.run.command_line import RunError, between, count, non_negative, parse, parser_of, positive, require_program
from fabseq_tools.run.machine import OPTION
from fabseq_tools.run.places import PROGRAM
from fabseq_tools.start.beads import MINUTES
from fabseq_tools.start.new_config import turns, with_negative_turns

COMMAND = "plan"


def main(words):
    arguments = parsed(words)
    ensure_display()  # before minutes of simulation
    steps = Steps(arguments)
    part = steps.take("part", settle_part)
    turned = steps.take("orientation", settle_orientation, part)
    placed = steps.take("holes", settle_holes, part, turned)
    chosen = steps.take("layers", compare_layers, placed)
    built = steps.take("build", build, placed, chosen)
    drawing = steps.take("drawing", compensate_drawing, built)
    paths = steps.take("paths", write_paths, built, drawing)
    print(write_page(steps, placed, chosen, built, drawing, paths))


def parsed(words):
    parser = parser_of(__doc__, COMMAND)
    parser.add_argument("part")
    parser.add_argument(OPTION, metavar="CELL", required=True, help="machine file, or the name of one of configs/machines")
    parser.add_argument("-o", "--output", metavar="DIR", help="default: output/PART_plan")
    parser.add_argument("--unit", choices=list(MILLIMETRES), metavar="UNIT",
                        help="of the file: mm, cm, m, in or ft (default: mm)")
    parser.add_argument("--material", metavar="NAME", help="one of configs/materials (default: ER70S-6)")
    parser.add_argument("--rotate", type=turns, metavar="X,Y,Z", help="degrees about x, then y, then z (default: step 2)")
    holes = parser.add_mutually_exclusive_group()
    holes.add_argument("--fill-holes", action="store_true", default=None,
                       help="that no layers carry: they are drilled afterwards")
    holes.add_argument("--keep-holes", dest="fill_holes", action="store_false", help="they stay open (default)")
    parser.add_argument("--keep", choices=["connected", "all"], help="as of fabseq-tools new")
    parser.add_argument("--share", type=between(0, 1), default=0.9, help="of the gain, with which layers that nobody has to "
                        "optimize are enough (default: %(default)s)")
    parser.add_argument("--optimize", action="store_true", help="whether it pays or not")
    parser.add_argument("--minutes", type=positive, default=MINUTES, metavar="M",
                        help="of step 5 on one rank, about (default: %(default)s)")
    parser.add_argument("--elements", type=positive, metavar="N", help="of the part in step 5, at most (default: 50000)")
    parser.add_argument("--iterations", type=count, default=120, metavar="N", help="of step 5 (default: %(default)s)")
    parser.add_argument("--heat-input", type=positive, default=3e6, metavar="J", help="per kg of wire (default: %(default)g)")
    parser.add_argument("--film", type=non_negative, default=5e-5, metavar="W",
                        help="heat that a surface loses, per mm² and K (default: %(default)g)")
    parser.add_argument("--yes", action="store_true", help="asks nothing")
    parser.add_argument("--ranks", type=count, default=2, metavar="N", help="of the program (default: %(default)s)")
    parser.add_argument("--program", default=PROGRAM)
    posts.add_options(parser)
    arguments = parse(parser, with_negative_turns(words))
    arguments.name = os.path.splitext(os.path.basename(arguments.part))[0]
    arguments.output = arguments.output or os.path.join("output", f"{arguments.name}_plan")
    for path in (arguments.part, arguments.program if os.sep in arguments.program else None):
        if path and not os.path.isfile(path):
            raise RunError(f"{path}: no such file")
    require_program(arguments.program)
    return arguments
