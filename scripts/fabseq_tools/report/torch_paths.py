# SPDX-License-Identifier: MIT
"""The table of a report about the torch paths that `fabseq-tools paths` left in a run's directory."""

import os
from html import escape

from fabseq_tools.report.tables import cell, digits, table
from fabseq_tools.run.words import whole

SUMMARY = os.path.join("paths", "paths_summary.json")
COUNTS = ("starts", "length", "travel")
RANGES = {"height": "local height", "angle": "torch from the plate's normal, degrees", "feed": "factor of the feed"}


def paths(run):
    """A row per layer and one for all of them; empty without paths."""
    record = run.paths
    if not record:
        return ""
    rows = [(f"layer {layer['layer']}", cells(layer, layer)) for layer in record["layers"]]
    spans = {key: [min(layer[key][0] for layer in record["layers"]), max(layer[key][1] for layer in record["layers"])]
             for key in RANGES} if rows else {}
    unit = record.get("unit") or ""
    head = ["", "starts", *(f"{key}, {unit}" if unit else key for key in COUNTS[1:]), *RANGES.values(), "wire / volume",
            "no bead fills, %"]
    return (f'<p>{escape(judged(record))}</p>'
            f'<p class="note">Bead width {digits(record["bead_width"])} {unit}, {record["waypoints"]:,} waypoints, '
            f'of {record["of"]} layers.</p>' + table(head, [("all layers", cells(record, spans)), *rows], id="paths"))


def judged(record):
    """The verdict on the layers, and what crosses on the way between passes."""
    verdict, ways = record.get("verdict"), record.get("ways") or {"crossing": []}
    words = whole(verdict["words"] if verdict else "not judged by this run")
    if ways["crossing"]:
        words += f" {len(ways['crossing'])} of {ways['count']} straight rapid ways between passes cross what stands."
    return words


def cells(record, ranges):
    shown = [" to ".join(map(digits, ranges[key])) if ranges.get(key) else None for key in RANGES]
    return [*(cell(record.get(key)) for key in COUNTS), *(cell(words, title=words or "") for words in shown),
            cell(record["wire"] / record["volume"] if record.get("volume") else None),
            cell(100 * record["missed"] if "missed" in record else None)]
