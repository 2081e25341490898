# SPDX-License-Identifier: MIT
"""Models held against CalculiX: errors, and the factor that a linear model needs.

The models with plastic flow take no factor. A linear one takes that for its strain which fits the planar case
best, for each type of brick of CalculiX.
"""

import numpy as np

BRICKS = ("C3D8I", "C3D8")                        # of CalculiX; tables judge by the first where they name none
FLOW, HOTTER, FINER = "flow", "flow 1200", "flow fine"   # steel.CUT_OFF, a cut-off of 1200, elements of half the size
FLOWS = (FLOW, HOTTER, FINER)
LINEAR = ("constant", "thermal", "own cooling")   # the last is own_cooling.py, with the temperatures of CalculiX


def compared(fields):
    """Figures per sequence from fields {sequence: {brick or model: displacements (node, 3)}}: of a brick its
    rms and its difference from the first type; of a model, against each type, scale, rms and error."""
    found = {}
    for sequence, of in fields.items():
        found[sequence] = {kind: {"rms": rms(of[kind]), "difference": relative(of[kind], of[BRICKS[0]])} for kind in BRICKS}
        for model in (*FLOWS, *LINEAR):
            found[sequence][model] = {kind: against(of[model], of[kind], scale_of(
                fields["planar"], model, kind)) for kind in BRICKS}
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
