# SPDX-License-Identifier: MIT
"""What the checks of a sequence (docs/formulation.md 13.1) say in words and figures, for the report and the
overview."""

from fabseq_tools.run.read_run import target_thickness
from fabseq_tools.run.words import alike, number, quantity

ANY_TILT = 180.0  # degrees: from here on tool.max_tilt is no limit
USUAL_RANGE = [0.5, 1.5]  # of tool.thickness


def hanging(run, state):
    """How many elements begin in the air; None where the file does not tell."""
    return run.summary.get(state, {}).get("checks", {}).get("hanging", {}).get("elements")


def torch(run, state, check):
    """What the check of that name, `blocked` or `tilt`, has found; empty without a torch."""
    return run.summary.get(state, {}).get("checks", {}).get(check) or {}


def check_sentences(run):
    """Sentences on a sequence that gains nothing, on elements that begin in the air or that the torch does
    not reach, on its tilt, and on stress beyond the yield stress."""
    # Headline and verdicts of newer programs say more.
    compared, judged = "headline" in run.summary, "verdict" in run.summary.get(result_of(run), {})
    words = [*([] if compared else [gain_words, planar_words]), *([] if judged else [hanging_words, reach_words, tilt_words]),
             stress_words]
    return list(filter(None, (each(run) for each in words)))


def gain_words(run):
    """Nothing where the sequence is better than planar layers."""
    if not {"baseline", "binary"} <= set(run.summary) or run.distortion_config.get("type") != "distortion":
        return ""
    planar, optimized = run.length("baseline"), run.length("binary")
    if optimized < planar and not alike(planar, optimized):
        return ""
    return ("For what is measured there is nothing to gain from the sequence here: planar layers do as well or better. A drawing "
            "that is scaled or compensated (fabseq-tools compensate) takes the distortion away.")


def planar_words(run):
    reasons = [words for words in (in_the_air(run, "baseline"), out_of_reach(run, "baseline")) if words]
    if not reasons:
        return ""
    return f"The planar layers cannot be built as they are: {'; '.join(reasons)}. So a comparison with them flatters."


def hanging_words(run):
    """Of the layers that the run is about: how many begin in the air, or none where that is news."""
    state = result_of(run)
    if hanging(run, state):
        return f"{in_the_air(run, state)}{', in the optimized layers' * (state == 'binary')}."
    if hanging(run, state) == 0 and (state == "simulated" or hanging(run, "baseline")):
        return f"No element{' of the optimized layers' * (state == 'binary')} begins in the air."
    return ""


def in_the_air(run, state):
    """How many elements begin in the air, and where; nothing if none does."""
    if not hanging(run, state):
        return ""
    count, place = hanging(run, state), near(run, run.summary[state]["checks"]["hanging"].get("at"))
    return f"{count:,} element{'s begin' if count > 1 else ' begins'} in the air{f', the first {place}' * bool(place)}"


def near(run, at):
    return f"near [{', '.join(f'{x:.6g}' for x in at)}]{f' {run.unit}' * bool(run.unit)}" if at else ""


def reach_words(run):
    """Of the layers that the run is about, where there is a torch."""
    state = result_of(run)
    count = torch(run, state, "blocked").get("elements")
    if count:
        return f"{out_of_reach(run, state)}{', in the optimized layers' * (state == 'binary')}."
    return f"The torch reaches all elements{' of the optimized layers' * (state == 'binary')}." if count == 0 else ""


def out_of_reach(run, state):
    """How many elements the torch does not reach, and where it is worst; nothing if it reaches all."""
    found = torch(run, state, "blocked")
    if not found.get("elements"):
        return ""
    many, place = found["elements"] > 1, near(run, found.get("at"))
    return (f"{found['elements']:,} element{'s are' if many else ' is'} out of the torch's reach, {'the worst ' * many}by "
            f"{quantity(found['deepest'], run.unit)}{f' {place}' * bool(place)}")


def tilt_words(run):
    state = result_of(run)
    found = torch(run, state, "tilt")
    if not found.get("beyond"):
        return ""
    return (f"The torch would tilt by more than {most_tilt(run)}, by {found['largest']:.3g} degrees at most, in "
            f"{percent(found['share'])} of the part{', with the optimized layers' * (state == 'binary')}.")


