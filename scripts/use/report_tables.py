# SPDX-License-Identifier: MIT
"""Headline and tables of a report, as HTML. A cell with a number has all its digits as its title."""

import math
from html import escape

from read_run import duration, factor, number

STATES = {"start": "start design", "baseline": "planar layers", "optimized": "optimized, smooth", "binary": "optimized, binary",
          "simulated": "simulated"}
MODELS = {"nominal": "nominal deposition", "follow": "deposition that follows the part"}


def unit_of(run):
    return run.config.get("domain", {}).get("unit") or "length units"


def model_of(run):
    """The deposition model of the run; configs without the key are older than it."""
    return run.config.get("process", {}).get("deposition", "follow")


def states_of(run):
    return {state: words for state, words in STATES.items() if state in run.summary}


class Figures:
    """What summary.json says of one state under one model of deposition: `lengths` of the distortion terms by
    name, `part` and `nodes` with `rms` and `max` displacement. Empty what the file does not have."""

    def __init__(self, run, state, model):
        block = run.summary.get(state, {})
        figures = block.get("deposition", {}).get(model)
        if figures is None and model == model_of(run):
            terms = [r for r in block.get("responses", []) if r["type"] == "distortion" and r["name"].startswith("objective")]
            figures = {"displacement": block.get("displacement"),
                       "distortion": [{**r, "length": math.sqrt(r["value"])} for r in terms]}
        figures = figures or {}
        self.lengths = {term["name"]: term["length"] for term in figures.get("distortion") or []}
        self.part, self.nodes = figures.get("displacement") or {}, figures.get("nodes") or {}

    def first(self, run):
        return self.lengths.get(f"objective_{run.distortion_term}")


def ratio(above, below):
    return above / below if above is not None and below else None


def sentence(term):
    """What a distortion term says, with a gap for how much less or more."""
    nodes, to = (str(term.get(key, "part")).replace("_", " ") for key in ("nodes", "to"))
    return {"shape": f"the shape of the {nodes} distorts {{}}", "flatness": f"the {nodes} deviates {{}} from a plane",
            "angle": f"the angle between {nodes} and {to} changes {{}}",
            "layerwise": "the part moves, layer by layer, {}"}.get(term.get("measure"), f"the {nodes} moves {{}}")


def less(value):
    return f"{factor(value)} times less" if value >= 1 else f"{factor(1 / value)} times more"


def headline(run):
    """One sentence: the binary layers against planar layers and the start, as ratios of lengths."""
    model, term = model_of(run), run.distortion_config
    lengths = {state: Figures(run, state, model).first(run) for state in STATES}
    planar, start = (ratio(lengths[state], lengths["binary"]) for state in ("baseline", "start"))
    if planar is None:
        return f"{run.name.replace('_', ' ').capitalize()}: {run.summary.get('status', 'no result yet')}"
    words = f"{sentence(term).format(less(planar))} than in planar layers"
    words += f", {less(start)} than the unoptimized start" if start is not None else ""
    notes = ["binary layers", MODELS[model], *["after release"] * bool(term.get("after_release"))]
    if term.get("aggregate", "nominal") != "nominal":
        notes.append(f"{term['aggregate']} over the scenarios")
    return f"{words[0].upper()}{words[1:]} ({', '.join(notes)})."


def worst_case(run):
    """The worst ratio of sensitivity.json in words, or nothing."""
    worst = (run.sensitivity or {}).get("worst", {}).get("length")
    if not worst or worst.get("ratio") is None:
        return ""
    return f"At worst {less(worst['ratio'])} than in planar layers: {worst['change']}."


def cell(value, show=number, **attributes):
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
            lines.append(f'<tr class="group"><th colspan="{len(head)}">{escape(row)}</th></tr>')
        else:
            lines.append(f'<tr><th scope="row">{escape(row[0])}</th>{"".join(row[1])}</tr>')
    return "".join(lines) + "</tbody></table></div>"


def term_words(run, name):
    """A row of the table: what a distortion term measures, and its unit."""
    term = run.config["objective"][int(name.split("_")[1])]
    words = run.measure(term) + (", after release" if term.get("after_release") else "")
    return words if term.get("measure") == "angle" else f"{words}, {unit_of(run)}"


def measured(run, states):
    """Rows of lengths for both models, a column for each state."""
    rows = []
    for model in sorted(MODELS, key=lambda model: model != model_of(run)):
        figures = [Figures(run, state, model) for state in states]
        if not any(f.part or f.lengths for f in figures):
            continue
        rows.append(f"{MODELS[model]}{' (what the run optimizes)' if model == model_of(run) else ''}")
        rows += [(term_words(run, name), [f.lengths.get(name) for f in figures]) for name in figures[-1].lengths]
        for what, words in (("nodes", "nodes of the objective"), ("part", "whole part")):
            for key, kind in (("rms", "root mean square"), ("max", "largest")):
                values = [getattr(f, what).get(key) for f in figures]
                if any(value is not None for value in values):
                    rows.append((f"{words}, {kind} displacement, {unit_of(run)}", values))
    return rows


