# SPDX-License-Identifier: MIT
"""The seventh step of a plan: torch paths with pauses, and the starts of what it is compared with."""

import concurrent.futures
import os
import sys

from fabseq_tools.paths import export_paths, posts
from fabseq_tools.run.command_line import RunError, run_command
from fabseq_tools.run.places import ENTRY, NAME
from fabseq_tools.run.progress import Progress
from fabseq_tools.run.read_run import read_json
from fabseq_tools.run.words import duration

SUMMARY = "paths_summary.json"


def write_paths(steps, built, drawing):
    """Starts of all sequences, and tilt and pause of each layer of what is welded."""
    welded = drawing.get("row") or built["built"]
    rows = {"welded": welded, "planar": built["planar"], "other": built["other"]}
    rows = {name: row for name, row in rows.items() if row and "reason" not in row}
    found = {}
    with Progress("plan") as progress, concurrent.futures.ThreadPoolExecutor(max_workers=steps.arguments.ranks) as workers:
        waiting = {name: workers.submit(paths_of, steps, row, name) for name, row in rows.items()}
        for name, result in waiting.items():
            progress.say(f"paths of {rows[name]['layers']}")
            try:
                found[name] = result.result()
            except RunError as error:
                if name == "welded":
                    return {"line": f"no paths: {reason_of(error)}", "starts": {}}
    record = found["welded"]
    pauses = [layer["pause"] or 0.0 for layer in record["layers"]]
    layers = [{"layer": layer["layer"], "tilt": layer["angle"][1], "pause": layer["pause"]} for layer in record["layers"]]
    line = (f"{len(layers)} layers, {record['starts']:,} starts, {record['length'] / 1000:.3g} m of beads, "
            f"{duration(sum(pauses))} of pauses; tilt up to {max(layer['tilt'] for layer in layers):.3g}°")
    built_starts = {"built": record["starts"]} if welded is not built["built"] else {}
    return {"line": line, "layers": layers,
            "starts": {name: one["starts"] for name, one in found.items()} | built_starts}


def paths_of(steps, row, name):
    """The summary of a sequence's paths; those of what is welded are written for the machine as well."""
    folder = steps.path("paths") if name == "welded" else os.path.join(row["judged"], "paths")
    words = posts.words_of(steps.arguments) if name == "welded" else ["--no-picture"]
    done = run_command([sys.executable, ENTRY, export_paths.COMMAND, row["judged"], "--output", folder, *words])
    with open(steps.path(f"paths_{name}.log"), "w", encoding="utf-8") as file:
        file.write(done.stdout + done.stderr)
    return read_json(folder, SUMMARY)


def reason_of(error):
    """The command's own line."""
    return str(error).splitlines()[-1].removeprefix(f"{NAME} {export_paths.COMMAND}: ")
