# SPDX-License-Identifier: MIT
"""Curve and table that `fabseq-tools tradeoff` left in a run's folder or in the one above it."""

import os

from fabseq_tools.report.charts import chart
from fabseq_tools.report.tables import cell, table
from fabseq_tools.run.read_run import read_json
from fabseq_tools.study.figures import columns_of, headings
from fabseq_tools.study.tradeoff import LIMITS, name_of

CURVES = {"skin": ("skin as built", "optimized"), "skin_released": ("skin after the release", "binary")}


def find_tradeoffs(directory):
    """Records of tradeoff_*.json, the folder's own first."""
    places = directory, os.path.join(os.path.abspath(directory), os.pardir)
    found = []
    for over in LIMITS:
        folder = next((place for place in places if os.path.exists(os.path.join(place, f"{name_of(over)}.json"))), None)
        if folder:
            found.append(read_json(folder, f"{name_of(over)}.json"))
    return found


def tradeoff_charts(run):
    """A chart for each trade-off, over the limits."""
    return [chart(f"Deviation of the skin over {record['label']}",
                  [{"label": words, "role": role, "points": [(row["place"], row.get(key)) for row in record["rows"]]}
                   for key, (words, role) in CURVES.items()],
                  "largest over least thickness" if record["over"] == "thickness" else record["label"], dotted=True,
                  note="binary layers, root mean square") for record in run.tradeoffs]


def tradeoff_tables(run):
    """A table for each trade-off, with the reasons where the checks are not satisfied; empty without any."""
    return "".join(tradeoff_table(record, columns_of(record["rows"])) for record in run.tradeoffs)


def tradeoff_table(record, columns):
    return table([record["label"], *headings(columns), "why not"],
                 [(row["limit"], cells(row, columns)) for row in record["rows"]], id=name_of(record["over"]))


def cells(row, columns):
    """Of one limit. A run that has not come to an end has its reason alone."""
    shown = [row.get(key) if isinstance(row.get(key), (int, float)) and key in ("objective", "skin", "skin_released")
             else None if row.get(key) is None else show(row[key]) for key, (_, show) in columns.items()]
    return [*map(cell, shown), cell("; ".join([row["reason"]] if "reason" in row else row["violated"]) or None)]
