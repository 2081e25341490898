# SPDX-License-Identifier: MIT
"""The second step of a plan: which way up the part is built."""

import argparse
import os

from fabseq_tools.orientation.orient import records_of, six_turns
from fabseq_tools.orientation.orient_results import figure_of
from fabseq_tools.orientation.turned_config import with_absolute_files
from fabseq_tools.plan.configs import AS_DRAWN, coarse_config
from fabseq_tools.run.command_line import RunError
from fabseq_tools.run.progress import Progress
from fabseq_tools.run.read_run import read_config
from fabseq_tools.run.verdict_words import rank
from fabseq_tools.run.words import factor, quantity

WORTH = 0.8    # of the distortion as drawn: above it nobody turns a part
FOOTING = 0.5  # of the area that it stands on as drawn: on less nobody puts it for a smaller distortion


def settle_orientation(steps, part):
    """The turn about each axis, and what the orientations come to."""
    arguments = steps.arguments
    if arguments.rotate is not None:
        return {"line": f"turned by {words_of(arguments.rotate)}, as asked for (--rotate)" if any(arguments.rotate) else
                "as drawn, as asked for (--rotate)", "rotate": arguments.rotate}
    made = coarse_config(arguments, steps.path("coarse", f"{arguments.name}_as_drawn.json"), part["scale"], AS_DRAWN)
    config = with_absolute_files(read_config(made.path), os.path.dirname(os.path.abspath(made.path)))
    options = argparse.Namespace(config=made.path, output=steps.path("coarse", "orientations"), ranks=1,
                                 program=arguments.program, rest=arguments.rest)
    turns = six_turns(config.get("build_plate", "z-"))
    with Progress("plan") as progress:
        records = records_of(options, config, turns, progress.say)
    done = [record for record in records if "reason" not in record]
    if not done:
        raise RunError(f"{arguments.part}: the program refuses every orientation; of the part as drawn it says: "
                       f"{records[0]['reason']}")
    drawn = records[0] if records[0] in done else None
    best = min(done if drawn is None else [drawn, *(record for record in done if clearly_better(record, drawn))], key=merit)
    return {"line": line_of(best, drawn, records), "rotate": rotation_of(best["turn"])}


def merit(record):
    """Rank of the class, then length: of the design that optimizations begin with."""
    return rank(record["start"]["class"]), length_of(record)


def length_of(record):
    released = figure_of(record, "start", "released", "rms")
    return figure_of(record, "start", "as_built", "rms") if released is None else released


def clearly_better(record, drawn):
    (own, length), (of_drawn, length_drawn) = merit(record), merit(drawn)
    return own < of_drawn or own == of_drawn and length < WORTH * length_drawn and stands(record, drawn)


def stands(record, drawn):
    return record["contact_area"] >= FOOTING * drawn["contact_area"]


def rotation_of(turn):
    return [sum(degrees for axis, degrees in turn if axis == name) for name in "xyz"]


def words_of(rotate):
    return ", ".join(f"{degrees:g}° about {axis}" for axis, degrees in zip("xyz", rotate) if degrees)


def line_of(best, drawn, records):
    found = f"{quantity(length_of(best), 'mm')} in evenly curved layers"
    if best is drawn:
        others = [record for record in records if "reason" not in record and record is not drawn]
        if not others:
            return f"as drawn: {found}"
        least = min(others, key=length_of)
        area = "" if stands(least, drawn) else \
            f", which stands on {least['contact_area']:,.0f} mm² of the plate, " \
            f"as drawn on {drawn['contact_area']:,.0f}"
        return f"as drawn: {found}, at least {quantity(length_of(least), 'mm')} in {len(others)} others{area}"
    line = f"turned by {words_of(rotation_of(best['turn']))}: {found}"
    if drawn is None:
        return f"{line}; the program refuses the part as drawn"
    ratio = length_of(drawn) / length_of(best)
    if ratio > 1.05:
        return f"{line}, {factor(ratio)} times less than as drawn"
    return f"{line}, as drawn {quantity(length_of(drawn), 'mm')} but {drawn['start']['verdict']}"
