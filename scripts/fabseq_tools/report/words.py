# SPDX-License-Identifier: MIT
"""What a report says of a run in words: its headline, what was run, how it ended."""

from fabseq_tools.run.misses import worst_miss
from fabseq_tools.run.verdict_words import misses_constraints
from fabseq_tools.run.words import duration, less, number, quantity

STATES = {"start": "start design", "baseline": "planar", "baseline_matched": "planar, {} layers",
          "baseline_tilted": "planar, tilted", "baseline_even": "even layers",
          "optimized": "optimized, smooth", "binary": "optimized, binary", "simulated": "simulated"}
DISPLACEMENTS = [(what, key, f"{kind} displacement of {words}")
                 for what, words in (("nodes", "the objective's nodes"), ("part", "the whole part"))
                 for key, kind in (("rms", "rms"), ("max", "largest"))]
SEQUENCE = ("type", "location", "characteristic_length", "bounds", "filter_radius")  # settings that matter
MODELS = {"nominal": "nominal deposition", "follow": "deposition that follows the part"}


def unit_of(run):
    return run.unit or "length units"


def model_of(run):
    """The deposition model of the run."""
    return run.config["process"]["deposition"]


def states_of(run):
    return {state: words.format(len(run.layers(state))) for state, words in STATES.items() if state in run.summary}


class Figures:
    """What summary.json says of one state under one model of deposition: `lengths` of the distortion terms by
    name, `part` and `nodes` with `rms` and `max` displacement. Empty what the file does not have."""

    def __init__(self, run, state, model):
        block = run.summary.get(state, {})
        figures = block.get("deposition", {}).get(model) or {}
        self.lengths = {term["name"]: term["length"] for term in figures.get("distortion") or []}
        self.part, self.nodes = figures.get("displacement") or {}, figures.get("nodes") or {}

    def first(self, run):
        return self.lengths.get(f"objective_{run.distortion_term}")


def ratio(above, below):
    return above / below if above is not None and below else None


def sentence(term):
    """What a distortion term says, with a gap for how much less or more."""
    nodes, to = (str(term.get(key, "part")).replace("_", " ") for key in ("nodes", "to"))
    return {"shape": f"the shape of the {nodes} distorts {{}}", "flatness": f"the {nodes} deviates from a plane {{}}",
            "angle": f"the angle between {nodes} and {to} changes {{}}",
            "layerwise": "the part moves, layer by layer, {}"}.get(term.get("measure"), f"the {nodes} moves {{}}")


def headline(run):
    """One sentence: the binary layers against planar layers and the start, as ratios of lengths."""
    model, term = model_of(run), run.distortion_config
    lengths = {state: Figures(run, state, model).first(run) for state in STATES}
    planar, start = (ratio(lengths[state], lengths["binary"]) for state in ("baseline", "start"))
    if "simulated" in run.summary:
        rms, most = (quantity(run.summary["displacement"][key], run.unit) for key in ("rms", "max"))
        return f"{run_name(run).capitalize()}, as built: displaced by {rms} root mean square, {most} at most."
    if not planar:
        return f"{run_name(run).capitalize()}: {run.summary.get('status', 'no result yet').replace('_', ' ')}."
    words = f"{sentence(term).format(less(planar))} in planar layers"
    words += f", {less(start)} the unoptimized start" if start else ""
    notes = ["binary layers", MODELS[model], *["after release"] * bool(term.get("after_release"))]
    if term.get("aggregate", "nominal") != "nominal":
        notes.append(f"{term['aggregate']} over the scenarios")
    if misses_constraints(run):
        notes.append("constraints are not satisfied")
    return f"{words[0].upper()}{words[1:]} ({', '.join(notes)})."


def worst_case(run):
    """The worst ratio of sensitivity.json in words, or nothing."""
    worst = (run.sensitivity or {}).get("worst", {}).get("length")
    if not worst or worst.get("ratio") is None:
        return ""
    return f"Under the worst of the changes that were tried, {less(worst['ratio'])} in planar layers ({worst['change']})."


def summary_line(run):
    """Size, effort and end of a run, in a line."""
    told = facts(run)
    parts = [f"{run.summary['part_elements']:,} elements"] if "part_elements" in run.summary else []
    parts += [f"{len(run.layers('binary'))} layers"] if "binary" in run.summary else []
    parts += [f"{run.summary['iterations']} iterations"] if "iterations" in run.summary else []
    parts += [told["time"]] if "time" in told else []
    return "; ".join([*parts, told["status"]]) + "."


