# SPDX-License-Identifier: MIT
"""The curves of a report, as lists that the page draws (report/src/charts.js): how the optimization went, and
the layers it ended with."""

import math

from fabseq_tools.report.words import STATES, Figures, band, model_of, states_of, unit_of
from fabseq_tools.run.check_words import result_of
from fabseq_tools.run.misses import worst_misses

PHASES = ("heat", "layers", "primal", "adjoint", "responses", "optimizer", "output")


def charts_of(runs):
    """The charts of one run, or of several with a curve each."""
    several = len(runs) > 1
    charts = [distortion(runs), None if several else terms(runs[0]), violation(runs),
              None if several else thickness_history(runs[0]), over_iterations(runs, "beta", "Sharpness β"),
              over_iterations(runs, "change", "Largest change of a variable", log=True),
              layers(runs, "thickness"), layers(runs, "volume"), seconds(runs)]
    return [chart for chart in charts if chart and any(any(y is not None for y in s["y"]) for s in chart["series"])]


def chart(title, curves, label, **more):
    """`curves`: dictionaries with `label`, `role` (the colour) and `points`, pairs of x and y."""
    xs = sorted({x for curve in curves for x, _ in curve["points"]})
    series = []
    for curve in curves:
        values = dict(curve["points"])
        series.append({**curve, "y": [short(values.get(x)) for x in xs]})
        del series[-1]["points"]
    return {"title": title, "xLabel": label, "x": xs, "series": series, **more}


def short(value):
    """Five digits, which no chart shows more of."""
    return None if value is None or not math.isfinite(value) else float(f"{value:.5g}")


def role(position, run, runs, alone):
    """Name and colour of a run's curve: of its own among several, else those of the optimized part."""
    return {"label": run.label, "role": position} if len(runs) > 1 else {"label": alone, "role": "optimized"}


def over_iterations(runs, key, title, scale=1.0, **more):
    curves = [{**role(n, run, runs, title), "points": [(line["iteration"], None if line.get(key) is None else scale * line[key])
                                                       for line in run.history]} for n, run in enumerate(runs)]
    return chart(title, curves, "iteration", **more)


def length_of(run, objective):
    value = objective[run.distortion_term] if len(objective) > run.distortion_term else None
    return math.sqrt(max(value, 0.0)) if value is not None and run.distortion_config.get("type") == "distortion" else value


def distortion(runs):
    curves = [{**role(n, run, runs, "smooth layers"), "points": [(line["iteration"], length_of(run, line["objective"]))
                                                                 for line in run.history]} for n, run in enumerate(runs)]
    lines, run = [], runs[0]
    if len(runs) == 1:
        judged = [(line["iteration"], length_of(run, line["binary"]["objective"])) for line in run.history if line.get("binary")]
        if judged:
            curves.append({"label": "the same, binary layers", "role": "binary", "dots": True, "points": judged})
        lines = [{"label": STATES[state], "role": state, "y": Figures(run, state, model_of(run)).first(run)}
                 for state in ("baseline", "start")]
    unit = "degrees" if run.distortion_config.get("measure") == "angle" else unit_of(run)
    title = f"Distortion, {unit}" if run.distortion_config.get("type") == "distortion" else "First objective"
    return chart(title, curves, "iteration", log=True, lines=[line for line in lines if line["y"]],
                 note="root of the first distortion term", mark=None if len(runs) > 1 else run.summary.get("best_iteration"))


def terms(run):
    """All terms of the objective, where there is more than one, relative to the first iteration."""
    kinds = [term["type"].replace("_", " ") for term in run.config.get("objective", [])]
    curves = [{"label": kind, "role": position,
               "points": [(line["iteration"], relative(line["objective"], run.history[0]["objective"], position))
                          for line in run.history]} for position, kind in enumerate(kinds)]
    return chart("Objective terms over their first values", curves, "iteration", log=True,
                 note="a distortion is the square of a length here") if len(kinds) > 1 else None


def relative(values, first, position):
    known = position < len(values) and None not in (values[position], first[position])
    return values[position] / first[position] if known and first[position] else None


def violation(runs):
    curves = [{**role(n, run, runs, ""),
               "points": list(zip((line["iteration"] for line in run.history), 100 * worst_misses(run)))}
              for n, run in enumerate(runs)]
    result = chart("Worst violation of a constraint, %", curves, "iteration", symmetric=True, band=[None, 0.0],
                   note="0 and below: all are satisfied; of counts the share of the part beyond their limits")
    return result if any(run.config.get("constraints") for run in runs) else None


def thickness_history(run):
    """The thinnest and the thickest layer that the thickness constraint sees."""
    names = [c["type"] for c in run.config.get("constraints", [])]
    if "layer_thickness" not in names or not run.history:
        return None
    position, tolerance = names.index("layer_thickness"), run.thickness_constraint()["tolerance"]
    seen = [(line["iteration"], [d for d in line["constraints"][position] if d is not None])
            for line in run.history if len(line["constraints"]) > position]
    curves = [{"label": word, "role": which, "points": [(iteration, pick(values, default=None)) for iteration, values in seen]}
              for word, which, pick in (("thickest layer", "binary", max), ("thinnest layer", "optimized", min))]
    return chart("Thickness over target", curves, "iteration", log=True, band=[1 - tolerance, 1 + tolerance],
                 note="slivers that the constraint leaves out may lie outside")


def layers(runs, key):
    """Thickness or volume of each layer: of all states of one run, or of the binary layers of several."""
    run = runs[0]
    if len(runs) > 1:
        curves = [{**role(n, run, runs, ""), **layer_points(run, result_of(run), key)} for n, run in enumerate(runs)
                  if result_of(run) in run.summary]
    else:
        curves = [{"label": words, "role": state, **layer_points(run, state, key)}
                  for state, words in states_of(run).items() if state not in ("baseline_matched", "baseline_tilted")]
    constraint = run.thickness_constraint()
    more = {"band": list(band(constraint))} if key == "thickness" and constraint else {}
    title = f"Thickness of each layer, {unit_of(run)}" if key == "thickness" else f"Volume of each layer, {unit_of(run)}³"
    if key == "volume" and len(run.config["domain"]["size"]) == 2:
        title = "Volume of each layer"
    return chart(title.replace("units³", "units cubed"), curves, "layer", dotted=True,
                 log=key == "thickness", note="shaded: allowed" if more else "", **more) if curves else None


def layer_points(run, state, key):
    return {"points": [(layer["number"], layer[key]) for layer in run.layers(state)]}


def seconds(runs):
    if len(runs) > 1:
        curves = [{**role(n, run, runs, ""), "points": [(line["iteration"], line["seconds"]["total"]) for line in run.history]}
                  for n, run in enumerate(runs)]
        return chart("Seconds per iteration", curves, "iteration")
    run, curves = runs[0], []
    for position, phase in enumerate(PHASES):
        total = run.summary.get("seconds", {}).get(phase)
        points = [(line["iteration"], line["seconds"].get(phase)) for line in run.history]
        if any(value for _, value in points):
            curves.append({"label": f"{phase}, {total:.0f} s in all" if total is not None else phase, "role": position,
                           "points": points})
    return chart("Seconds per iteration, by phase", curves, "iteration") if curves else None
