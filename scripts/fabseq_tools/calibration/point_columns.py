# SPDX-License-Identifier: MIT
"""Named columns of numbers of measured points, of which some may be no numbers."""

import dataclasses
import re

import numpy as np

from fabseq_tools.run.tables import read_table

NO_NUMBER = re.compile(r"[+-]?(nan(\(.*\))?|inf(inity)?|1\.#\w+)|#?n/?a!?|null|none|nil|-+|\*+|\?+|", re.IGNORECASE)


@dataclasses.dataclass
class PointColumns:
    """`names` of the columns of `values` (point, column), where NaN or inf stands for what is no number;
    `units`: those of columns that name one."""

    path: str
    names: list
    values: np.ndarray
    units: dict = dataclasses.field(default_factory=dict)


def number_of(text):
    """The number in a text, NaN for a word that means none; None for any other text."""
    if NO_NUMBER.fullmatch(text):
        return np.nan
    try:
        return None if "_" in text else float(text)
    except ValueError:
        return None


def read_point_table(path, wanted, unnamed):
    """The columns of a table (CSV, TXT, XYZ, ASC) that `wanted` returns, given the names and the path.
    `unnamed`: names of as many columns without names."""
    table = read_table(path, unnamed)
    names = wanted(table.header, path)
    columns = []
    for name in names:
        numbers = list(map(number_of, cells := table.cells(name)))
        if None in numbers:
            row = numbers.index(None)
            raise table.refusal(name, cells[row], table.places[row], "a number, or nothing where none was measured")
        columns.append(numbers)
    return PointColumns(path, names, np.array(columns, float).reshape(len(names), -1).T, table.units)