def results(run):
    """All states side by side, and what planar layers and the start are worse by, in length."""
    states = states_of(run)
    if not states:
        return ""
    columns = list(states)
    rows = measured(run, columns)
    compared = "binary" in columns
    for position, row in enumerate(rows):
        if not isinstance(row, str):
            by_state = dict(zip(columns, row[1]))
            ratios = [ratio(by_state.get(state), by_state["binary"]) for state in ("baseline", "start")] if compared else []
            rows[position] = (row[0], [*map(cell, row[1]), *(cell(value, times) for value in ratios)])
    blank = ["<td></td>"] * (2 * compared)
    rows += [(name, [*cells, *blank]) if cells else name for name, cells in layer_rows(run, columns)]
    head = ["", *states.values(), *["planar / binary", "start / binary"] * compared]
    return table(head, rows, id="results")


def layer_rows(run, states):
    """Thickness of the layers of each state, and whether constraints are satisfied where the files say so."""
    constraint = run.thickness_constraint()
    spans = [thickness_span(run, state) for state in states]
    rows = [("Layers", None), ("layers with an element at least", [cell(len(run.layers(state))) for state in states])]
    if any(span for span in spans):
        rows.append((f"thinnest layer, {unit_of(run)}", [cell(span and span[0]) for span in spans]))
        rows.append((f"thickest layer, {unit_of(run)}", [cell(span and span[1]) for span in spans]))
    if constraint and any(span for span in spans):
        low, high = band(constraint)
        rows.append((f"all between {number(low)} and {number(high)}",
                     [cell(None if span is None else "yes" if inside(span, low, high) else "no") for span in spans]))
    worst = {"optimized": violation(run, False), "binary": violation(run, True)}
    if any(value is not None for value in worst.values()):
        rows.append(("all constraints", [cell(verdict(worst.get(state))) for state in states]))
    return rows


def thickness_span(run, state):
    values = [layer["thickness"] for layer in run.layers(state) if layer["thickness"] is not None]
    return (min(values), max(values)) if values else None


def band(constraint):
    return tuple(constraint["target"] * (1 + sign * constraint["tolerance"]) for sign in (-1, 1))


def inside(span, low, high):
    slack = 1e-9 * high
    return low - slack <= span[0] and span[1] <= high + slack


def violation(run, binary):
    """Worst relative violation of the iterate that became the result: of its smooth or its binary layers."""
    best = next((line for line in run.history if line["iteration"] == run.summary.get("best_iteration")), None)
    if best is None or not run.config.get("constraints"):
        return None
    return (best.get("binary") or {}).get("worst_constraint") if binary else best.get("worst_constraint")


def verdict(worst):
    """In words, of a relative violation; below 0 is the room that is left."""
    if worst is None:
        return None
    return "satisfied" if worst <= 0 else f"violated by {100 * worst:.2g} %"


def facts(run):
    """What was run, as (name, words)."""
    config, summary = run.config, run.summary
    domain, layers, seconds = config["domain"], config.get("layers", {}), summary.get("seconds", {}).get("total")
    spacing = [length / n for length, n in zip(domain["size"], domain["elements"])]
    elements = f", {summary['part_elements']:,} of them in the part" if "part_elements" in summary else ""
    reason = summary.get("reason")
    words = {
        "status": summary.get("status", "going on or interrupted") + (f" ({reason})" if reason else ""),
        "part": part_words(config.get("part", {})),
        "box": f"{by(domain['size'])} {unit_of(run)}, {by(domain['elements'])} elements of {by(spacing)}{elements}",
        "layers": f"{layers.get('type', '')}, {layers.get('count') or layers.get('subparts', '')}, "
                  f"time points {layers.get('time_points', 'uniform')}" if layers else None,
        "sequence": " ".join(f"{key.replace('_', ' ')} {value}" for key, value in config.get("sequence", {}).items()
                             if key in ("type", "characteristic_length", "bounds", "filter_radius")),
        "process": f"{MODELS[model_of(run)]}, void {config.get('process', {}).get('void', 'absent')}",
        "inherent strain": strain_words(config.get("material", {})),
        "objective": "; ".join(map(objective_words, config.get("objective", []))),
        "constraints": "; ".join(map(settings_words, config.get("constraints", []))) or "none",
        "sharpness": f"{number(run.history[0]['beta'])} to {number(run.history[-1]['beta'])}" if run.history else None,
        "iterations": iteration_words(run),
        "time": f"{duration(seconds)} on {summary.get('ranks', config.get('run', {}).get('ranks', '?'))} ranks, at most "
                f"{summary.get('peak_memory_bytes', 0) / 2**30:.2g} GiB" if seconds is not None else None,
        "program": f"fabseq {config['run'].get('fabseq', '')}" if "run" in config else None}
    return {name: text for name, text in words.items() if text}


def by(values):
    return " × ".join(f"{value:.4g}" if isinstance(value, float) else f"{value}" for value in values)


def part_words(part):
    kind = next(iter(part), "")
    if isinstance(part.get(kind), dict) and "file" in part[kind]:
        return f"{kind} of {part[kind]['file'].rsplit('/', 1)[-1]}"
    return f"{kind} of shapes" if kind in ("union", "difference", "intersection") else kind


