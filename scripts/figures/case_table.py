# SPDX-License-Identifier: MIT
"""The table of cases in docs/results.md: a row a case, rewritten one by one (scripts/figures/reproduce.py)."""

import fcntl
import math
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "use"))

from read_run import Run, RunError, read_json

BEGIN, END = "<!-- cases -->", "<!-- end of cases -->"
HEAD = ("| case | what, source | published: planar → optimized | planar | smooth | binary | worst constraint | thickness / target, last layer apart; or print angles | "
        "minima | run | picture |")
RULE = "| --- " * (HEAD.count("|") - 1) + "|"


def rewrite(path, order, name, row):
    """Puts a case's row into the document, in place of the one that is there; `order`: names of all cases. Several programs
    may do so at a time."""
    with open(path, "r+", encoding="utf-8") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        text = with_row(path, file.read(), order, name, row)
        file.seek(0)
        file.write(text)
        file.truncate()


def with_row(path, text, order, name, row):
    if text.count(BEGIN) != 1 or text.count(END) != 1:
        raise RunError(f"{path}: needs one line '{BEGIN}' and one '{END}', with the table between them")
    before, rest = text.split(BEGIN)
    table, after = rest.split(END)
    rows = {name_of(line): line for line in table.splitlines() if line.startswith("| `")}
    rows[name] = row
    known = {key: number for number, key in enumerate(order)}
    lines = sorted(rows.items(), key=lambda item: known.get(item[0], len(known)))
    table = "\n".join([HEAD, RULE, *(line for _, line in lines)])
    return f"{before}{BEGIN}\n{table}\n{END}{after}"


def name_of(row):
    return row.split("`")[1]


def row(name, case, directory, thickness, resliced, picture):
    """A line of the table, from the output directory of a run."""
    words = simulated(directory) if case.get("task") == "simulate" else optimized(case, directory, thickness, resliced)
    image = f"[picture]({picture})" if picture else ""
    note = f"; {case['note']}" if "note" in case else ""
    return "| " + " | ".join([f"`{name}`", f"{case['what']} [{case['source']}]{note}", published(case), *words, image]) + " |"


def published(case):
    figures = case.get("published", {})
    planar, best = figures.get("planar"), figures.get("optimized")
    if not figures:
        return "–"
    text = f"{number(planar)} → {number(best)}" + (f": {factor(planar / best)}" if planar and best else "")
    return text + (f"; cut again {number(figures['resliced'])}" if "resliced" in figures else "")


def simulated(directory):
    summary = read_json(directory, "summary.json")
    values = ", ".join(number(r["value"]) for r in summary["responses"] if r["type"] == "distortion")
    return [values, "–", "–", "–", "–", "–", f"simulated, largest displacement {number(summary['displacement']['max'])}"]


def optimized(case, directory, thickness, resliced):
    run = Run(directory, with_fields=False)
    summary = run.summary
    planar, smooth, binary = (distortion(summary[block]["responses"]) for block in ("baseline", "optimized", "binary"))
    cells = [number(planar), f"{number(smooth)}: {factor(planar / smooth)}", f"{number(binary)}: {factor(planar / binary)}"]
    for count, found in resliced.items():
        values = [distortion(found[kind]["responses"]) for kind in ("planar", "smooth", "binary")]
        for place, value in enumerate(values):
            cells[place] += f"; in {count} layers {number(value)}" + (f": {factor(values[0] / value)}" if place else "")
    ranks = run.config.get("run", {}).get("ranks")
    layers = angles_text(summary["angles"]) if "angles" in summary else thickness_text(run, thickness, resliced)
    return [*cells, violation(run), layers, str(summary["interior_minima"]),
            f"{iterations(summary)}, {duration(summary['seconds']['total'])} on {ranks} rank{'s' * (ranks != 1)}"]


def iterations(summary):
    before = summary.get("coarse_iterations", 0)
    return f"{summary['iterations']} iterations" + (f" after {before} at half the resolution" if before else "")


def distortion(responses):
    """Sum of all distortion terms, as published for two faces or edges."""
    return sum(r["value"] for r in responses if r["type"] == "distortion")


def violation(run):
    worst = run.summary["worst_constraint"]
    if worst is None:
        return "–"
    return "satisfied" if worst <= 0 else f"{100 * worst:.2g} % beyond"


def angles_text(angles):
    """Of every sub-part, in degrees: elevation, and in 3D the azimuth."""
    return ", ".join("/".join(f"{math.degrees(angle):.0f}°" for angle in of_part) for of_part in angles)


def thickness_text(run, geometric, resliced):
    """By the gradient, smooth and binary, and geometric, each relative to the target where there is one."""
    constraint = run.thickness_constraint()
    target = constraint["target"] if constraint else None
    texts = [f"{kind} {span(run.layers(block), target)}" for kind, block in (("smooth", "optimized"), ("binary", "binary"))
             if all(layer["thickness"] is not None for layer in run.layers(block))]
    texts.append(geometric_text("geometric", geometric, target))
    texts += [geometric_text(f"geometric in {count}", found["thickness"], None) for count, found in resliced.items()]
    return "; ".join(texts)


def span(layers, target):
    values = [layer["thickness"] / (target or 1.0) for layer in layers]
    inner = values[:-1] or values
    return f"{min(inner):.3g} to {max(inner):.3g}, {values[-1]:.3g}"


def geometric_text(label, record, target):
    inner = record["inner"]
    if not inner:
        return f"{label} –"
    least, largest, unit = inner["least"], inner["largest"], target or 1.0
    return f"{label} {least / unit:.3g} to {largest / unit:.3g}" + ("" if target else " (length)")


def number(value):
    """Three digits."""
    if value is None:
        return "–"
    return f"{value:.3g}" if value == 0 or 1e-2 <= abs(value) < 1e4 else f"{value:.2e}".replace("e-0", "e-")


def factor(value):
    return f"{value:.1f}" if value < 9.95 else f"{value:.0f}" if value < 99950 else f"{value:.1e}".replace("e+0", "e")


def duration(seconds):
    return f"{seconds:.0f} s" if seconds < 120 else f"{seconds / 60:.0f} min" if seconds < 7200 else f"{seconds / 3600:.1f} h"
