# SPDX-License-Identifier: MIT
"""The fourth step of a plan: which kind of layers, found with few elements, and whether optimizing pays."""

import argparse

from fabseq_tools.plan.watched import Watched
from fabseq_tools.run.command_line import RunError
from fabseq_tools.run.verdict_words import rank
from fabseq_tools.run.words import factor, number, quantity
from fabseq_tools.study.comparison import Comparison
from fabseq_tools.study.rounds import Rounds

SUBPARTS, STEP, AZIMUTHS = [2], 30.0, 4  # of compare-families
OPTIMIZED = "multi_planar", "guided"     # begin the folders of what has to be optimized
ALIKE = 1.05                             # a gain below is none


def compare_layers(steps, placed):
    """The rows of all kinds, the best of those that nobody has to optimize, and what is built."""
    arguments, folder = steps.arguments, steps.path("coarse", "layers")
    with Watched(folder) as progress:
        comparison = Comparison(rounds_of(arguments, placed["config"], folder), say=progress.say)
        rows = list(comparison.rows(SUBPARTS, STEP, AZIMUTHS, curved=("guided",)))
    known = [row for row in rows if "reason" not in row]
    simple = [row for row in known if not is_optimized(row)]
    if not simple:
        raise RunError(f"planar layers cannot be simulated: {rows[0]['reason']}")
    simplest, best = (min(some, key=merit, default=None) for some in (simple, [row for row in known if is_optimized(row)]))
    planar = next((row for row in simple if row["folder"] == "planar"), simplest)
    why, pays = judged(planar, simplest, best, arguments.share)
    chosen = best if best and (pays or arguments.optimize) else simplest
    line = "; ".join(f"{row['layers']} {number(length(row))} mm, {row['verdict']}" for row in known)
    line += "".join(f"; {row['layers']}: {row['reason']}" for row in rows if "reason" in row)
    return {"line": f"{line}. {why}", "why": why, "pays": pays, "rows": rows, "simplest": simplest, "chosen": chosen,
            "optimized": is_optimized(chosen)}


def rounds_of(arguments, config, folder):
    """Runs of a config, whose machine it names itself."""
    return Rounds(argparse.Namespace(**vars(arguments) | {"config": config, "output": folder, "machine": None}))


def is_optimized(row):
    return row["folder"].startswith(OPTIMIZED)


def length(row):
    """Root mean square of the skin's deviation, after the release where there is one."""
    return row["skin"] if row.get("skin_released") is None else row["skin_released"]


def merit(row):
    return rank(row["class"]), length(row)


def judged(planar, simplest, best, share):
    """In words, and whether optimizing pays. `simplest`: the best layers without it; `best`: those with
    it."""
    name = f"build it in {simplest['layers']}"
    if best is None:
        return f"No optimized layers: {name}", False
    if rank(best["class"]) < rank(simplest["class"]):
        return (f"Optimizing pays: {best['layers']} layers are {best['verdict']}, the best others, {simplest['layers']}, "
                f"{simplest['verdict']}"), True
    gain, simple_gain = length(planar) - length(best), length(planar) - length(simplest)
    ratio = length(simplest) / length(best)
    if rank(best["class"]) > rank(simplest["class"]):
        return (f"Optimizing does not pay: {best['layers']} layers are {best['verdict']}; {name}, which are "
                f"{simplest['verdict']}"), False
    if gain <= 0.0 or ratio < ALIKE:
        return f"Optimizing does not pay: {name}, where {quantity(length(simplest), 'mm')} are left, optimized " \
               f"{quantity(length(best), 'mm')}", False
    if simple_gain >= share * gain:
        return f"Optimizing does not pay: {name}: {simple_gain / gain:.0%} of the gain", False
    return (f"Optimizing pays: {best['layers']} layers distort {factor(ratio)} times less than the best others, "
            f"{simplest['layers']}"), True
