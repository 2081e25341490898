# SPDX-License-Identifier: MIT
"""What a finished run comes to within the limits of a machine, by the exact checks of its binary layers
(docs/formulation.md 13.1), and tables of several."""

import math
import os

import numpy as np

from fabseq_tools.geometry.grid import node_positions, nodes_of
from fabseq_tools.geometry.rigid_motions import without_rigid_motion
from fabseq_tools.run.check_words import inner, most_tilt, percent, result_of
from fabseq_tools.run.command_line import write_json, write_rows
from fabseq_tools.run.words import duration, number

USUAL_SHARE = 1e-3  # the limit of constraints that say none (docs/reference.md)

# Columns of a table by their key in a row: heading, and how a value is shown.
COLUMNS = {"objective": ("objective", number), "skin": ("skin", number), "skin_released": ("released", number),
           "thickness": ("thickness, 1 to 99 %", lambda span: " to ".join(f"{value:.2f}" for value in span)),
           "outside": ("out of range", percent), "beyond_tilt": ("beyond tilt", percent), "blocked": ("blocked", str),
           "hanging": ("hanging", str), "satisfied": ("satisfied", lambda yes: "yes" if yes else "no"),
           "seconds": ("time", duration)}


def row_of(run, target, limits=None):
    """The figures of the run's binary layers. `target`: thickness of a layer. `limits`: of the constraints by
    type, the share of the part that may be beyond tilt or range; by default those of the run.

    `objective`: length of the first distortion; `skin`, `skin_released`: root mean square of how far the skin
    deviates from its shape, as built and after the release; `thickness`: local thickness between its 1st and
    99th percentile, relative to the target. Keys of what the run does not have are None."""
    state = result_of(run)
    block = run.summary[state]
    skin = Skin(run)
    built = run.fields["displacement" if state == "simulated" else "binary/displacement"]
    released = run.fields.get("release_displacement" if state == "simulated" else "binary/release_displacement")
    row = {"objective": run.length(state), "skin": skin.deviation(built),
           "skin_released": None if released is None else skin.deviation(built + released),
           "thickness": thickness_span(run, target)}
    checks = {"outside": ("local_thickness", "share_outside"), "beyond_tilt": ("tilt", "share"),
              "blocked": ("blocked", "elements"), "hanging": ("hanging", "elements")}
    row |= {key: inner("checks", *names)(block) for key, names in checks.items()}
    row["violated"] = violated(row, run, limits or allowed_shares(run.config.get("constraints", [])))
    return row | {"satisfied": not row["violated"], "seconds": run.summary["seconds"]["total"]}


class Skin:
    """The nodes on the surface of a run's part."""

    def __init__(self, run):
        part = run.fields["density"] > 0
        padded = np.pad(~part, 1, constant_values=True)  # nothing lies beyond the box
        outside = nodes_of(padded).reshape([n + 1 for n in padded.shape])[(slice(1, -1),) * part.ndim]
        self.nodes = nodes_of(part) & outside.ravel()
        domain = run.config["domain"]
        self.positions = node_positions(domain["size"], domain["elements"])[self.nodes]

    def deviation(self, displacement):
        """Root mean square after the best rigid fit."""
        moved = displacement.reshape(len(self.nodes), -1)[self.nodes]
        return math.sqrt(np.sum(without_rigid_motion(moved, self.positions)**2, axis=1).mean())


def thickness_span(run, target):
    """None where local thickness is not defined, as of layers in sub-parts, which are all as thick."""
    thickness = run.fields.get("local_thickness")
    known = None if thickness is None else thickness[(run.fields["density"] > 0) & (thickness > 0)]
    if known is None or not known.size:
        return None
    return [float(value) / target for value in np.percentile(known, [1, 99])]


def allowed_shares(constraints):
    """Which share of the part these constraints let pass: the exact share is at most the count that they
    limit. Without a constraint none."""
    found = {constraint["type"]: constraint.get("limit", USUAL_SHARE) for constraint in constraints}
    return {kind: found.get(kind, 0.0) for kind in ("tilt", "local_thickness")}


def violated(row, run, limits):
    """What keeps a machine from building these layers, a text each."""
    reasons = []
    if (row["outside"] or 0.0) > limits["local_thickness"]:
        reasons.append(f"{percent(row['outside'])} out of thickness")
    if (row["beyond_tilt"] or 0.0) > limits["tilt"]:
        reasons.append(f"{percent(row['beyond_tilt'])} beyond {most_tilt(run)}")
    if row["blocked"]:
        reasons.append(f"{row['blocked']:,} elements out of the torch's reach")
    if row["hanging"]:
        reasons.append(f"{row['hanging']:,} elements begin in the air")
    return reasons


def print_table(rows, first, unit):
    """On the terminal. `first`: key and heading of the column that names a row."""
    print(f"binary layers; lengths in {unit or 'length units'}: of the first objective, and root mean square of the skin's "
          "deviation, as built and released")
    lines = [[first[1], *(heading for heading, _ in COLUMNS.values())]] + [cells(row, first[0]) for row in rows]
    whole = [line for line in lines if len(line) > 2]
    widths = [max(len(line[column]) for line in whole) for column in range(len(lines[0]))]
    widths[0] = max(len(line[0]) for line in lines)
    for line in lines:
        print("  ".join(cell.ljust(width) if not column or len(line) == 2 else cell.rjust(width)
                        for column, (cell, width) in enumerate(zip(line, widths))).rstrip())


def cells(row, name):
    """Texts of a row; of one without a result its reason."""
    if "reason" in row:
        return [row[name], row["reason"]]
    return [row[name], *("-" if row[key] is None else show(row[key]) for key, (_, show) in COLUMNS.items())]


def write_table(rows, record, path, first):
    """PATH.json with `record` around the rows, and PATH.csv."""
    write_json(path + ".json", record | {"rows": rows})
    flat = [{first[0]: row[first[0]], "reason": row.get("reason")} | {key: plain(row.get(key)) for key in COLUMNS}
            for row in rows]
    write_rows(path + ".csv", flat)
    print(path + ".json", path + ".csv", sep="\n")


def plain(value):
    return " to ".join(f"{each:.4g}" for each in value) if isinstance(value, list) else value


def folder_of(config_path, what):
    """Where a command puts its runs unless told: output/CONFIG_WHAT."""
    name = os.path.splitext(os.path.basename(config_path))[0]
    return os.path.join("output", f"{name}_{what}")
