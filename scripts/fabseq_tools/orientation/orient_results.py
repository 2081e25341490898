# SPDX-License-Identifier: MIT
"""What `fabseq-tools orient` found, as files, a table and a picture."""

import os
import textwrap

import matplotlib.pyplot as plt
import numpy as np

from fabseq_tools.plot import render_part
from fabseq_tools.plot.drawing import OPTIMIZED, PLANAR, SOFT_INK, save, tidy
from fabseq_tools.run.command_line import write_json, write_rows
from fabseq_tools.run.read_run import read_fields, read_json
from fabseq_tools.run.words import number

SEQUENCES = "start", "planar"
STATES = "as_built", "released"
FIGURES = "rms", "largest"
COLOURS = {"start": OPTIMIZED, "planar": PLANAR}
PIXELS = 500, 500
SPAN_FOR_LOG = 20.0


def write(records, unit, folder):
    """orientation.json, .csv and .png of the records, best first, and the table on the terminal."""
    records = ranked(records)
    write_json(os.path.join(folder, "orientation.json"), records)
    rows = [row_of(record) for record in records]
    write_rows(os.path.join(folder, "orientation.csv"), rows, max(rows, key=len))
    print_table(records, unit or "length units")
    draw(records, unit, folder)


def figure_of(record, sequence, state, figure):
    """A deviation, or None where it is not known."""
    return record.get(sequence, {}).get(state, {}).get(figure)


def ranked(records):
    """Best first; what was refused comes last."""
    done = [record for record in records if "reason" not in record]
    sequence = "start" if all("start" in record for record in done) else "planar"
    state = "released" if all("released" in record[sequence] for record in done) else "as_built"
    done.sort(key=lambda record: figure_of(record, sequence, state, "rms"))
    return done + [record for record in records if "reason" in record]


def row_of(record):
    row = {"orientation": record["orientation"], "turn": " ".join(f"{axis} {angle:g}" for axis, angle in record["turn"]),
           "face_down": record["face_down"], "reason": record.get("reason")}
    if "reason" in record:
        return row
    row |= {key: record[key] for key in ("height", "geodesic_height", "contact_elements", "contact_area", "overhang")}
    for sequence in SEQUENCES:
        row |= {f"{sequence}_{key}": record.get(sequence, {}).get(key) for key in ("layers", "verdict")}
        row |= {f"{sequence}_{state}_{figure}": figure_of(record, sequence, state, figure)
                for state in STATES for figure in FIGURES}
    return row


def print_table(records, unit):
    head = ["orientation", "down", "height", "contact", "overhang"]
    for sequence in SEQUENCES:
        head += [f"{sequence} layers", "rms", "released", "largest", "released", "verdict"]
    lines = [head]
    for record in records:
        line = [record["orientation"], record["face_down"] or "-"]
        if "reason" in record:
            lines.append(line + [record["reason"]])
            continue
        line += [size(record[key]) for key in ("height", "contact_area", "overhang")]
        for sequence in SEQUENCES:
            line.append(str(record.get(sequence, {}).get("layers", "-")))
            figures = [figure_of(record, sequence, state, figure) for figure in FIGURES for state in STATES]
            line += ["-" if value is None else number(value) for value in figures]
            line.append(record.get(sequence, {}).get("verdict") or "-")
        lines.append(line)
    whole = [line for line in lines if len(line) == len(head)]
    widths = [max(len(line[column]) for line in whole) for column in range(len(head))]
    widths[:2] = [max(len(line[column]) for line in lines) for column in range(2)]
    print(f"deviations of the surface in {unit}, best first")
    for line in lines:
        print("  ".join(cell.ljust(width) if column < 2 or len(line) < len(head) else cell.rjust(width)
                        for column, (cell, width) in enumerate(zip(line, widths))).rstrip())


def size(value):
    """Of the part: 205, 16,400."""
    return f"{value:,.0f}" if value >= 1000 else number(value)


