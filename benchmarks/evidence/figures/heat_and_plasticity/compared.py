# SPDX-License-Identifier: MIT
"""Models held against CalculiX: errors, gains with error bars, and the factor that a linear model needs.

The models with plastic flow take no factor. A linear one takes that for its strain which fits the planar case
best, for each type of brick of CalculiX. Some sequences have refined bricks, too, on elements of half the
size, against which the models with plastic flow are held.
"""

import numpy as np

BRICKS = ("C3D8I", "C3D8")                        # of CalculiX; tables judge by the first where they name none
REFINED = {kind: f"{kind} refined" for kind in BRICKS}   # the same, elements of half the size
FLOW, HOTTER = "flow", "flow 1200"                # steel.CUT_OFF, and a cut-off of 1200
# Elements of half the size, and with them heat properties that are constants.
FINE, FINE_HOTTER, FINE_CONSTANTS = FINER = ("flow fine", "flow fine 1200", "flow fine constants")
FLOWS = (FLOW, HOTTER, *FINER)
LINEAR = ("constant", "thermal", "own cooling")   # the last is own_cooling.py, with the temperatures of CalculiX


def compared(fields):
    """Figures per sequence from fields {sequence: {brick or model: displacements (node, 3)}}: of a brick its
    rms and its difference from every other; of a model, against each brick, scale, rms and error."""
    found = {}
    for sequence, of in fields.items():
        kinds = [kind for kind in (*BRICKS, *REFINED.values()) if kind in of]
        found[sequence] = {kind: {"rms": rms(of[kind]), "difference": {other: relative(of[kind], of[other])
                                                                       for other in kinds}} for kind in kinds}
        for model in (*FLOWS, *LINEAR):
            found[sequence][model] = {kind: against(of[model], of[kind], scale_of(fields["planar"], model, kind))
                                      for kind in kinds if model in FLOWS or kind in BRICKS}
    return found


def scale_of(planar, model, kind):
    """The factor of a model's strain."""
    if model in FLOWS:
        return 1.0
    return float(np.sum(planar[kind] * planar[model]) / np.sum(planar[model]**2))


def against(ours, theirs, scale):
    return {"scale": scale, "rms": rms(scale * ours), "error": relative(scale * ours, theirs)}


def relative(ours, theirs):
    return rms(ours - theirs) / rms(theirs)


def rms(displacement):
    return float(np.sqrt(np.mean(np.sum(displacement**2, axis=1))))


def gain(row, planar, name):
    """How many times larger the rms of planar layers is, by a brick or model; None where one is missing."""
    if name not in row or name not in planar:
        return None
    return rms_of(planar, name) / rms_of(row, name)


def rms_of(row, name):
    return row[name]["rms"] if "rms" in row[name] else row[name][BRICKS[0]]["rms"]


def best_gain(row, planar):
    """The gain by CalculiX's first type of brick on its finest elements, and an error bar: the larger of the
    differences that finer elements and the other type of brick, on the finest elements that it has, make."""
    coarse, refined = ([gain(row, planar, kind) for kind in kinds] for kinds in (BRICKS, REFINED.values()))
    other = abs(coarse[1] - coarse[0]) if None in refined else abs(refined[1] - refined[0])
    if refined[0] is None:
        return coarse[0], other
    return refined[0], max(other, abs(refined[0] - coarse[0]))
