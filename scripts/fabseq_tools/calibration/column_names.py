# SPDX-License-Identifier: MIT
"""What the columns of a table of measured points are, by the names that programs of measurement and of finite
elements give them."""

import re

from fabseq_tools.geometry.placement import MILLIMETRES
from fabseq_tools.run.command_line import RunError

AXES = "xyz"
AXIS = "(?P<axis>[xyz])"
AXIS_OR_NUMBER = "(?P<axis>[xyz0-3])"
NOMINAL = "(nominal|nom|reference|ref|design|cad|target|original|initial|theoretical|theo|soll)"
ACTUAL = "(actual|act|measured|meas|scanned|scan|real|ist)"
POINT = "(points?|positions?|pos|coordinates?|coords?|coor|location)"
CHANGE = ("(displacements?|displ|disp|deviations?|dev|deformations?|deform|delta|differences?|diff|errors?|err|offset|shift|"
          "movement)")
ROLES = (("point", [AXIS, f"({POINT} )?{POINT} ?{AXIS_OR_NUMBER}", f"{AXIS} ?{POINT}"]),
         ("nominal", [f"{NOMINAL} ?{AXIS}", f"{AXIS} ?{NOMINAL}", f"{AXIS} ?0"]),
         ("actual", [f"{ACTUAL} ?{AXIS}", f"{AXIS} ?{ACTUAL}"]),
         ("displacement", [f"[ud] ?{AXIS}", "(u )?u ?(?P<axis>[0-3])", f"{CHANGE} ?{AXIS_OR_NUMBER}", f"{AXIS} ?{CHANGE}"]))
ALLOWED = "displacements named ux or dx, U1, disp_x, dev x, or x_nominal beside x_actual; for a scan x, y, z only"
LIKE_A_CHANGE = re.compile(r"disp|dev|delta|deform|diff|error|shift|offset")
UNITS_IN_NAMES = {name for name in MILLIMETRES if len(name) > 1 and name != "in"}


def words_of(name):
    """A name in small letters, its words apart by one blank, without the Greek delta."""
    name = re.sub("[\u0394\u2206\u03b4]", "d", name.lower())
    return re.sub(r"[\s_\-.:/]+", " ", name).strip()


def role_of(name):
    """The role and the axis (or number) of a column, and the unit in its name; three times None for any
    other."""
    words, _, unit = words_of(name).rpartition(" ")
    words, unit = (words, unit) if words and unit in UNITS_IN_NAMES else (words_of(name), None)
    for role, patterns in ROLES:
        for pattern in patterns:
            found = re.fullmatch(pattern, words)
            if found:
                return role, found["axis"], unit
    return None, None, None


class Roles:
    """Which columns of a table are what. `points`: names of the columns of positions; `displacements`: those
    of displacements, or None; `actual`: those of the measured positions, of which the displacement is to be
    taken, or None. `points` are None where they are to be taken from the two others. `units`: those in the
    names. `unused`: columns that nothing is known of."""

    def __init__(self, path, header, dimension):
        self.path, self.axes, self.units, self.unused = path, AXES[:dimension], {}, []
        found = {role: {} for role, _ in ROLES}
        for name in header:
            role, axis, unit = role_of(name)
            if role is None:
                self.unused.append(name)
                continue
            if unit:
                self.units[name] = unit
            found[role].setdefault(axis, []).append(name)
        self.choose(*(self.complete(role, found[role]) for role, _ in ROLES))

    def complete(self, role, by_axis):
        """The names of a role along all axes, or None where it is not in the table."""
        if any(axis.isdigit() for axis in by_axis):
            first = 0 if "0" in by_axis else 1
            for axis in [axis for axis in by_axis if axis.isdigit()]:
                names = by_axis.pop(axis)
                if 0 <= int(axis) - first < 3:
                    by_axis.setdefault(AXES[int(axis) - first], []).extend(names)
        names = [by_axis.get(axis, []) for axis in self.axes]
        if not any(names):
            return None
        for axis, of_axis in zip(self.axes, names):
            if len(of_axis) > 1:
                raise RunError(f"{self.path}: the first line names {len(of_axis)} columns of {words_for(role, axis)}: "
                               f"{', '.join(of_axis)}; allowed: one")
        if not all(names):
            missing = [words_for(role, axis) for axis, of_axis in zip(self.axes, names) if not of_axis]
            there = ", ".join(its[0] for its in names if its)
            raise RunError(f"{self.path}: the first line names no column of {', '.join(missing)}; found: {there}; needed: "
                           "all axes")
        return [its[0] for its in names]

    def choose(self, points, nominal, actual, displacements):
        if nominal and points and actual is None:  # x_nominal beside x
            points, actual = None, points
        self.points, self.displacements, self.actual = nominal or points, displacements, actual
        if self.displacements or (self.points and self.actual):
            if not (self.points or self.actual):
                raise RunError(f"{self.path}: the first line names displacements and no column x, y, z; needed: the points, too")
            if self.points and self.actual:
                self.displacements = None  # follows from both positions
            return
        self.points, self.actual = self.points or self.actual, None
        if self.points is None:
            raise RunError(f"{self.path}: the first line names no column {', '.join(self.axes)}; found: {self.list_of_unused()}; "
                           f"allowed: {ALLOWED}")
        if nominal:
            raise RunError(f"{self.path}: found nominal positions only ({', '.join(nominal)}), which say nothing of the part; "
                           f"allowed: {ALLOWED}")
        unclear = [name for name in self.unused if LIKE_A_CHANGE.search(words_of(name))]
        if unclear:
            raise RunError(f"{self.path}: found the column '{unclear[0][:40]}', which may be a displacement, but along no axis; "
                           f"allowed: {ALLOWED}")

    def list_of_unused(self):
        there = ", ".join(self.unused)
        return there[:100] + "..." * (len(there) > 100)

    def all(self):
        return [name for names in (self.points, self.actual, self.displacements) for name in names or []]


def words_for(role, axis):
    return {"point": axis, "nominal": f"{axis}_nominal", "actual": f"{axis}_actual",
            "displacement": f"displacements along {axis} (u{axis})"}[role]
