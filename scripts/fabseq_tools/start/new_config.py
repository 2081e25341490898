# SPDX-License-Identifier: MIT
"""Writes a config for a part from a mesh, and says what it has chosen and why.

    fabseq-tools new PART [-o CONFIG.json] [--overwrite] [--machine CELL] [--unit mm] [--scale FACTOR]
                     [--thickness T | --bead-height H] [--minutes M] [--bead-width W]
                     [--max-tilt DEGREES]
                     [--sequence heat|guided] [--keep connected|all] [--fill-holes] [--rotate X,Y,Z]
                     [--elements N | --memory GB] [--material NAME] [--iterations N]
                     [--program build/release/fabseq]

PART is a file that part.mesh takes: STL, OBJ, PLY or 3MF. The program looks at it (-task check) with elements
of several sizes. What is chosen stands in the config, each with the reason as a comment, and on the terminal:

- The machine: --machine is a machine file, or the name of one of configs/machines. Bead, torch, tilt, range
  of thickness and plate follow from it, unless an option here says otherwise.
- The layers' thickness: --thickness. With --bead-height or a machine a simulated layer stands for as many
  beads (layers.passes) as a run of about 30 minutes on one rank needs, or of --minutes. Without any: four
  elements.
- The element: a quarter of a layer, 2.5 in a layer of beads, and no more than a third of the thinnest wall.
  --elements bounds how many the part has (default: 50,000), --memory what a run takes on one rank. Where the
  bound does not leave three elements across a wall, or where the part runs out to an edge,
  part.mesh.least_elements lets it pass.
- The number of layers: the geodesic height over the thickness, and 5 % more.
- The tilt: torch and plate's normal have up to 60 degrees between them; --max-tilt says otherwise, 180 is no
  limit.
- The sequence: with less than 90 degrees of tilt guided, which leans no further; else heat. --sequence says
  otherwise.
- Which way up: as in the file, or turned about x, y and z by the degrees of --rotate, one after the other.
- Pieces that stand neither on the plate nor on the rest are left out, and a warning says their share of the
  volume. Smaller elements are tried first, where they may join them. For a piece that is most of the part,
  the plate is moved up (domain.origin), and what lies below is cut off, as is a point or an edge on which the
  part would stand. --keep connected keeps what stands on the plate instead; --keep all refuses pieces off it.
- Holes, slots and arches whose roofs no layers within the tilt can carry, and that are wider than a bead
  bridges, are named with size and place. --fill-holes closes them (stock): they are drilled afterwards.
- The objective: the shape of the skin after the release (of several pieces on one plate: before it), and, of
  heat, even layers. Constraints: the thickness of each layer and, place by place, the range of
  tool.thickness; a whole last layer; no element begins in the air; the tilt, if it has a limit.
- What it is compared with: also planar layers in the best direction within the tilt (baseline.direction).

Lengths are in --unit, which names the config's unit (default: mm); --scale is the factor from the file's unit
to it. CONFIG.json is PART.json beside the mesh unless given. The last line is the command that comes next.
"""

import argparse
import math
import os
import shlex
import tempfile

from fabseq_tools.geometry.placement import millimetres_of
from fabseq_tools.run.check_words import ANY_TILT
from fabseq_tools.run.command_line import RunError, count, number, parser_of, positive, require_program, warn
from fabseq_tools.run.machine import OPTION
from fabseq_tools.run.places import PROGRAM, SCRIPTS
from fabseq_tools.run.progress import Progress
from fabseq_tools.start.beads import MINUTES
from fabseq_tools.start.choices import choose
from fabseq_tools.start.config_text import config_text
from fabseq_tools.start.look import Look
from fabseq_tools.start.machine import Machine
from fabseq_tools.start.materials import known_materials

COMMAND = "new"

USUAL_TILT, UPRIGHT = 60.0, 90.0  # degrees: unless asked for another; of layers that stand upright along a limb
LARGE, SMALL = 5000.0, 5.0  # mm: a longest edge beyond is that of a file in another unit, more often than not


def main(words):
    arguments = parsed(words)
    output = arguments.output or os.path.splitext(arguments.part)[0] + ".json"
    if os.path.lexists(output) and not arguments.overwrite:
        raise RunError(f"{output} exists; allowed: another --output, or --overwrite")
    if os.path.realpath(output) == os.path.realpath(arguments.part):
        raise RunError(f"--output: {output} is the part")
    for path in (arguments.part, arguments.program if os.sep in arguments.program else None):
        if path and not os.path.isfile(path):
            raise RunError(f"{path}: no such file")
    require_program(arguments.program)
    settle_machine(arguments)
    with tempfile.TemporaryDirectory() as folder, Progress(COMMAND) as progress:
        look = Look(arguments, folder, progress)
        warn_of_unit(arguments, look.size)
        entries, remarks, warnings, _ = choose(arguments, look)
    write(arguments, entries, output)
    for entry in entries:
        for line in entry.lines():
            print(line)
    if arguments.usual_tilt:
        print(f"tilt: at most {USUAL_TILT:g} degrees between torch and plate's normal; --max-tilt says otherwise, 180: no limit")
    for line in remarks:
        print(line)
    for text in warnings:
        warn(COMMAND, text)
    print(f"{output}: written; look at it, then run it with")
    print(f"{shlex.join([arguments.program, '-config', output, '-task', 'check', '-picture'])}")
    print(f"{shlex.join([os.path.join(SCRIPTS, 'use', 'run.sh'), '-config', output])}")


