# SPDX-License-Identifier: MIT
"""Runs a part at several limits of a machine, to show what each costs: a curve and a table.

    fabseq-tools tradeoff CONFIG.json [--over thickness|tilt] [--points 6] [--values V...] [--ranks 2]
                          [--output DIR] [--program build/release/fabseq] [-- OPTIONS OF THE PROGRAM]

The limit is the range of local thickness (tool.thickness, relative to the target), or with --over tilt the
largest tilt (tool.max_tilt). The config needs a layer_thickness constraint, which says the target, and a
sequence with a design. A constraint on the limit is added where the config has none. Ranges of thickness are
powers of the config's own range, from its square to its root of fourth order; tilts go from 15 degrees to 90.
--values says others: 0.5,2 0.6,1.6 0.8,1.25 or 30 45 60.

The strictest limit comes first, and the run takes the config's own iterations. Each of the others starts from
the design of the one before, which keeps its wider limit, too, and takes half as many iterations at the end
of the schedules (--iterations for another number).

Into DIR, by default output/CONFIG_tradeoff, go tradeoff_thickness.json, .csv, .svg and .png (or
tradeoff_tilt), and a folder for each run. A run that is done is not repeated, and one that was interrupted
goes on: the command can be killed and called again. `fabseq-tools report` shows curve and table in the page
of any of these runs, and of DIR where that is the folder of a run itself. `verdict` is the program's
(summary.json): whether the machine can build these binary layers, by the exact checks. It counts every
element, also those that a constraint lets pass.
"""

import math
import os

from fabseq_tools.run.command_line import RunError, count, parse, whole_number
from fabseq_tools.study import figures
from fabseq_tools.study.rounds import Rounds, parser_of_rounds, with_constraint
from fabseq_tools.study.tradeoff_picture import draw

COMMAND = "tradeoff"

FIRST = "limit", "limit"  # key and heading of a table's first column
FEWEST, MOST = 2, 20      # points
USUAL_RANGE = [0.5, 1.5]  # of tool.thickness
WIDEST, NARROWEST = 2.0, 0.25  # powers of the config's own range
TILTS = 15.0, 90.0        # degrees
WITHOUT_DESIGN = "planar", "file"  # types of sequences


class Thickness:
    """Limits on local thickness, each a pair of factors of the target."""

    key, constraint, label = "tool.thickness", "local_thickness", "local thickness, relative to the target"

    @staticmethod
    def values(config, points):
        own = config.get("tool", {}).get("thickness", USUAL_RANGE)
        powers = [NARROWEST * (WIDEST / NARROWEST)**(k / (points - 1)) for k in range(points)]
        return [[round(bound**power, 3) for bound in own] for power in powers]

    @staticmethod
    def read(word):
        low, high = map(float, word.split(","))
        if not 0.0 < low <= 1.0 <= high < math.inf or low == high:
            raise ValueError
        return [low, high]

    allowed = "two numbers with 1 between them, such as 0.6,1.6"

    @staticmethod
    def place(value):
        """On the axis of the curve."""
        return value[1] / value[0]

    @staticmethod
    def holds(wide, narrow):
        return wide[0] <= narrow[0] and narrow[1] <= wide[1]

    @staticmethod
    def words(value):
        return f"{value[0]:g} to {value[1]:g}"


class Tilt:
    """Limits on the tilt, in degrees."""

    key, constraint, label = "tool.max_tilt", "tilt", "largest tilt, degrees"

    @staticmethod
    def values(_, points):
        return [round(TILTS[0] + (TILTS[1] - TILTS[0]) * k / (points - 1), 1) for k in range(points)]

    @staticmethod
    def read(word):
        value = float(word)
        if not 0.0 < value <= 180.0:
            raise ValueError
        return value

    allowed = "a number of degrees, above 0 and at most 180"

    @staticmethod
    def place(value):
        return value

    @staticmethod
    def holds(wide, narrow):
        return narrow <= wide

    @staticmethod
    def words(value):
        return f"{value:g} degrees"


LIMITS = {"thickness": Thickness, "tilt": Tilt}


def name_of(over):
    """Of the files of a trade-off, without their endings."""
    return f"{COMMAND}_{over}"