def strain_words(material):
    strain = material.get("inherent_strain")
    if strain is None:
        return None
    scale, scenarios = material.get("strain_scale"), material.get("scenarios")
    scaled = f", scaled by {scale}" if scale and set(scale) != {1} else ""
    return f"{strain}{scaled}{f', {len(scenarios)} scenarios' if scenarios else ''}".replace("'", "")


def objective_words(term):
    kind = f"{term['measure']} of {term.get('nodes', 'the part')}" if term["type"] == "distortion" else term["type"]
    return f"{kind}, weight {term.get('weight', 1):g}".replace("_", " ")


def settings_words(constraint):
    return " ".join(str(value) if key == "type" else f"{key} {value}" for key, value in constraint.items()).replace("_", " ")


def iteration_words(run):
    if "iterations" not in run.summary:
        return f"{len(run.history)} so far" if run.history else None
    coarse = run.summary.get("coarse_iterations")
    words = f"{run.summary['iterations']}{f' after {coarse} at half the resolution' if coarse else ''}"
    best = run.summary.get("best_iteration")
    return words + (f", the result is number {best}" if best is not None else "")


def facts_table(runs):
    """Of one run a line per fact; of several a column per run."""
    told = [facts(run) for run in runs]
    rows = [(name, [cell(words.get(name)) for words in told]) for name in dict.fromkeys(key for words in told for key in words)]
    return table(["", *(run.label for run in runs)] if len(runs) > 1 else ["", run_name(runs[0])], rows, **{"class": "facts"})


def run_name(run):
    return run.name.replace("_", " ")


def sensitivity(run):
    """The table of -task sensitivity: lengths, and by how much less than in planar layers."""
    if not run.sensitivity:
        return ""
    rows = []
    for change in run.sensitivity["changes"]:
        if "skipped" in change:
            rows.append((change["change"], [f'<td colspan="4">left out: {escape(change["skipped"])}</td>']))
            continue
        lengths = [next((t["length"] for t in change[side]["distortion"] or []), None) for side in ("planar", "sequence")]
        ratios = change["ratio"]
        rows.append((change["change"], [*map(cell, lengths), cell(ratios["length"], times), cell(ratios["rms"], times)]))
    return table(["change", f"planar, {unit_of(run)}", f"sequence, {unit_of(run)}", "planar / sequence",
                  "the same of the part's displacement, rms"], rows, id="sensitivity-table")


def comparison(runs):
    """The figures of binary layers with a column per run, below the settings in which the runs differ."""
    rows = []
    keys = [key for key in dict.fromkeys(key for run in runs for key in run.settings)
            if len({repr(run.settings.get(key)) for run in runs}) > 1]
    if keys:
        rows = ["Settings that differ", *((key, [cell(str(run.settings.get(key, "–"))) for run in runs]) for key in keys)]
    models = {model_of(run) for run in runs}
    for model in sorted(MODELS, key=lambda model: model not in models):
        figures = {state: [Figures(run, state, model) for run in runs] for state in ("binary", "baseline", "start")}
        lengths = {state: [f.first(run) for f, run in zip(figures[state], runs)] for state in figures}
        if not any(length is not None for length in lengths["binary"]):
            continue
        rows += [f"{MODELS[model].capitalize()}, binary layers",
                 ("first distortion term, length", list(map(cell, lengths["binary"]))),
                 *((f"{words} / binary", [cell(ratio(above, below), times) for above, below in zip(lengths[state], lengths["binary"])])
                   for state, words in (("baseline", "planar"), ("start", "start"))),
                 *((f"{words}, {kind} displacement", [cell(getattr(f, what).get(key)) for f in figures["binary"]])
                   for what, words in (("nodes", "nodes of the objective"), ("part", "whole part"))
                   for key, kind in (("rms", "root mean square"), ("max", "largest")))]
    rows += ["Layers and run", *comparison_of_runs(runs)]
    return table(["", *(run.label for run in runs)], rows, id="results")


def comparison_of_runs(runs):
    spans = [thickness_span(run, "binary") if "binary" in run.summary else None for run in runs]
    worst = [(run.sensitivity or {}).get("worst", {}).get("length", {}) for run in runs]
    return [("worst planar / binary under a change", [cell(w.get("ratio"), times) for w in worst]),
            ("the change", [cell(w.get("change")) for w in worst]),
            ("thinnest layer", [cell(span and span[0]) for span in spans]),
            ("thickest layer", [cell(span and span[1]) for span in spans]),
            ("constraints, smooth layers", [cell(verdict(violation(run, False))) for run in runs]),
            ("constraints, binary layers", [cell(verdict(violation(run, True))) for run in runs]),
            ("unit of length", [cell(unit_of(run)) for run in runs]),
            ("iterations", [cell(run.summary.get("iterations")) for run in runs]),
            ("seconds", [cell(run.summary.get("seconds", {}).get("total")) for run in runs]),
            ("ranks", [cell(run.summary.get("ranks", run.config.get("run", {}).get("ranks"))) for run in runs])]
