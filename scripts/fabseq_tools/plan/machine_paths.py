# SPDX-License-Identifier: MIT
"""The seventh step of a plan: torch paths with pauses, and the starts of what it is compared with."""

import os

from fabseq_tools.paths import export_paths
from fabseq_tools.plan.quiet import quiet
from fabseq_tools.run.command_line import RunError
from fabseq_tools.run.progress import Progress
from fabseq_tools.run.read_run import read_json
from fabseq_tools.run.words import duration

SUMMARY = "paths_summary.json"


def write_paths(steps, built, drawing):
    """Starts of all sequences, and tilt and pause of each layer of what is welded."""
    welded = drawing.get("row") or built["built"]
    rows = {"welded": welded, "planar": built["planar"], "other": built["other"]}
    found, reasons = {}, {}
    with Progress("plan") as progress:
        for name, row in rows.items():
            if not row or "reason" in row:
                continue
            progress.say(f"paths of {row['layers']}")
            try:
                found[name] = paths_of(steps, row, name)
            except RunError as error:
                reasons[name] = str(error)
    if "welded" not in found:
        return {"line": f"no paths: {reasons['welded']}", "starts": {}}
    record = found["welded"]
    pauses = [layer["pause"] or 0.0 for layer in record["layers"]]
    layers = [{"layer": layer["layer"], "tilt": layer["angle"][1], "pause": layer["pause"]} for layer in record["layers"]]
    line = (f"{len(layers)} layers, {record['starts']:,} starts, {record['length'] / 1000:.3g} m of beads, "
            f"{duration(sum(pauses))} of pauses; tilt up to {max(layer['tilt'] for layer in layers):.3g}°")
    built_starts = {"built": record["starts"]} if welded is not built["built"] else {}
    return {"line": line, "layers": layers, "folder": steps.path("paths"), "programs": steps.arguments.post,
            "starts": {name: one["starts"] for name, one in found.items()} | built_starts}


def paths_of(steps, row, name):
    """The summary of a sequence's paths; those of what is welded are written for the machine as well."""
    folder = steps.path("paths") if name == "welded" else os.path.join(row["judged"], "paths")
    words = [row["judged"], "--output", folder]
    if name == "welded":
        words += [word for post in steps.arguments.post for word in ("--post", post)]
    else:
        words.append("--no-picture")
    quiet(export_paths.main, words, steps.path(f"paths_{name}.log"))
    return read_json(folder, SUMMARY)
