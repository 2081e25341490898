# SPDX-License-Identifier: MIT
"""The page of a plan: what to weld, what it gains over today's way, tilt and pauses, on one screen."""

import base64
import os
from html import escape
from string import Template

from fabseq_tools.paths.export_paths import COMMAND as PATHS
from fabseq_tools.plan.chart import chart_of_layers
from fabseq_tools.plan.layers import length
from fabseq_tools.plan.orientation import words_of
from fabseq_tools.plan.quiet import quiet
from fabseq_tools.plan.steps import UNIT
from fabseq_tools.plot import render_part
from fabseq_tools.report import report
from fabseq_tools.run.command_line import RunError, write_json
from fabseq_tools.run.verdict_words import LOOKS
from fabseq_tools.run.words import duration, number, quantity, whole
from fabseq_tools.study.comparison import UNKNOWN

TEMPLATE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "page.html")
PIXELS = "600"
BEGINS = {"buildable": "Weld this", "buildable_but_for_places": "Weld this, but for what stands below",
          "not_buildable": "Not to be welded as it is"}  # by class
MOST_PLACES = 4


def write_page(steps, placed, chosen, built, drawing, paths):
    """Writes plan.html and plan.json. Returns the last line of the command."""
    rows = rows_of(built, drawing, paths, chosen["optimized"])
    best = rows[-1]
    answer = f"{BEGINS.get(best['class'], 'Not judged')}: {best['layers']}"
    record = {"answer": answer, "part": steps.arguments.part, "machine": steps.arguments.machine, "unit": UNIT, "rows": rows,
              "optimizing_pays": chosen["pays"], "why": chosen["why"], "rotate": placed["rotate"],
              "closed_holes": placed["closed"], "open_holes": placed["holes"], "layers": paths.get("layers", []),
              "steps": {name: found["line"] for name, found in steps.found.items()}, "seconds": steps.seconds()}
    write_json(steps.path("plan.json"), record)
    write_report(steps, built)
    lines = [f"<h1>{escape(steps.arguments.name)} on {escape(steps.machine['tool'].get('name', steps.arguments.machine))}</h1>",
             answer_of(answer, best, chosen, placed), table_of(rows), note_of(steps, placed)]
    pictures = picture_of(steps, built) + (f"<div>{chart_of_layers(paths['layers'])}</div>" if paths.get("layers") else "")
    lines += [f'<div class="two">{pictures}</div>', places_of(best), files_of(steps, built, drawing, paths)]
    with open(TEMPLATE, encoding="utf-8") as file:
        text = Template(file.read()).substitute(title=escape(f"{steps.arguments.name}: plan"), body="\n".join(lines))
    with open(steps.path("plan.html"), "w", encoding="utf-8") as file:
        file.write(text)
    return (f"{steps.path('plan.html')}: {answer}: {quantity(best['rms'], UNIT)}, {best['verdict']}; in "
            f"{duration(record['seconds'])}")


def rows_of(built, drawing, paths, is_optimized):
    """Today's way, the best alternative, what is built, that from the moved drawing: the last is welded."""
    starts, name = paths["starts"], "optimized" if is_optimized else "without optimizing"
    found = [("today", built["planar"], starts.get("planar")), ("best alternative", built["other"], starts.get("other"))]
    moved, refused = drawing.get("row"), drawing.get("refused")
    found.append(("not welded: drawing compensated", refused, None))
    if built["built"]["folder"] != built["planar"]["folder"] or not moved:
        found.append((name, built["built"], starts.get("built") or starts.get("welded")))
    found.append((f"{name}, drawing compensated", moved, starts.get("welded")))
    return [figures_of(title, row, count) for title, row, count in found if row and "reason" not in row]


def figures_of(title, row, starts):
    """A row of the table and of plan.json."""
    return {"title": title, "layers": row["layers"], "class": row["class"], "verdict": row["verdict"], "rms": length(row),
            "largest": row.get("largest"), "spread": row["spread"], "hours": row["hours"], "kg": row["mass"], "starts": starts,
            "places": row["places"]}


