# SPDX-License-Identifier: MIT
"""Tables of a report, as HTML. A cell with a number has all its digits as its title."""

import math
from html import escape

from fabseq_tools.report.words import (DISPLACEMENTS, MODELS, Figures, allowed_words, band, facts, model_of, ratio, run_name,
                                       states_of, thickness_span, unit_of, verdict, violation)
from fabseq_tools.run.check_words import check_figures, result_of
from fabseq_tools.run.settings import differing_keys
from fabseq_tools.run.verdict_words import buildable
from fabseq_tools.run.words import factor, number


def digits(value):
    """A figure in a table: whole numbers as they are, others with three digits, zeros included."""
    if isinstance(value, int):
        return f"{value:,}"
    return f"{value:#.3g}".rstrip(".") if 1e-2 <= abs(value) < 999.5 else number(value)


def cell(value, show=digits, **attributes):
    """A cell of a table; empty without a value."""
    if value is None or isinstance(value, float) and not math.isfinite(value):
        return "<td>–</td>"
    text, full = (escape(value), None) if isinstance(value, str) else (show(value), repr(value))
    attributes |= {"title": full} if full else {}
    return "<td" + "".join(f' {key}="{escape(str(word))}"' for key, word in attributes.items()) + f">{text}</td>"


def times(value):
    return f"{factor(value)} ×" if value >= 0.95 else f"{value:.2f} ×"


def table(head, rows, **attributes):
    """A table in a container of its own that scrolls. `rows`: (name, cells), or a name alone as a heading."""
    words = "".join(f' {key}="{escape(word)}"' for key, word in attributes.items())
    lines = [f'<div class="scroll" tabindex="0"><table{words}><thead><tr>',
             *(f'<th scope="col">{escape(name)}</th>' for name in head), "</tr></thead><tbody>"]
    for row in rows:
        if isinstance(row, str):
            lines.append(f'<tr class="group"><th colspan="{len(head)}"><span>{escape(row)}</span></th></tr>')
        else:
            lines.append(f'<tr><th scope="row">{escape(row[0])}</th>{"".join(row[1])}</tr>')
    return "".join(lines) + "</tbody></table></div>"


def term_words(run, name):
    """A row of the table: what a distortion term measures."""
    term = run.config["objective"][int(name.split("_")[1])]
    return run.measure(term) + (", after release" if term.get("after_release") else "")


def measured(run, states):
    """Rows of lengths for both models, a column for each state."""
    rows = []
    for model in sorted(MODELS, key=lambda model: model != model_of(run)):
        figures = [Figures(run, state, model) for state in states]
        if not any(f.part or f.lengths for f in figures):
            continue
        optimized = ", which the run optimizes" if model == model_of(run) and "binary" in states else ""
        rows.append(f"{MODELS[model].capitalize()}{optimized} ({unit_of(run)})")
        rows += [(term_words(run, name), [f.lengths.get(name) for f in figures]) for name in figures[-1].lengths]
        for what, key, words in DISPLACEMENTS:
            values = [getattr(f, what).get(key) for f in figures]
            if any(value is not None for value in values):
                rows.append((words, values))
    return rows + finished(run, states)


def finished(run, states):
    """Rows of the finished part by the run's own model: machining stock as built, all after the release."""
    rows = []
    for moment, heading in (("as_built", "Machining stock as built"), ("released", "After the release")):
        blocks = [run.summary.get(state, {}).get("finished", {}).get(moment) or {} for state in states]
        if not any(blocks):
            continue
        rows.append(f"{heading} ({unit_of(run)})")
        if moment == "released":
            rows += [(words, [(block.get({"part": "displacement"}.get(what, what)) or {}).get(key) for block in blocks])
                     for what, key, words in DISPLACEMENTS]
        rows += [(f"skin {place} the drawing, at most", [block.get("stock", {}).get(side) for block in blocks])
                 for side, place in (("outward", "outside"), ("inward", "inside"))]
    return rows


def results(run):
    """All states side by side, and what planar layers and the start are worse by, in length."""
    states = states_of(run)
    if not states:
        return ""
    columns = list(states)
    rows = measured(run, columns)
    compared = [state for state in ("baseline", "start") if {state, "binary"} <= set(columns)]
    for position, row in enumerate(rows):
        if not isinstance(row, str):
            by_state = dict(zip(columns, row[1]))
            ratios = [ratio(by_state[state], by_state["binary"]) for state in compared]
            rows[position] = (row[0], [*map(cell, row[1]), *(cell(value, times) for value in ratios)])
    blank = ["<td></td>"] * len(compared)
    rows += [(name, [*cells, *blank]) if cells else name for name, cells in layer_rows(run, columns)]
    head = ["", *states.values(), *(f"{'start' if state == 'start' else states[state]} / binary" for state in compared)]
    return table(head, rows, id="results")


def layer_rows(run, states):
    """Thickness of the layers of each state, and whether constraints are satisfied where the files say so."""
    constraint = run.thickness_constraint()
    spans = [thickness_span(run, state) for state in states]
    rows = [(f"Layers ({unit_of(run)})", None),
            ("layers with an element at least", [cell(len(run.layers(state))) for state in states])]
    if any(span for span in spans):
        rows.append(("thinnest layer", [cell(span and span[0]) for span in spans]))
        rows.append(("thickest layer", [cell(span and span[1]) for span in spans]))
    if constraint and any(span for span in spans):
        low, high = band(constraint)
        rows.append((f"all between {number(low)} and {number(high)}",
                     [cell(None if span is None else "yes" if inside(span, low, high) else "no") for span in spans]))
    worst = {"optimized": violation(run, False), "binary": violation(run, True)}
    if any(value is not None for value in worst.values()):
        rows.append(("all constraints", [cell(verdict(worst.get(state))) for state in states]))
    can_be_built = [None if state == "optimized" else buildable(run, state) for state in states]  # smooth layers never are
    if any(can_be_built):
        rows.append(("verdict", list(map(cell, can_be_built))))
    for heading, figures in check_figures(run).items():
        found = check_rows(figures, [(run, state) for state in states])
        rows += [(heading, None)] * bool(found and heading) + found
    return rows