def write(arguments, entries, output):
    """The config."""
    folder = os.path.dirname(os.path.abspath(output))
    os.makedirs(folder, exist_ok=True)
    head = f"{os.path.basename(arguments.part)}: what fabseq-tools new has chosen; all lengths in {arguments.unit}."
    with open(output, "w", encoding="utf-8") as file:
        file.write(config_text(head, with_files(entries, arguments.part, folder)))


tilt = number("degrees above 0, up to 180, which is no limit", lambda value: 0 < value <= ANY_TILT)


def turns(text):
    """The type of an option: degrees about three axes."""
    try:
        found = [float(one) for one in text.split(",")]
    except ValueError:
        found = []
    if len(found) != 3 or not all(map(math.isfinite, found)):
        raise argparse.ArgumentTypeError(f"found {text}; allowed: degrees about x, y and z, such as 90,0,-45")
    return found


def with_negative_turns(words):
    """The words with a value of --rotate that begins with a minus as part of its option, for which argparse
    would take it."""
    words = list(words)
    for place in range(len(words) - 2, -1, -1):
        if words[place] == "--rotate" and words[place + 1].startswith("-"):
            words[place:place + 2] = [f"--rotate={words[place + 1]}"]
    return words


def parsed(words):
    parser = parser_of(__doc__, COMMAND)
    parser.add_argument("part")
    parser.add_argument("-o", "--output", metavar="CONFIG.json", help="default: PART.json, beside the mesh")
    parser.add_argument("--overwrite", action="store_true")
    parser.add_argument(OPTION, metavar="CELL", help="machine file, or the name of one of configs/machines")
    parser.add_argument("--unit", default="mm", help="of the config and of all lengths here (default: %(default)s)")
    parser.add_argument("--scale", type=positive, default=1.0, help="from the file's unit to the config's")
    thickness = parser.add_mutually_exclusive_group()
    thickness.add_argument("--thickness", type=positive, metavar="T", help="of a layer")
    thickness.add_argument("--bead-height", type=positive, metavar="H", help="of which a simulated layer may stand for several")
    parser.add_argument("--bead-width", type=positive, metavar="W")
    parser.add_argument("--minutes", type=positive, metavar="M",
                        help=f"of a run on one rank, about, with a bead's height (default: {MINUTES})")
    parser.add_argument("--max-tilt", type=tilt, metavar="DEGREES",
                        help=f"between torch and plate's normal (default: the machine's, or {USUAL_TILT:g}; 180: no limit)")
    parser.add_argument("--sequence", choices=["heat", "guided"], help="default: guided with a tilt below 90, else heat")
    parser.add_argument("--keep", choices=["connected", "all"],
                        help="pieces on the plate, or refuse others (default: as much of the part as stands)")
    parser.add_argument("--fill-holes", action="store_true", help="whose roofs no layers within the tilt carry: machining stock")
    parser.add_argument("--rotate", type=turns, default=[0.0] * 3, metavar="X,Y,Z", help="degrees about x, then y, then z")
    bound = parser.add_mutually_exclusive_group()
    bound.add_argument("--elements", type=positive, metavar="N", help="of the part, at most (default: 50000)")
    bound.add_argument("--memory", type=positive, metavar="GB", help="of a run on one rank, at most")
    parser.add_argument("--material", metavar="NAME", help=f"{', '.join(known_materials())} (default: ER70S-6)")
    parser.add_argument("--iterations", type=count, default=120, metavar="N", help="default: %(default)s")
    parser.add_argument("--program", default=PROGRAM)
    arguments = parser.parse_args(with_negative_turns(words))
    if arguments.minutes and (arguments.thickness or not (arguments.bead_height or arguments.machine)):
        raise RunError("--minutes: found without --bead-height; allowed: with it or with a machine's bead, as it decides how "
                       "many beads are a layer")
    arguments.minutes = arguments.minutes or MINUTES
    arguments.ranks, arguments.rest = 1, []
    arguments.millimetres = millimetres_of(arguments.unit)
    return arguments


def with_files(entries, part, folder):
    """The entries, with the mesh and a machine's file relative to the config."""
    for entry in entries:
        if entry.key == "part":
            entry.value["mesh"]["file"] = os.path.relpath(part, folder)
        if entry.key == "machine" and os.path.isabs(entry.value):
            entry.value = os.path.relpath(entry.value, folder)
    return entries


def settle_machine(arguments):
    """What the words of the command line leave to the machine, or to the usual."""
    machine = arguments.machine = Machine(arguments) if arguments.machine else None
    arguments.why_bead = "the bead's height (--bead-height)"
    if machine and not (arguments.thickness or arguments.bead_height):
        arguments.bead_height, arguments.why_bead = machine.target, "the height of the machine's bead"
    given = arguments.max_tilt is not None
    arguments.usual_tilt = not given and machine is None
    if not given:
        arguments.max_tilt = machine.max_tilt if machine else USUAL_TILT
    arguments.sequence = arguments.sequence or ("guided" if arguments.max_tilt < UPRIGHT else "heat")


def warn_of_unit(arguments, size):
    longest = max(size)
    if arguments.millimetres and not SMALL <= longest * arguments.millimetres <= LARGE:
        sizes = " × ".join(f"{edge:.6g}" for edge in size)
        warn(COMMAND, f"the part would be {sizes} {arguments.unit}: is the file in another unit? --scale is the factor from it")
