# SPDX-License-Identifier: MIT
"""The sixth step of a plan: the drawing, moved against the distortion, and its layers, judged like those of
the drawing."""

import os
import shutil

from fabseq_tools.geometry import compensate
from fabseq_tools.plan.build import totals_of
from fabseq_tools.plan.quiet import quiet
from fabseq_tools.run.command_line import RunError, run_program, write_json
from fabseq_tools.run.progress import Progress
from fabseq_tools.run.read_run import Run, read_json
from fabseq_tools.run.verdict_words import rank
from fabseq_tools.run.words import less, quantity
from fabseq_tools.study import figures

FOLDER, LAYERS = "compensated", "layers"
NOT_MOVED = "run", "baseline", "optimizer", "stock", "output", "name"  # keys of the judged run that its round has or nobody needs


def compensate_drawing(steps, built):
    """What remains once the mesh is moved against the distortion: its `row` if that is welded; `refused` if
    the drawing's own layers are of a better class, and are welded; neither where nothing is moved."""
    row, folder = built["built"], steps.path(FOLDER)
    log = steps.path("compensated.log")
    words = [row["run"], "--output", folder, "--ranks", str(steps.arguments.ranks), "--program", steps.arguments.program,
             "--", "-set", "material.scenarios=[]", *steps.arguments.rest]
    with Progress("plan") as progress:
        try:
            progress.say("the mesh, moved against the distortion")
            quiet(compensate.main, words, log)
        except RunError as error:
            return {"line": f"not compensated: {error}"}
        record = read_json(folder, "compensation.json")
        best = record["best_round"]
        if best == 0:
            return {"line": f"as drawn: no moved mesh ends up nearer to it ({log})"}
        progress.say("the layers of the moved mesh")
        judged = judge(steps, row, folder, f"round_{best}")
    before, after = record["rounds"][0], record["rounds"][best]
    found = figures.row_of(Run(judged, simulations=True), 1.0)
    moved = row | {"layers": f"{row['layers']}, compensated drawing", "folder": FOLDER, "judged": judged,
                   **{key: found[key] for key in ("spread", "class", "verdict", "places")},
                   "skin_released": after["rms_fitted"], **totals_of(judged), "largest": after["largest_fitted"]}
    line = (f"{quantity(after['rms_fitted'], 'mm')} left of {quantity(before['rms_fitted'], 'mm')}, "
            f"{less(before['rms_fitted'] / after['rms_fitted'])} without; its layers: {found['verdict']}")
    if rank(found["class"]) > rank(row["class"]):
        return {"line": f"{line}; the drawing's own are {row['verdict']}: weld those", "refused": moved}
    shutil.copyfile(os.path.join(folder, "compensated.stl"), steps.path("compensated.stl"))
    return {"line": line, "row": moved, "stl": steps.path("compensated.stl")}


def judge(steps, row, folder, name):
    """The folder of a simulation of a round's layers with what the judged run of the drawing knows of
    machine, beads, heat and scenarios."""
    round_config, config = read_json(folder, f"{name}.json"), read_json(row["judged"], "config.json")
    of_beads = {key: config["layers"][key] for key in ("passes", "thickness") if key in config["layers"]}
    config = {key: value for key, value in config.items() if key not in NOT_MOVED}
    config |= {key: round_config[key] for key in ("domain", "part", "sequence")}
    config["layers"] = round_config["layers"] | of_beads
    path, output = os.path.join(folder, f"{LAYERS}.json"), os.path.join(folder, LAYERS)
    write_json(path, config)
    sequence = os.path.join(folder, f"{name}.h5")
    run_program(steps.arguments, path, "simulate", "-sequence", sequence, "-overwrite", "-output", output)
    return output
