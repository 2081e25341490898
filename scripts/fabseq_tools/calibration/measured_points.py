# SPDX-License-Identifier: MIT
"""Points that were measured on a part, with or without displacements: from a table, a cloud of points or a
mesh."""

import os

import numpy as np

from fabseq_tools.calibration.column_names import AXES, Roles
from fabseq_tools.calibration.point_columns import read_point_table
from fabseq_tools.calibration.point_files import read_obj, read_ply, read_stl
from fabseq_tools.geometry.placement import MILLIMETRES, millimetres_of
from fabseq_tools.run.command_line import RunError

FILES = {".ply": read_ply, ".obj": read_obj, ".stl": read_stl}
MOST_NAMED = 20  # points in one message
SUCH = "numbers such as -9999"
NO_VALUES = (999.0, 9999.0, 99999.0, 999999.0, 9999999.0, 32767.0, 32768.0)
BEYOND_ALL, FAR_BEYOND = 1e9, 20.0  # whatever the unit; times the median of the others
TINY = 1e-12     # of the largest coordinate: what rounding leaves of 0


class Measurement:
    """`points` (n, axis); `displacements` (n, axis), NaN where nothing was measured, or None of a scan;
    `numbers` (n): of the points in the file, from 1. `has_units`: whether the file, or the user, names the
    unit of the points. `remarks`: what was left out or not used, in words."""

    def __init__(self, path, points, displacements, has_units=False):
        self.path, self.points, self.displacements, self.has_units = path, points, displacements, has_units
        self.numbers, self.remarks = np.arange(1, len(points) + 1), []

    def keep(self, keep, words):
        """Leaves out the other points; `words` say why."""
        left_out = np.count_nonzero(~keep)
        if left_out == 0:
            return
        if not keep.any():
            raise RunError(f"{self.path}: none of its {len(keep)} points can be used: {words}")
        self.remarks.append(f"{self.path}: {left_out} of {len(keep)} points left out: {words}")
        self.points, self.numbers = self.points[keep], self.numbers[keep]
        if self.displacements is not None:
            self.displacements = self.displacements[keep]

    def leave_out(self):
        """Leaves out what is no measurement of its own."""
        self.keep(np.isfinite(self.points).all(1), "their positions are no numbers")
        self.keep(~stand_for_nothing(self.points).any(1), f"their positions are {SUCH}, as of points that were not found")
        if self.displacements is not None:
            missing = stand_for_nothing(self.displacements)
            self.displacements = np.where(missing, np.nan, self.displacements)
            self.keep(~missing.any(1) | np.isfinite(self.displacements).any(1),
                      f"their displacements are {SUCH}, as where nothing was measured")
            self.displacements = np.where(np.isfinite(self.displacements), self.displacements, np.nan)
            self.keep(np.isfinite(self.displacements).any(1), "their displacements are no numbers")
        rows = self.points if self.displacements is None else np.hstack([self.points, np.nan_to_num(self.displacements)])
        zeros = (np.abs(rows) <= TINY * np.abs(rows).max()).all(1)
        if np.count_nonzero(zeros) > 1:
            self.keep(~zeros, "all of their numbers are 0, as of points that were not found")
        rows = self.points if self.displacements is None else np.hstack([self.points, self.displacements])
        rows = np.ascontiguousarray(np.where(np.isnan(rows), np.nan, rows + 0.0))  # one 0 and one NaN
        first = np.zeros(len(rows), bool)
        first[np.unique(rows.view(f"V{rows.itemsize * rows.shape[1]}").ravel(), return_index=True)[1]] = True
        self.keep(first, "equal to others, which count once")


def stand_for_nothing(values):
    """Which of the values are far beyond the others and such as programs write where they have none: nines,
    the ends of 16 bits, or beyond a billion."""
    size = np.abs(values)
    written = np.isfinite(size) & (size >= BEYOND_ALL) | np.isin(size, NO_VALUES)
    return written & (size > FAR_BEYOND * usual_size(size))


def usual_size(size):
    """Median of those that may be measured."""
    measured = size[(size > 0) & (size < BEYOND_ALL) & ~np.isin(size, NO_VALUES)]
    return np.median(measured) if measured.size else 0.0


def read_measurement(path, dimension, unit, own_unit=None):
    """The Measurement in a file. `unit`: the config's, to which lengths of another one are converted;
    `own_unit`: that of lengths whose unit the file does not name, by default the config's."""
    reader = FILES.get(os.path.splitext(path)[1].lower())
    if reader:
        with open(path, "rb") as file:
            columns = reader(path, file.read())
    else:
        columns = read_point_table(path, lambda header, of: Roles(of, header, dimension).all(), AXES)
    return measurement_of(columns, dimension, unit, own_unit)


def measurement_of(columns, dimension, unit, own_unit=None):
    """The Measurement that columns hold, as of read_measurement()."""
    path, roles = columns.path, Roles(columns.path, columns.names, dimension)
    of_config, units = millimetres_of(unit), roles.units | columns.units

    def positions(names):
        return None if names is None else np.stack(
            [columns.values[:, columns.names.index(name)] * factor_of(path, name, units, own_unit, of_config)
             for name in names], axis=1)

    points, actual, displacements = map(positions, (roles.points, roles.actual, roles.displacements))
    if len(columns.values) == 0:
        raise RunError(f"{path}: holds no points")
    with np.errstate(invalid="ignore"):  # inf - inf
        if points is None:
            points = actual - displacements
        elif actual is not None:
            displacements = actual - points
    has_units = own_unit is not None or all(name in units for name in roles.points or roles.actual)
    result = Measurement(path, points, displacements, has_units)
    result.leave_out()
    return result


def factor_of(path, name, units, own_unit, of_config):
    """From the unit of a column to the config's, which is so many millimetres."""
    unit = units.get(name, own_unit)
    if unit is None:
        return 1.0
    place = f"{path}: column {name}" if name in units else "--unit"
    own = millimetres_of(unit)
    if own is None:
        raise RunError(f"{place}: found the unit '{unit}'; allowed: {', '.join(MILLIMETRES)}")
    if of_config is None:
        raise RunError(f"{place}: found the unit '{unit}'; allowed: none, as the config's is not known")
    return own / of_config


def refuse_far_points(measurement, distances, tolerance, place):
    """Raises a RunError that names all points farther than the tolerance from `place`."""
    points, numbers = measurement.points, measurement.numbers
    far = np.flatnonzero(~(distances <= tolerance))
    if len(far) == 0:
        return
    named = [f"point {numbers[i]} at [{','.join(f'{x:g}' for x in points[i])}], {distances[i]:.4g} away"
             for i in far[:MOST_NAMED]]
    if len(far) > MOST_NAMED:
        named.append(f"and {len(far) - MOST_NAMED} more, up to {distances[far].max():.4g} away")
    raise RunError(f"{len(far)} of {len(points)} points lie farther than {tolerance:g} from {place} (--tolerance): "
                   + "; ".join(named))
