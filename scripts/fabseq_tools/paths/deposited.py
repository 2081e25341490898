# SPDX-License-Identifier: MIT
"""Which waypoints of a table nothing is deposited at: those of travels, or with the arc off."""

import collections
import re

import numpy as np

from fabseq_tools.run.command_line import RunError

COLUMNS = """kind type move move_type motion path_type path_kind segment_type command cmd code g mode state status action
operation arc arc_on arc_state weld weld_on welding on off extruder extruder_on extruder_toggle extrude extruding extrusion
deposit depositing deposition laser laser_on wire wire_on wire_feed wfs process process_on torch torch_on print printing toggle
current power feed velocity""".split()
ALONE = "no not non none false f n nil".split()  # mean off as a whole cell; within one, they may mean anything
OFF = re.compile(r"(?:^|[^a-z])(?:(?:arc|weld|torch|laser|wire|extruder)?[ _]*off|travel\w*|rapid\w*|air\w*|jump\w*|approach\w*|"
                 r"retract\w*|depart\w*|g0+|ptp|transit\w*|transfer\w*|reposition\w*|positioning|safe\w*|lift\w*|hop|idle|"
                 r"inactive|disabled|home|park\w*|unwelded|un\w*deposit\w*|wait)(?:[^a-z0-9]|$)")


def deposited(table):
    """Which rows are, and lines of text on the others."""
    kept, words = np.ones(len(table.rows), bool), []
    for name in table.header:
        if re.sub(r"[\s-]+", "_", name.strip()) not in COLUMNS or table.header.count(name) > 1:
            continue
        cells = table.cells(name)
        off = np.array([is_off(cell) for cell in cells]) != (name == "off")
        if not off.any():
            continue
        values = ", ".join(f"{value} ({count})" for value, count in collections.Counter(
            cell for cell, without in zip(cells, off) if without).most_common(5))
        if off.all():
            raise RunError(f"{table.path}: column {name}: found {values} in all rows, where nothing is deposited; allowed: rows "
                           "with the arc on, such as weld or 1")
        words.append(f"column {name}: nothing is deposited at {off.sum()} of {len(off)} waypoints, which are left out: {values}")
        kept &= ~off
    if not kept.any():
        raise RunError(f"{table.path}: the columns leave no waypoint at which something is deposited ({'; '.join(words)})")
    return kept, words


def is_off(cell):
    """A number is off unless it is above 0; a word if it is one of those above. An empty cell is not."""
    cell = cell.strip().lower()
    try:
        return not float(cell) > 0
    except ValueError:
        return cell in ALONE or bool(OFF.search(cell))
