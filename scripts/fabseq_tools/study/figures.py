# SPDX-License-Identifier: MIT
"""What a finished run comes to within the limits of a machine, as the program says it of its binary layers
(docs/reference.md, summary.json), and tables of several."""

import math
import os

import numpy as np

from fabseq_tools.run.check_words import inner, percent, result_of, share_beyond, tilt_limit, torch
from fabseq_tools.run.command_line import write_json, write_rows
from fabseq_tools.run.verdict_words import class_of, in_short, place_lines
from fabseq_tools.run.words import duration, number

# Columns of a table by their key in a row: heading, and how a value is shown.
COLUMNS = {"objective": ("objective", number), "skin": ("skin", number), "skin_released": ("released", number),
           "spread": ("spread", number),
           "thickness": ("thickness, 1 to 99 %", lambda span: " to ".join(f"{value:.2f}" for value in span)),
           "outside": ("out of range", percent), "beyond_tilt": ("beyond tilt", percent),
           "largest_tilt": ("tilt, no limit", lambda degrees: f"{degrees:.3g}°"), "blocked": ("blocked", str),
           "hanging": ("hanging", str), "verdict": ("verdict", str), "seconds": ("time", duration)}
SPREAD = "; spread of the first objective with 15 % more and less of the strain along each axis"


def row_of(run, target):
    """The figures of the run's binary layers. `target`: thickness of a layer.

    `objective`: length of the first distortion; `skin`, `skin_released`: root mean square of how far the skin
    deviates from its shape, as built and after the release; `spread`: how much of the first length the
    scenarios of the strain change; `thickness`: local thickness between its 1st and 99th percentile, relative
    to the target; `beyond_tilt`: share of the part, with a limit of the tilt; `largest_tilt`: in degrees,
    without one; `class`, `verdict`, `violated`: the program's verdict, in short, and its reasons in words;
    `places`: in words, where it cannot be built. Keys of what the run does not have are None."""
    state = result_of(run)
    block = run.summary[state]
    keys = {"skin": ("finished", "as_built", "skin", "rms"), "skin_released": ("finished", "released", "skin", "rms"),
            "outside": ("checks", "local_thickness", "share_outside"),
            "blocked": ("checks", "blocked", "elements"), "hanging": ("checks", "hanging", "elements")}
    row = {"objective": run.length(state), "spread": spread(run, block), "thickness": thickness_span(run, target)}
    row |= {key: inner(*names)(block) for key, names in keys.items()}
    row["beyond_tilt"] = share_beyond(run, state)
    row["largest_tilt"] = None if tilt_limit(run) else torch(run, state, "tilt").get("largest")
    return row | {"class": class_of(block["verdict"]), "verdict": in_short(block["verdict"]), "places": place_lines(block),
                  "violated": [reason["words"] for reason in block["verdict"]["reasons"]],
                  "seconds": run.summary["seconds"]["total"]}


def spread(run, block):
    """As a length, the root (docs/formulation.md 5.1)."""
    name = f"objective_{run.distortion_term}"
    return next((math.sqrt(term["spread"]) for term in block.get("scenarios", []) if term["name"] == name), None)


def thickness_span(run, target):
    """None where local thickness is not defined, as of layers in sub-parts, which are all as thick."""
    thickness = run.fields.get("local_thickness")
    known = None if thickness is None else thickness[(run.fields["density"] > 0) & (thickness > 0)]
    if known is None or not known.size:
        return None
    return [float(value) / target for value in np.percentile(known, [1, 99])]


def columns_of(rows):
    """Those of which some row has something."""
    return {key: column for key, column in COLUMNS.items() if any(row.get(key) is not None for row in rows)}


def print_table(rows, first, unit):
    """On the terminal. `first`: key and heading of the column that names a row."""
    columns = columns_of(rows)
    print(f"binary layers; lengths in {unit or 'length units'}: of the first objective, and root mean square of the skin's "
          f"deviation, as built and released{SPREAD * ('spread' in columns)}")
    lines = [[first[1], *headings(columns)]] + [cells(row, first[0], columns) for row in rows]
    whole = [line for line in lines if len(line) > 2]
    widths = [max(len(line[column]) for line in whole) for column in range(len(lines[0]))]
    widths[0] = max(len(line[0]) for line in lines)
    for line in lines:
        print("  ".join(cell.ljust(width) if not column or len(line) == 2 else cell.rjust(width)
                        for column, (cell, width) in enumerate(zip(line, widths))).rstrip())


def headings(columns):
    return [heading for heading, _ in columns.values()]


def cells(row, name, columns):
    """Texts of a row; of one without a result its reason."""
    if "reason" in row:
        return [row[name], row["reason"]]
    return [row[name], *("-" if row.get(key) is None else show(row[key]) for key, (_, show) in columns.items())]


def write_table(rows, record, path, first):
    """PATH.json with `record` around the rows, and PATH.csv."""
    write_json(path + ".json", record | {"rows": rows})
    flat = [{first[0]: row[first[0]], "reason": row.get("reason")} | {key: plain(row.get(key)) for key in columns_of(rows)}
            for row in rows]
    write_rows(path + ".csv", flat)
    print(path + ".json", path + ".csv", sep="\n")


def plain(value):
    return " to ".join(f"{each:.4g}" for each in value) if isinstance(value, list) else value


def folder_of(config_path, what):
    """Where a command puts its runs unless told: output/CONFIG_WHAT."""
    name = os.path.splitext(os.path.basename(config_path))[0]
    return os.path.join("output", f"{name}_{what}")
