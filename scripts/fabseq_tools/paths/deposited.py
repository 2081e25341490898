# SPDX-License-Identifier: MIT
"""Which waypoints of a table nothing is deposited at: those of travels, or with the arc off."""

import collections
import re

import numpy as np

from fabseq_tools.run.command_line import RunError
from fabseq_tools.run.tables import is_number

KINDS = """kind type move move_type motion motion_type path_type path_kind segment_type segment command cmd mode
action operation code""".split()  # columns of words; numbers in them are codes that nobody knows
SWITCHES = """state status process arc arc_on arc_state weld weld_on welding on off extruder extruder_on
extruder_toggle extrude extruding extrusion deposit depositing deposition laser laser_on wire wire_on process_on
torch torch_on print printing toggle""".split()  # an empty cell is off
AMOUNTS = "g e wire_feed wire_feed_speed wire_speed wfs current power feed velocity voltage".split()  # off unless above 0
TRAVELS = "travel is_travel travel_move rapid is_rapid jump air air_move lift retract skip no_weld".split()  # off where true
ALONE = "no not non none false f n nil".split()  # mean off as a whole cell; within one, they may mean anything
TRUE = "yes true t y x on".split()
OFF = re.compile(r"(?:^|[^a-z])(?:(?:arc|weld|torch|laser|wire|extruder)?[ _]*off|travel\w*|rapid\w*|air\w*|jump\w*|"
                 r"approach\w*|retract\w*|depart\w*|g0+|ptp|move_?j|moveabsj|transit\w*|transfer\w*|reposition\w*|"
                 r"positioning|safe\w*|lift\w*|hop|idle|inactive|disabled|home|park\w*|unwelded|un\w*deposit\w*|wait|leer\w*|"
                 r"eilgang|anfahr\w*|abfahr\w*|(?:no|non)[ _-]*(?:weld|print|deposit|extru|arc)\w*)(?:[^a-z0-9]|$)")


def deposited(table):
    """Which rows are, and lines of text on the others."""
    kept, words = np.ones(len(table.rows), bool), []
    for name in table.header:
        kind = re.sub(r"[\s-]+", "_", name.strip())
        if kind not in [*KINDS, *SWITCHES, *AMOUNTS, *TRAVELS] or table.header.count(name) > 1:
            continue
        cells = table.cells(name)
        if kind in KINDS and all(is_number(cell) for cell in cells if cell.strip()):
            words.append(f"column {name}: numbers, of which it is not known what they mean: no waypoint is left out for them")
            continue
        off = off_in(kind, cells)
        if not off.any():
            continue
        values = ", ".join(f"{value or 'empty'} ({count})" for value, count in collections.Counter(
            cell for cell, without in zip(cells, off) if without).most_common(5))
        if off.all():
            raise RunError(f"{table.path}: column {name}: found {values} in all rows, where nothing is deposited; allowed: rows "
                           "with the arc on, such as weld or 1")
        words.append(f"column {name}: nothing is deposited at {off.sum()} of {len(off)} waypoints, which are left out: {values}")
        kept &= ~off
    if not kept.any():
        raise RunError(f"{table.path}: the columns leave no waypoint at which something is deposited ({'; '.join(words)})")
    return kept, words


def off_in(kind, cells):
    """At which of the cells of a column of that kind nothing is deposited."""
    if kind in TRAVELS:
        return np.array([is_true(cell) for cell in cells])
    off = np.array([is_off(cell) for cell in cells]) != (kind == "off")
    empty = np.array([not cell.strip() for cell in cells])
    return off | empty if kind in SWITCHES and not empty.all() else off


def is_true(cell):
    cell = cell.strip().lower()
    try:
        return float(cell) > 0
    except ValueError:
        return cell in TRUE or bool(OFF.search(cell))


def is_off(cell):
    """A number is off unless it is above 0; a word if it is one of those above. An empty cell is not."""
    cell = cell.strip().lower()
    try:
        return not float(cell) > 0
    except ValueError:
        return cell in ALONE or bool(OFF.search(cell))
