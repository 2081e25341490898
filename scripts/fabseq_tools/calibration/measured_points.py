# SPDX-License-Identifier: MIT
"""Points that were measured on a part: from a table (CSV), with or without displacements, or a cloud of
points (PLY)."""

import numpy as np

from fabseq_tools.geometry.length_columns import lengths
from fabseq_tools.geometry.nearest_surface import READERS, read_poly_data
from fabseq_tools.geometry.placement import millimetres_of
from fabseq_tools.geometry.vtk_data import points_of
from fabseq_tools.run.command_line import RunError
from fabseq_tools.run.tables import read_table

AXES = "xyz"
MOST_NAMED = 20  # points in one message


def read_measurement(path, dimension, unit):
    """Positions (n, axis) and displacements (n, axis), NaN where nothing was measured; None in place of them
    for a scan, which has positions only. `unit`: the config's, to which columns of another one are
    converted."""
    if path.lower().endswith(".ply"):
        data = read_poly_data(READERS[".ply"], path)
        if data.GetNumberOfPoints() == 0:
            raise RunError(f"{path}: holds no points")
        return points_of(data)[:, :dimension], None
    table = read_table(path)
    measured = ["u" + axis for axis in AXES[:dimension]]
    is_scan = not any(name in table.header for name in measured)
    columns = [*AXES[:dimension], *([] if is_scan else measured)]
    values = lengths(table, columns, millimetres_of(unit), may_be_empty=measured)
    return values[:, :dimension], None if is_scan else values[:, dimension:]


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