def main(words):
    parser = parser_of_rounds(__doc__, COMMAND, "CONFIG.json", None)
    parser.add_argument("--over", choices=list(LIMITS), default="thickness", help="limit that varies (default: %(default)s)")
    parser.add_argument("--points", type=whole_number(FEWEST, MOST), default=6, help="number of runs (default: %(default)s)")
    parser.add_argument("--values", nargs="+", metavar="V", help="limits themselves")
    parser.add_argument("--iterations", type=count, metavar="N", help="of each run but the first (default: half of its own)")
    arguments = parse(parser, words)
    arguments.output = arguments.output or figures.folder_of(arguments.config, COMMAND)
    limit, rounds = LIMITS[arguments.over], Rounds(arguments)
    kind = rounds.config["sequence"].get("type")
    if kind in WITHOUT_DESIGN:
        raise RunError(f"{arguments.config}: sequence.type: found {kind}; allowed: one with a design")
    target, values = rounds.target_thickness(), values_of(arguments, limit, rounds.config)
    record = {"over": arguments.over, "key": limit.key, "label": limit.label, "unit": rounds.config["domain"].get("unit") or ""}
    path, rows, design = os.path.join(arguments.output, name_of(arguments.over)), [], None
    for number, value in enumerate(values, start=1):
        print(f"{number} of {len(values)}: {limit.key} {limit.words(value)}", flush=True)
        row, run = point(rounds, limit, value, design, arguments.iterations, target)
        rows.append(row)
        if run:
            design = os.path.join(arguments.output, row["folder"], "result.h5")
            record |= references(run)
    if all("reason" in row for row in rows):
        raise RunError(f"no run came to an end: {rows[0]['reason']}")
    figures.print_table(rows, FIRST, record["unit"])
    figures.write_table(rows, record, path, FIRST)
    draw(rows, record, path)


def values_of(arguments, limit, config):
    """The limits, strictest first."""
    if not arguments.values:
        return limit.values(config, arguments.points)
    try:
        values = sorted((limit.read(word) for word in arguments.values), key=limit.place)
    except ValueError as error:
        raise RunError(f"--values: found {' '.join(arguments.values)}; allowed: {limit.allowed}, each") from error
    for narrow, wide in zip(values, values[1:]):
        if not limit.holds(wide, narrow):
            raise RunError(f"--values: found {limit.words(narrow)} and {limit.words(wide)}; allowed: limits of which each holds "
                           "the one before, whose design it starts from")
    return values


def point(rounds, limit, value, design, iterations, target):
    """The row of one limit, and its run; no run, and the reason in the row, where the program has none."""
    settings = {limit.key: value, "constraints": with_constraint(rounds.config["constraints"], limit.constraint)}
    options = []
    if design:
        settings |= later_schedule(rounds.config.get("optimizer", {}), iterations)
        options = ["-design", design]
    name = "_".join([limit.key.rpartition(".")[2], *(f"{bound:g}" for bound in (value if isinstance(value, list) else [value]))])
    row = {"limit": limit.words(value), "value": value, "place": limit.place(value), "folder": name}
    try:
        run = rounds.run(name, settings, options=options)
    except RunError as error:
        print(f"  {error}", flush=True)
        return row | {"reason": str(error)}, None
    return row | figures.row_of(run, target), run


def later_schedule(optimizer, iterations):
    """Settings of a run that starts from an optimized design: the last part of the schedules of the whole."""
    planned = optimizer.get("max_iterations", 120) + optimizer.get("coarse_iterations", 0)
    planned += optimizer.get("start_iterations", 15) if optimizer.get("starts") else 0
    own = iterations or max(1, planned // 2)
    return {"optimizer.max_iterations": own, "optimizer.coarse_iterations": 0, **without_starts(optimizer),
            "optimizer.earlier_iterations": optimizer.get("earlier_iterations", 0) + max(0, planned - own)}


def without_starts(optimizer):
    """A setting where the config has some: a run that starts from a design has no others."""
    return {"optimizer.starts": []} if optimizer.get("starts") else {}


def references(run):
    """Lengths of the same measure that no limit changes."""
    return {"measure": run.measure(), "planar": run.length("baseline")}