def check_rows(figures, columns):
    """Rows of those figures that a column has; a column is a run and its state."""
    rows = []
    for words, (value, show) in figures.items():
        values = [value(run, state) for run, state in columns]
        if any(value is not None for value in values):
            rows.append((words, [cell(value, show or digits) for value in values]))
    return rows


def inside(span, low, high):
    slack = 1e-9 * high
    return low - slack <= span[0] and span[1] <= high + slack


def constraints(run):
    """What each constraint allows, and the values it has: of the smallest and the largest component."""
    states = {state: words for state, words in states_of(run).items() if state in ("optimized", "binary", "simulated")}
    rows = []
    for position, constraint in enumerate(run.config.get("constraints", [])):
        cells = [cell(allowed_words(constraint))]
        for state in states:
            values = [r["value"] for r in run.summary[state]["responses"] if r["name"].startswith(f"constraint_{position}_")]
            values = [value for value in values if value is not None]
            span = list(dict.fromkeys([min(values), max(values)])) if values else []
            cells.append(cell(" to ".join(map(digits, span)) or None, title=" to ".join(map(repr, span))))
        rows.append((constraint["type"].replace("_", " "), cells))
    return table(["constraint", "allowed", *states.values()], rows, id="constraints") if rows and states else ""


def facts_table(runs):
    """Of one run a line per fact; of several a column per run."""
    told = [facts(run) for run in runs]
    names = dict.fromkeys(name for words in told for name in words)
    rows = [(name, [cell(words.get(name)) for words in told]) for name in names]
    return table(["", *(run.label for run in runs)] if len(runs) > 1 else ["", run_name(runs[0])], rows, **{"class": "facts"})


def sensitivity(run):
    """The table of -task sensitivity: lengths, and by how much less than in planar layers."""
    if not run.sensitivity:
        return ""
    rows, worst = [], run.sensitivity.get("worst", {})
    for change in run.sensitivity["changes"]:
        if "skipped" in change:
            rows.append((change["change"], [f'<td colspan="4">left out: {escape(change["skipped"])}</td>']))
            continue
        least = [key for key in worst if worst[key].get("change") == change["change"]]
        lengths = [next((t["length"] for t in change[side]["distortion"] or []), None) for side in ("planar", "sequence")]
        ratios = [cell(change["ratio"][key], times, **{"class": "least"} if key in least else {}) for key in ("length", "rms")]
        rows.append((change["change"], [*map(cell, lengths), *ratios]))
    return table(["change", f"planar, {unit_of(run)}", f"sequence, {unit_of(run)}", "planar / sequence",
                  "the same of the part's displacement, rms"], rows, id="sensitivity-table")


def comparison(runs):
    """The figures of the results with a column per run, and the settings in which the runs differ."""
    rows, models = [], {model_of(run) for run in runs}
    for model in sorted(MODELS, key=lambda model: model not in models):
        figures = {state: [Figures(run, state or result_of(run), model) for run in runs] for state in (None, "baseline", "start")}
        lengths = {state: [f.first(run) for f, run in zip(figures[state], runs)] for state in figures}
        if not any(length is not None for length in lengths[None]):
            continue
        rows += [f"{MODELS[model].capitalize()}, binary layers",
                 ("first distortion term, length", list(map(cell, lengths[None]))),
                 *((f"{words} / binary", [cell(ratio(*pair), times) for pair in zip(lengths[state], lengths[None])])
                   for state, words in (("baseline", "planar"), ("start", "start"))),
                 *((words, [cell(getattr(f, what).get(key)) for f in figures[None]]) for what, key, words in DISPLACEMENTS)]
    rows += ["Layers and run", *comparison_of_runs(runs)]
    keys = differing_keys(runs)
    if keys:
        rows += ["Settings that differ", *((key, [cell(str(run.settings.get(key, "–"))) for run in runs]) for key in keys)]
    return table(["", *(run.label for run in runs)], rows, id="results")


def comparison_of_runs(runs):
    spans = [thickness_span(run, result_of(run)) if result_of(run) in run.summary else None for run in runs]
    worst = [(run.sensitivity or {}).get("worst", {}).get("length", {}) for run in runs]
    columns = [(run, result_of(run)) for run in runs]
    return [("worst planar / binary under a change", [cell(w.get("ratio"), times) for w in worst]),
            ("the change", [cell(w.get("change")) for w in worst]),
            ("thinnest layer", [cell(span and span[0]) for span in spans]),
            ("thickest layer", [cell(span and span[1]) for span in spans]),
            *(row for figures in check_figures().values() for row in check_rows(figures, columns)),
            ("constraints, smooth layers", [cell(verdict(violation(run, False))) for run in runs]),
            ("constraints, binary layers", [cell(verdict(violation(run, True))) for run in runs]),
            ("verdict", [cell(buildable(*column)) for column in columns]),
            ("unit of length", [cell(unit_of(run)) for run in runs]),
            ("iterations", [cell(run.summary.get("iterations")) for run in runs]),
            ("seconds", [cell(run.summary.get("seconds", {}).get("total")) for run in runs]),
            ("ranks", [cell(run.summary.get("ranks", run.config.get("run", {}).get("ranks"))) for run in runs])]
