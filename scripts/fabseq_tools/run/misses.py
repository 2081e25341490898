# SPDX-License-Identifier: MIT
"""By how much the iterates of a run miss their constraints, in figures that people can read."""

import numpy as np

COUNTS = ("tilt", "tool_clearance", "local_thickness", "supported")  # of shares, which the optimizer sees as logarithms


def worst_misses(run):
    """The largest miss of a constraint in each line of the history, below 0 where all hold: of a count the
    share of the part beyond its limit, of others relative to what is allowed. The program's own figure mixes
    these with logarithms of counts. It stays where no count is among the constraints, or one that is unknown
    here."""
    constraints = run.config.get("constraints", [])
    own = np.array([np.nan if line["worst_constraint"] is None else line["worst_constraint"] for line in run.history])
    known = all(constraint["type"] in (*COUNTS, "layer_thickness", "last_layer") for constraint in constraints)
    if not known or not any(constraint["type"] in COUNTS for constraint in constraints):
        return own
    return np.array([max(miss(run, *pair) for pair in zip(constraints, line["constraints"])) for line in run.history])


def miss(run, constraint, values):
    values = np.array([np.nan if value is None else value for value in values], dtype=float)
    if constraint["type"] == "layer_thickness":
        return np.nanmax(np.abs(values - 1)) - constraint.get("tolerance", 0.1)
    if constraint["type"] == "last_layer":
        return np.nanmax(values) - 0.25
    limit = constraint.get("limit", 3e-6 if constraint["type"] == "tool_clearance" else 1e-3)
    return np.nanmax(values) - (0.5 / run.summary["part_elements"] if limit == "auto" else limit)
