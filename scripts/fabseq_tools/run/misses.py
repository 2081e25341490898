# SPDX-License-Identifier: MIT
"""By how much the iterates of a run miss their constraints, in figures that people can read."""

import numpy as np


def worst_misses(run):
    """The largest miss of a constraint in each line of the history, below 0 where all hold: of a count the
    share of the part beyond its limit, of others relative to what is allowed. The bounds are those that
    summary.json has (docs/reference.md). The program's own figure mixes these with logarithms of counts; it
    stays where there are no constraints, or where an older program has not written their bounds."""
    constraints = run.summary.get("constraints")
    if not constraints:
        return np.array([np.nan if line["worst_constraint"] is None else line["worst_constraint"] for line in run.history])
    return np.array([max(miss(*pair) for pair in zip(constraints, line["constraints"])) for line in run.history])


def miss(constraint, values):
    """Of one constraint. A value that is not known misses nothing."""
    values = np.array([np.nan if value is None else value for value in values], dtype=float)
    return max(np.nanmax(bound["sign"] * (values - bound["bound"]) / bound["scale"]) for bound in constraint["bounds"])