def tilt_limit(run):
    """In degrees; None where the machine may tilt as far as it likes."""
    limit = run.config.get("tool", {}).get("max_tilt", ANY_TILT)
    return limit if limit < ANY_TILT else None


def most_tilt(run=None):
    """With the figure, where the run has one."""
    limit = tilt_limit(run) if run else None
    return "its limit" if limit is None else f"{limit:g} degrees"


def largest_tilt(run, state):
    """In degrees, with a word where there is no limit that it could keep; None where nothing is known."""
    largest = torch(run, state, "tilt").get("largest")
    return largest if largest is None or tilt_limit(run) else f"{largest:.3g} (no limit)"


def share_beyond(run, state):
    """Of the part, with more tilt than the limit; None without one."""
    return torch(run, state, "tilt").get("share") if tilt_limit(run) else None


def stress_words(run):
    """Where the config asks for it: with a linear model it is beyond the yield stress nearly everywhere."""
    share, with_planar = (run.summary.get(state, {}).get("stress", {}).get("share_beyond_yield")
                          for state in (result_of(run), "baseline"))
    if share is None or not run.config.get("output", {}).get("stress"):
        return ""
    limit = yield_words(run)
    if share == 0:
        return f"The residual stress is nowhere above {limit}."
    planar = f" (with planar layers in {percent(with_planar)})" if with_planar is not None else ""
    return f"The residual stress is above {limit} in {percent(share)} of the part{planar}, where a linear model overstates it."


def yield_words(run=None):
    """With the figure, where the run has one."""
    stress = run.config.get("material", {}).get("yield_stress", "none") if run else "none"
    return "the yield stress" if stress == "none" else f"the yield stress {stress:g}"


def result_of(run):
    """The state that the run is about."""
    return "simulated" if "simulated" in run.summary else "binary"


def percent(share):
    """A share as percents; never 0 or 100 where it is not."""
    value = 100 * share
    return "less than 0.1 %" if 0 < value < 0.05 else "more than 99.9 %" if 99.95 <= value < 100 else f"{value:.1f} %"


def thickness_limits(run):
    """Between which local thicknesses a layer can be deposited; None without a target."""
    target = target_thickness(run.config)
    factors = run.config.get("tool", {}).get("thickness", USUAL_RANGE)
    return [factor * target for factor in factors] if target else None


def check_figures(run=None):
    """Rows of a table by heading, "" for the first ones: for each row's words a function from a run and the
    name of a state to its value, and one from the value to text or None."""
    limits = run and thickness_limits(run)
    span = " to ".join(map(number, limits)) if limits else "its range"
    limit = yield_words(run)
    thickness = ("checks", "local_thickness")
    return {"": {"local thickness, least": (of_state(*thickness, "least"), None),
                 "local thickness, largest": (of_state(*thickness, "largest"), None),
                 f"local thickness outside {span}, share of the part": (of_state(*thickness, "share_outside"), percent)},
            "Building": {"elements that begin in the air": (of_state("checks", "hanging", "elements"), None),
                         "build time, hours": (of_state("build_hours"), None),
                         "wire, kg": (of_state("wire_mass"), None)},
            "Torch": {"elements out of its reach": (of_state("checks", "blocked", "elements"), None),
                      "their share of the part": (of_state("checks", "blocked", "share"), percent),
                      "deepest collision": (of_state("checks", "blocked", "deepest"), None),
                      "largest tilt, degrees": (largest_tilt, None),
                      f"tilted by more than {most_tilt(run)}, share of the part": (share_beyond, percent)},
            "Residual stress": {"largest equivalent stress": (largest_stress, None),
                                "the same after the release": (of_state("released", "residual_stress", "von_mises"), None),
                                f"share of the part above {limit}": (of_state("stress", "share_beyond_yield"), percent)}}


def of_state(*names):
    """The function from a run and a state to what lies that deep in its block of the summary."""
    value = inner(*names)
    return lambda run, state: value(run.summary.get(state))


def inner(*names):
    """The function that takes what lies that deep in nested dictionaries; None where something is missing."""
    def value(block):
        for name in names:
            block = (block or {}).get(name)
        return block

    return value


def largest_stress(run, state):
    block = run.summary.get(state, {})
    return (block.get("stress") or block.get("residual_stress") or {}).get("von_mises")
