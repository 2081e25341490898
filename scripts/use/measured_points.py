# SPDX-License-Identifier: MIT
"""Points that were measured on a part: from a table (CSV), with or without displacements, or a cloud of
points (PLY)."""

import csv

from command_line import RunError  # before any package

import numpy as np

from nearest_surface import READERS, read_poly_data
from vtk_data import points_of

AXES = "xyz"
MOST_NAMED = 20  # points in one message


def read_measurement(path, dimension):
    """Positions (n, axis) and displacements (n, axis), NaN where nothing was measured; None in place of them
    for a scan, which has positions only."""
    if path.lower().endswith(".ply"):
        data = read_poly_data(READERS[".ply"], path)
        if data.GetNumberOfPoints() == 0:
            raise RunError(f"{path}: holds no points")
        return points_of(data)[:, :dimension], None
    header, rows = read_table(path)
    measured = ["u" + axis for axis in AXES[:dimension]]
    is_scan = not any(name in header for name in measured)
    columns = [*AXES[:dimension], *([] if is_scan else measured)]
    values = numbers(path, header, rows, columns)
    return values[:, :dimension], None if is_scan else values[:, dimension:]


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


def refuse_far_points(points, distances, tolerance, place):
    """Raises a RunError that names all points farther than the tolerance from `place`."""
    far = np.flatnonzero(distances > tolerance)
    if len(far) == 0:
        return
    named = [f"point {i + 1} at [{','.join(f'{x:g}' for x in points[i])}], {distances[i]:.4g} away"
             for i in far[:MOST_NAMED]]
    if len(far) > MOST_NAMED:
        named.append(f"and {len(far) - MOST_NAMED} more, up to {distances[far].max():.4g} away")
    raise RunError(f"{len(far)} of {len(points)} points lie farther than {tolerance:g} from {place} (--tolerance): "
                   + "; ".join(named))
