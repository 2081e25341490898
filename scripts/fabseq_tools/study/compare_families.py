# SPDX-License-Identifier: MIT
"""Compares planar, tilted, multi-planar, heat and guided layers of a part within one machine's limits.

    fabseq-tools compare-families PART.json [--machine CELL] [--subparts 2 3 4] [--step 20] [--azimuths 4]
                                  [--ranks 2] [--output DIR] [--program build/release/fabseq]
                                  [-- OPTIONS OF THE PROGRAM]

The limits are those of the config's machine or tool, or of --machine, a machine file or the name of one of
configs/machines: range of local thickness, largest tilt, torch; and nothing begins in the air. The config
needs a layer_thickness constraint or a machine. Constraints on the limits are added where the
config has none: those of a type that a kind of layers does not have are left out for it.

    planar               one simulation
    tilted planar        the best of a scan: tilts in steps of --step degrees up to the limit (60 without
                         one), to as many sides as --azimuths says; those that can be built first
    multi-planar         optimized, as many sub-parts as --subparts says, which start leaning to that side
    start                the design that heat layers begin with
    heat, guided         optimized; guided without the uniformity of layers

Planar layers have the target thickness. Optimizations take the config's own iterations, and its own steps
where the sequence is of its own kind; options behind -- go to all runs (-- -max_iterations 60). Figures are
of binary layers, whose simulation takes 15 % more and less of the inherent strain along each axis: `spread`
is how much of the first objective's length that changes. `verdict` is the program's. Times are
those of the optimization, or of a simulation where there is none.

Into DIR, by default output/PART_families, go families.json, .csv and .png, and a folder for each run. A run
that is done is not repeated, and one that was interrupted goes on.
"""

import os

from fabseq_tools.run.command_line import RunError, between, parse, whole_number
from fabseq_tools.study import figures
from fabseq_tools.study.comparison import Comparison
from fabseq_tools.study.families_picture import draw
from fabseq_tools.study.rounds import Rounds, parser_of_rounds

COMMAND = "compare-families"
FIRST = "layers", "layers"  # key and heading of a table's first column
STEPS = 1.0, 90.0           # degrees, of the scan


def main(words):
    parser = parser_of_rounds(__doc__, COMMAND, "PART.json", None)
    parser.add_argument("--subparts", type=whole_number(1, 100), nargs="*", default=[2, 3, 4], metavar="N", help="default: 2 3 4")
    add_scan(parser)
    arguments = parse(parser, words)
    arguments.output = arguments.output or figures.folder_of(arguments.config, "families")
    rounds = Rounds(arguments)
    comparison = Comparison(rounds, say=lambda words: print(words, flush=True))
    rows = list(comparison.rows(arguments.subparts, arguments.step, arguments.azimuths))
    if all("reason" in row for row in rows):
        raise RunError(f"no run came to an end: {rows[0]['reason']}")
    record = {"unit": rounds.config["domain"].get("unit") or "", "target": comparison.target, "scan": comparison.scan}
    path = os.path.join(arguments.output, "families")
    figures.print_table(rows, FIRST, record["unit"])
    figures.write_table(rows, record, path, FIRST)
    draw(rows, record, path)


def add_scan(parser):
    """The words on the scan of tilted planar layers."""
    parser.add_argument("--step", type=between(*STEPS), default=20.0, metavar="DEGREES",
                        help="of the scan (default: %(default)s)")
    parser.add_argument("--azimuths", type=whole_number(1, 100), default=4, metavar="N",
                        help="sides of the scan in 3D (default: %(default)s)")
