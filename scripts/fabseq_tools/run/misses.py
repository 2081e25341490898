# SPDX-License-Identifier: MIT
"""By how much the iterates of a run miss their constraints, in figures that people can read."""

import numpy as np


def worst_misses(run):
    """worst_miss() of each line of the history; NaN where it is not known."""
    misses = (worst_miss(run, line) for line in run.history)
    return np.array([np.nan if worst is None else worst for worst in misses])


def worst_miss(run, values):
    """The largest miss of a constraint in a line of the history, or in its `binary`, below 0 where all
    hold: of a count the share of the part beyond its limit, of others relative to what is allowed. The
    bounds are those that summary.json has (docs/reference.md). The program's own figure mixes these with
    logarithms of counts; it stays where there are no constraints."""
    constraints = run.summary.get("constraints")
    if not constraints:
        return values["worst_constraint"]
    return max(miss(*pair) for pair in zip(constraints, values["constraints"]))


def miss(constraint, values):
    """Of one constraint. A value that is not known misses nothing."""
    values = np.array([np.nan if value is None else value for value in values], dtype=float)
    return max(np.nanmax(bound["sign"] * (values - bound["bound"]) / bound["scale"]) for bound in constraint["bounds"])
