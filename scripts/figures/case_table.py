# SPDX-License-Identifier: MIT
"""Figures of the published cases: a page per case, docs/results/CASE.md, and its row in docs/results.md.

scripts/figures/reproduce.py writes both. What stands outside the marks stays as it is.
"""

import fcntl
import math
import os
import textwrap

from command_line import RunError
from read_run import Run, duration, read_json

OVERVIEW = "<!-- cases -->", "<!-- end of cases -->"
PAGE = "<!-- case -->", "<!-- end of case -->"
HEAD = "| case | published | smooth | binary | nominal | constraints |\n| --- | --- | --- | --- | --- | --- |"
WIDTH = 110


def record(overview, order, name, case, figures, picture):
    """Writes a case's page, beside its picture, and its row in the overview; `order`: names of all cases."""
    page = page_of(overview, name)
    if not os.path.exists(page):
        with open(page, "w", encoding="utf-8") as file:
            file.write(f"# {name}\n\n{PAGE[0]}\n{PAGE[1]}\n")
    rewrite(page, PAGE, lambda _: page_text(case, figures, picture))
    rewrite(overview, OVERVIEW, lambda table: with_row(table, order, name, figures))


def page_of(overview, name):
    return os.path.join(os.path.dirname(os.path.abspath(overview)), "results", f"{name}.md")


def rewrite(path, marks, change):
    """Puts `change(text)` in place of the text between two marks. Several programs may do so at a time."""
    with open(path, "r+", encoding="utf-8") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        text = file.read()
        if any(text.count(mark) != 1 for mark in marks):
            raise RunError(f"{path}: needs one line '{marks[0]}' and one '{marks[1]}'")
        before, rest = text.split(marks[0])
        middle, after = rest.split(marks[1])
        file.seek(0)
        file.write(f"{before}{marks[0]}\n{change(middle)}\n{marks[1]}{after}")
        file.truncate()


def with_row(table, order, name, figures):
    """The table with the row of a case, and the links behind it, in the order of the cases."""
    rows = {line.split("]")[0][3:]: line for line in table.splitlines() if line.startswith("| [")}
    firsts = [figures[key].split("; ")[0] for key in ("published", "smooth", "binary", "binary, nominal")]
    factors = [text.split(": ")[1] if ": " in text else "–" for text in firsts]
    rows[name] = f"| [{name}] | " + " | ".join([*factors, figures["worst constraint"]]) + " |"
    known = {key: number for number, key in enumerate(order)}
    names = sorted(rows, key=lambda key: known.get(key, len(known)))
    return "\n".join([HEAD, *(rows[key] for key in names), "", *(f"[{key}]: results/{key}.md" for key in names)])


def page_text(case, figures, picture):
    note = f"; {case['note']}" if "note" in case else ""
    lines = textwrap.wrap(f"{case['what']} [{case['source']}]{note}.", WIDTH, break_on_hyphens=False)
    lines += ["", "| | |", "| --- | --- |", *(f"| {label} | {text} |" for label, text in figures.items())]
    image = ["", f"![layers and distorted shapes, planar and optimized]({picture})"] if picture else []
    return "\n".join(lines + image)


def figures_of(case, directory, thickness, resliced):
    """Everything that is said of a case, as text by label, from the output directory of a run."""
    figures = {"published": published(case)}
    return figures | (simulated(directory) if case.get("task") == "simulate" else optimized(directory, thickness, resliced))


def published(case):
    figures = case.get("published")
    if not figures:
        return "–"
    planar, best = figures.get("planar"), figures.get("optimized")
    text = f"{number(planar)} → {number(best)}" + (f": {factor(planar / best)}" if planar and best else "")
    return text + (f"; cut again {number(figures['resliced'])}" if "resliced" in figures else "")


def simulated(directory):
    summary = read_json(directory, "summary.json")
    nominal = summary["deposition"]["nominal"]
    published, built = (", ".join(number(r["value"]) for r in terms)
                        for terms in (filter(is_distortion, summary["responses"]), nominal["distortion"]))
    return {"planar": published, "planar, nominal": built, "smooth": "–", "binary": "–", "binary, nominal": "–",
            "worst constraint": "–",
            "run": f"simulated, largest displacement {number(summary['displacement']['max'])}, "
                   f"{number(nominal['displacement']['max'])} nominal"}


