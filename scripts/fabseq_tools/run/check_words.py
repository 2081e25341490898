# SPDX-License-Identifier: MIT
"""What the findings of a sequence (docs/formulation.md 13.1) say: their sentences, as the program has written
them, and their figures, for the report and the overview."""

from fabseq_tools.run.read_run import bead_thickness, target_thickness
from fabseq_tools.run.words import number, whole

ANY_TILT = 180.0  # degrees: from here on tool.max_tilt is no limit
USUAL_RANGE = [0.5, 1.5]  # of tool.thickness


def torch(run, state, check):
    """What the check of that name, `blocked` or `tilt`, has found; empty without a torch."""
    return run.summary.get(state, {}).get("checks", {}).get(check) or {}


def check_sentences(run):
    """What findings say of the layers that the run is about (`words` of summary.json), beside headline and
    verdict; of stress where the config asks for it."""
    block = run.summary.get(result_of(run), {})
    real = block.get("real_layers")
    judged = [whole(told["words"]) for told in (real, real.get("lumping")) if told] if real else []
    told = [*run.summary.get("headline", {}).get("words", []),
            *(reason["words"] for reason in block.get("verdict", {}).get("reasons", []))]
    asked = run.config.get("output", {}).get("stress")
    return judged + [whole(words) for finding, sentences in block.get("words", {}).items()
                     if asked or finding != "stress" for words in sentences if words not in told]


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


def thickness_limits(run, real=False):
    """Between which local thicknesses a layer, or with `real` a real one, can be deposited, or None."""
    target = bead_thickness(run.config) if real else target_thickness(run.config)
    factors = run.config.get("tool", {}).get("thickness", USUAL_RANGE)
    return [factor * target for factor in factors] if target else None


def check_figures(run=None):
    """Rows of a table by heading, "" for the first ones: for each row's words a function from a run and the
    name of a state to its value, and one from the value to text or None."""
    limits = run and thickness_limits(run, real="real_layers" in run.summary.get(result_of(run), {}))
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
    """Simulations tell it without a yield stress, too."""
    block = run.summary.get(state, {})
    return (block.get("stress") or block.get("residual_stress") or {}).get("von_mises")
