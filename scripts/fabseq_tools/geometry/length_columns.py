# SPDX-License-Identifier: MIT
"""Lengths in a table whose columns may name their units."""

import math

from fabseq_tools.geometry.placement import MILLIMETRES, millimetres_of
from fabseq_tools.run.command_line import RunError

NEARLY = 0.2  # of its logarithm: how far a drawing that was scaled by some per cent is from its own unit


def usual_unit(millimetres):
    """The unit that a drawing was made in, in millimetres, if a scale for shrinkage stands in its length."""
    if millimetres is None:
        return None
    near = min(MILLIMETRES.values(), key=lambda length: abs(math.log(length / millimetres)))
    return near if abs(math.log(near / millimetres)) < NEARLY else millimetres


def lengths(table, columns, millimetres, may_be_empty=()):
    """Columns as an array (row, column), in the unit that is so many millimetres (None: its name is not
    known); those that name a unit of their own are converted."""
    values = table.numbers(columns, may_be_empty)
    for index, name in enumerate(columns):
        unit = table.units.get(name)
        if unit is None:
            continue
        own = millimetres_of(unit)
        if own is None:
            raise RunError(f"{table.path}: column {name}: found the unit '{unit}'; allowed: {', '.join(MILLIMETRES)}")
        if millimetres is None:
            raise RunError(f"{table.path}: column {name}: found the unit '{unit}'; allowed: none, as the config's is not known")
        values[:, index] *= own / millimetres
    return values