def optimized(directory, thickness, resliced):
    run = Run(directory, with_fields=False)
    summary = run.summary
    planar, smooth, binary = (distortion(summary[block]["responses"]) for block in ("baseline", "optimized", "binary"))
    cells = gains(planar, smooth, binary)
    for count, found in resliced.items():
        values = (distortion(found[kind]["responses"]) for kind in cells)
        cells = {kind: f"{cells[kind]}; in {count} layers {text}" for kind, text in gains(*values).items()}
    worst = summary["worst_constraint"]
    violation = "–" if worst is None else "satisfied" if worst <= 0 else f"{100 * worst:.2g} % beyond"
    if "angles" in summary:  # of every sub-part, in degrees: elevation, and in 3D the azimuth
        angles = ("/".join(f"{math.degrees(angle):.0f}°" for angle in of_part) for of_part in summary["angles"])
        layers = {"print angles": ", ".join(angles)}
    else:
        layers = thicknesses(run, thickness, resliced)
    ranks, before = run.config.get("run", {}).get("ranks"), summary.get("coarse_iterations", 0)
    iterations = f"{summary['iterations']} iterations" + (f" after {before} at half the resolution" if before else "")
    cells["binary, nominal"] = nominal_gain(summary["baseline"], summary["binary"])
    return {**cells, "worst constraint": violation, **layers, "interior minima": str(summary["interior_minima"]),
            "run": f"{iterations}, {duration(summary['seconds']['total'])} on {ranks} rank{'s' * (ranks != 1)}"}


def gains(planar, smooth, binary):
    """Distortions, those of optimized layers with how many times less than with planar ones it is."""
    return {"planar": number(planar), "smooth": f"{number(smooth)}: {factor(planar / smooth)}",
            "binary": f"{number(binary)}: {factor(planar / binary)}"}


def nominal_gain(planar, binary):
    """What the same layers do where material goes to nominal positions."""
    of_planar, of_binary = (sum(term["value"] for term in block["deposition"]["nominal"]["distortion"])
                            for block in (planar, binary))
    return f"{number(of_planar)} → {number(of_binary)}: {factor(of_planar / of_binary)}"


def distortion(responses):
    """Sum of all distortion terms, as published for two faces or edges."""
    return sum(r["value"] for r in responses if is_distortion(r))


def is_distortion(response):
    """Whether a response is a term of the objective that measures distortion: limits are none."""
    return response["type"] == "distortion" and response["name"].startswith("objective")


def thicknesses(run, geometric, resliced):
    """By the gradient, smooth and binary, and geometric, each relative to the target where there is one."""
    constraint = run.thickness_constraint()
    target = constraint["target"] if constraint else None
    unit = "thickness / target" if target else "thickness"
    texts = {f"{unit}, {kind}": span(run.layers(block), target) for kind, block in (("smooth", "optimized"), ("binary", "binary"))
             if all(layer["thickness"] is not None for layer in run.layers(block))}
    texts[f"{unit}, geometric"] = geometric_text(geometric, target)
    return texts | {f"thickness, geometric, in {count} layers": geometric_text(found["thickness"], None)
                    for count, found in resliced.items()}


def span(layers, target):
    values = [layer["thickness"] / (target or 1.0) for layer in layers]
    inner = values[:-1] or values
    return f"{min(inner):.3g} to {max(inner):.3g}; last layer {values[-1]:.3g}"


def geometric_text(record, target):
    inner, unit = record["inner"], target or 1.0
    return f"{inner['least'] / unit:.3g} to {inner['largest'] / unit:.3g}" if inner else "–"


def number(value):
    """Three digits."""
    if value is None:
        return "–"
    return f"{value:.3g}" if value == 0 or 1e-2 <= abs(value) < 1e4 else f"{value:.2e}".replace("e-0", "e-")


def factor(value):
    return f"{value:.1f}" if value < 9.95 else f"{value:.0f}" if value < 99950 else f"{value:.1e}".replace("e+0", "e")