def thickness_span(run, state):
    values = [layer["thickness"] for layer in run.layers(state) if layer["thickness"] is not None]
    return (min(values), max(values)) if values else None


def band(constraint):
    return tuple(constraint["target"] * (1 + sign * constraint["tolerance"]) for sign in (-1, 1))


def violation(run, binary):
    """worst_miss() of the iterate that became the result: of its smooth or its binary layers."""
    best = next((line for line in run.history if line["iteration"] == run.summary.get("best_iteration")), None)
    if best is None or not run.config.get("constraints"):
        return None
    judged = best.get("binary") if binary else best
    return worst_miss(run, judged) if judged else None


def verdict(worst):
    """In words, of a worst_miss()."""
    if worst is None:
        return None
    return "satisfied" if worst <= 0 else f"violated by {100 * worst:.2g} %"


def facts(run):
    """What was run, as (name, words)."""
    config, summary = run.config, run.summary
    domain, seconds = config["domain"], summary.get("seconds", {}).get("total")
    spacing = [length / n for length, n in zip(domain["size"], domain["elements"])]
    elements = f", {summary['part_elements']:,} of them in the part" if "part_elements" in summary else ""
    reason = summary.get("reason")
    words = {
        "status": (summary.get("status", "going on or interrupted") + (f" ({reason})" if reason else "")).replace("_", " "),
        "part": part_words(config.get("part", {})),
        "box": f"{by(domain['size'])} {unit_of(run)}, {by(domain['elements'])} elements of {by(spacing)}{elements}",
        "layers": settings_words(config.get("layers", {})),
        "sequence": settings_words({key: value for key, value in config.get("sequence", {}).items() if key in SEQUENCE}),
        "process": f"{MODELS[model_of(run)]}, void {config.get('process', {}).get('void', 'absent')}",
        "inherent strain": strain_words(config.get("material", {})),
        "objective": "; ".join(map(objective_words, config.get("objective", []))),
        "constraints": "; ".join(map(settings_words, config.get("constraints", []))) or "none",
        "sharpness": f"{number(run.history[0]['beta'])} to {number(run.history[-1]['beta'])}" if run.history else None,
        "iterations": iteration_words(run),
        "time": effort_words(seconds, summary) if seconds is not None else None,
        "program": f"fabseq {config['run'].get('fabseq', '')}" if "run" in config else None}
    return {name: text for name, text in words.items() if text}


def effort_words(seconds, summary):
    ranks, memory = summary.get("ranks"), summary.get("peak_memory_bytes")
    words = [f"{duration(seconds)}{f' on {ranks} rank' + 's' * (ranks > 1) if ranks else ''}"]
    return ", ".join(words + [f"at most {memory / 2**30:.2g} GiB"] * bool(memory))


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


def settings_words(settings):
    """The type, and whatever else it has."""
    shown = {key: f"{value:.4g}" if isinstance(value, float) else str(value) for key, value in settings.items()}
    return " ".join(value if key == "type" else f"{key} {value}" for key, value in shown.items()).replace("_", " ")


def allowed_words(constraint):
    """Which values of a constraint, as summary.json has them, are allowed (docs/formulation.md 6 and 7)."""
    kind, tolerance, limit = constraint["type"], constraint.get("tolerance", 0.1), constraint.get("limit")
    if kind == "layer_thickness":
        return f"{1 - tolerance:g} to {1 + tolerance:g} of the target {constraint['target']:g}"
    if kind == "distortion" and limit is not None:
        return f"root up to {limit:g}"
    words = {"last_layer": "up to 0.25", "continuity": f"up to {limit}", "subpart_volume": f"up to {tolerance:g}",
             "deposition_speed": f"-{constraint.get('slack')} to 0", "minimum_layer_volume": "up to 0"}
    words |= {name: f"up to {limit}" for name in ("tool_clearance", "tilt", "local_thickness")}
    words["supported"] = "no element in the air" if limit in (None, "auto") else f"up to {limit}"
    return words.get(kind) or settings_words({**constraint, "type": ""}).strip()


def iteration_words(run):
    if "iterations" not in run.summary:
        return f"{len(run.history)} so far" if run.history else None
    coarse = run.summary.get("coarse_iterations")
    words = f"{run.summary['iterations']}{f' after {coarse} at half the resolution' if coarse else ''}"
    best = run.summary.get("best_iteration")
    return words + (f", the result is number {best}" if best is not None else "")


def run_name(run):
    return run.name.replace("_", " ")