def draw(records, unit, folder):
    """The part in its start layers in each orientation, all at one scale, above its deviations."""
    count = len(records)
    figure = plt.figure(figsize=(max(2.3 * count, 7.0), 8.4), layout="constrained")
    grid = figure.add_gridspec(3, count, height_ratios=(1.25, 1.0, 1.0))
    pictures = pictures_of(records, folder)
    for column, record in enumerate(records):
        axis = figure.add_subplot(grid[0, column])
        axis.axis("off")
        axis.set_title(record["orientation"] + (f", {record['face_down']} down" if record["face_down"] else ""), fontsize=10)
        if "reason" in record:
            reason = "\n".join(textwrap.wrap("refused: " + record["reason"], 30)[:9])
            axis.text(0.5, 0.5, reason, ha="center", va="center", fontsize=7, transform=axis.transAxes)
            continue
        axis.imshow(pictures[column])
        axis.text(0.5, -0.02, words_of(record, unit), ha="center", va="top", fontsize=8, color=SOFT_INK, transform=axis.transAxes)
    for line, (name, title) in enumerate(zip(FIGURES, ("rms", "largest"), strict=True), start=1):
        draw_bars(figure.add_subplot(grid[line, :]), records, name, f"{title} deviation" + (f", {unit}" if unit else ""))
    if any("reason" not in record for record in records):
        figure.axes[-2].legend(frameon=False, fontsize=8, ncols=4, loc="lower right", bbox_to_anchor=(1.0, 1.0))
    save(figure, os.path.join(folder, "orientation.png"), 130)


def words_of(record, unit):
    of_length, of_area = (f" {unit}", f" {unit}²") if unit else ("", "")
    counts = " / ".join(str(record[sequence]["layers"]) for sequence in SEQUENCES if sequence in record)
    return (f"height {size(record['height'])}{of_length}, layers {counts}\ncontact {size(record['contact_area'])}{of_area}\n"
            f"overhang {size(record['overhang'])}{of_area}")


def pictures_of(records, folder):
    """An image for each record that has one, else None."""
    parts, layers = [], []
    for record in records:
        found = [os.path.join(folder, record["folder"], sequence) for sequence in SEQUENCES if sequence in record]
        if "reason" in record:
            parts.append(None)
            layers.append(None)
            continue
        config, fields = read_json(found[0], "config.json"), read_fields(os.path.join(found[0], "result.h5"))
        parts.append(render_part.VoxelPart(fields["density"], config["domain"]["size"], config.get("build_plate", "z-")))
        layers.append(fields["layer"])
    longest = max((max(part.size) for part in parts if part), default=1.0)
    corners = longest * (np.array(list(np.ndindex(2, 2, 2))) - 0.5)
    return [part and render_part.render(part, render_part.layer_colours(part, layer, int(layer.max())), pixels=PIXELS,
                                        frame=corners + 0.5 * np.array(part.size)) for part, layer in zip(parts, layers)]


def draw_bars(axis, records, figure, label):
    tidy([axis])
    heights = []
    for place, (sequence, state) in enumerate((sequence, state) for sequence in SEQUENCES for state in STATES):
        values = [figure_of(record, sequence, state, figure) for record in records]
        known = [(column, value) for column, value in enumerate(values) if value is not None]
        heights += [value for _, value in known]
        if known:
            axis.bar([column + 0.2 * (place - 1.5) for column, _ in known], [value for _, value in known], 0.18,
                     color=COLOURS[sequence], alpha=0.45 if state == "as_built" else 1.0,
                     label=f"{sequence}, {state.replace('_', ' ')}")
    if heights and min(heights) > 0 and max(heights) > SPAN_FOR_LOG * min(heights):
        axis.set_yscale("log")
    axis.set_xlim(-0.5, len(records) - 0.5)
    axis.set_xticks(range(len(records)), [record["orientation"] for record in records])
    axis.set_ylabel(label)