def answer_of(answer, best, chosen, placed):
    first = f"Turn the drawing by {words_of(placed['rotate'])}. " if any(placed["rotate"]) else ""
    return (f'<section class="answer {LOOKS.get(best["class"], "unknown")}"><b>{escape(answer)}</b>'
            f"<p>{escape(whole(best['verdict'] or 'not judged'))} {escape(first + whole(chosen['why']))}</p></section>")


def table_of(rows):
    head = "".join(f"<th>{words}</th>" for words in (
        "", f"rms, {UNIT}", f"largest, {UNIT}", f"spread, {UNIT}", "hours", "kg", "starts", "verdict"))
    lines = []
    for row in rows:
        cells = [row["rms"], row["largest"], row["spread"], row["hours"], row["kg"]]
        texts = ["–" if value is None else number(value) for value in cells] + [f"{row['starts']:,}" if row["starts"] else "–"]
        first = f"{escape(row['title'])}<br><span class=\"note\">{escape(row['layers'])}</span>"
        begin = '<tr class="ours">' if row is rows[-1] else "<tr>"
        verdict = f'<td class="{LOOKS.get(row["class"], "")}">{escape(row["verdict"] or "not judged")}</td>'
        lines.append(f"{begin}<td>{first}</td>{''.join(f'<td>{text}</td>' for text in texts)}{verdict}</tr>")
    return f"<table><thead><tr>{head}</tr></thead><tbody>{''.join(lines)}</tbody></table>"


def note_of(steps, placed):
    heat, film = steps.arguments.heat_input, steps.arguments.film
    words = ("rms, largest: of the skin's deviation from the drawing after the best fit, released from the plate if it can be; "
             "by the linear model with the material's inherent strain, which is to be calibrated. spread: how much "
             f"{UNKNOWN:.0%} more and less of that strain along each axis changes the rms. hours: welding, and the pauses that "
             f"the interpass limit needs with an assumed heat of {heat:g} J/kg and {film:g} W/(mm² K).")
    if placed["closed"]:
        words += f" Holes that are closed and drilled afterwards: {len(placed['closed'])}."
    return f'<p class="note">{escape(words)}</p>'


def picture_of(steps, built):
    """The layers of what is built, as an image; nothing where it cannot be drawn."""
    path = steps.path("layers.png")
    result = os.path.join(built["built"]["judged"], "result.h5")
    try:
        quiet(render_part.main, [result, path, "--colour", "layer", "--pixels", PIXELS], steps.path("picture.log"))
        with open(path, "rb") as file:
            data = base64.b64encode(file.read()).decode()
    except (RunError, OSError):
        return ""
    return f'<div><img alt="the layers" src="data:image/png;base64,{data}"></div>'


def places_of(best):
    """What fails where; the report has all of it."""
    if not best["places"]:
        return ""
    shown, left = best["places"][:MOST_PLACES], len(best["places"]) - MOST_PLACES
    shown += ["and more: report.html lists them"] * (left > 0)
    return "<p><b>Where it fails</b></p><ul>" + "".join(f"<li>{escape(words)}</li>" for words in shown) + "</ul>"


def write_report(steps, built):
    quiet(report.main, [built["built"]["run"], "-o", steps.path("report.html")], steps.path("report.log"))


def files_of(steps, built, drawing, paths):
    """What stands in the folder, and what comes next."""
    found = {"report.html": "all about the build: places, layers in 3D, constraints, curves",
             os.path.basename(built["config"]): "its config, with a reason for every choice"}
    if drawing.get("stl"):
        found["compensated.stl"] = "the drawing, moved against the distortion"
    if paths.get("layers"):
        programs = ", ".join(steps.arguments.post) or f"none: fabseq-tools {PATHS} --post"
        found["paths/"] = f"waypoints and pauses of each layer; programs for the machine: {programs}"
    entries = "".join(f"<dt>{escape(name)}</dt><dd>{escape(words)}</dd>" for name, words in found.items())
    lines = "".join(f"<dt>{escape(name)}</dt><dd>{escape(step['line'])}</dd>" for name, step in steps.found.items())
    return f"<dl>{entries}</dl><details><summary>What each step found</summary><dl>{lines}</dl></details>"
