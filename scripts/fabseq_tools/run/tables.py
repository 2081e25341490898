# SPDX-License-Identifier: MIT
"""Tables of numbers (CSV) with named columns."""

import csv

import numpy as np

from fabseq_tools.run.command_line import RunError


def read_table(path):
    """The names of the columns of a table (CSV), and its rows as texts."""
    with open(path, encoding="utf-8-sig", newline="") as file:
        lines = csv.reader(line for line in file if line.strip() and not line.startswith("#"))
        header, *rows = [[cell.strip() for cell in line] for line in lines] or [[]]
    if not rows:
        raise RunError(f"{path}: holds no points")
    return header, rows


def numbers(path, header, rows, columns):
    """Columns of a table as an array (row, column)."""
    missing = [name for name in columns if name not in header]
    if missing:
        raise RunError(f"{path}: the first line names no column {', '.join(missing)}; needed: {', '.join(columns)}")

    def number(point, name, cell):
        try:
            value = float(cell or (np.nan if name[0] == "u" else ""))
        except ValueError as error:
            raise RunError(f"{path}, point {point}, column {name}: '{cell}' is no number") from error
        if cell and not np.isfinite(value):
            raise RunError(f"{path}, point {point}, column {name}: '{cell}' is not finite")
        return value

    return np.array([[number(point, name, dict(zip(header, row)).get(name, "")) for name in columns]
                     for point, row in enumerate(rows, start=1)])
