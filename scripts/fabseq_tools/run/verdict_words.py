# SPDX-License-Identifier: MIT
"""What the program concludes of a run (docs/reference.md, summary.json), in the words of all tools: whether
each sequence can be built, at which places it cannot, what is gained, and which constraint is missed. Empty
where a summary does not say."""

from fabseq_tools.run.check_words import result_of
from fabseq_tools.run.words import less, whole

CLASSES = "buildable", "buildable_but_for_places", "not_buildable"  # best first
NO_ALTERNATIVE = "no alternative of this class"
LOOKS = dict(zip(CLASSES, ("good", "places", "bad")))
COLOURS = dict(zip(CLASSES, ("#1a7f37", "#b26a00", "#c02626")))
# What the field `fault` of result.h5 says of an element, from 1 on: name in summary.json, words, colour.
FAULTS = (("hanging", "begins in the air", "#d81b1b"), ("local_thickness", "layer too thin or too thick", "#2166d8"),
          ("tilt", "torch tilted too far", "#e58a00"), ("blocked", "out of the torch's reach", "#8e24aa"))
GROUPS = {"binary": "", "simulated": "", "baseline": "planar/", "start": "start/", "baseline_even": "even/",
          "baseline_tilted": "tilted/"}  # of result.h5, by block of summary.json
TITLES = {"baseline": "planar layers", "baseline_even": "even layers", "baseline_tilted": "tilted planar layers",
          "baseline_matched": "as many planar layers", "start": "the start", "binary": "optimized", "simulated": "simulated"}


def verdict_of(block):
    """The verdict's object in a block of summary.json; empty without one."""
    return (block or {}).get("verdict") or {}


def verdict(run, state):
    return verdict_of(run.summary.get(state))


def class_of(found):
    """Of a verdict's object; None of what is not judged."""
    return found.get("class")


def rank(name):
    """For sorting by class, the best first."""
    return CLASSES.index(name) if name in CLASSES else len(CLASSES)


def in_short(found):
    """A verdict without its reasons, for tables: "buildable but for 2 places"; None where nobody knows."""
    return found["words"].partition(":")[0] if class_of(found) else None


def buildable(run, state):
    return in_short(verdict(run, state))


def verdict_lines(block):
    """A verdict and its places, as tools begin what they say of layers."""
    found = verdict_of(block)
    if not found:
        return ["not judged by this run"]
    return [found["words"], *(f"  {words}" for words in place_lines(block))]


def places(block):
    """Where layers cannot be built, the largest first."""
    return (block or {}).get("places") or []


def place_lines(block, most=10):
    """Of the largest places, and how many more there are."""
    found = places(block)
    left = max(block.get("places_in_all", 0), len(found)) - min(len(found), most) if found else 0
    return [place["words"] for place in found[:most]] + [f"and {left} more place{'s' * (left > 1)}"] * (left > 0)


def verdict_sentences(run, states):
    """Whether each can be built on the machine. `states`: words by state; the smooth layers never are."""
    return [f"{whole(words)[:-1]}: {verdict(run, state)['words']}." for state, words in states.items()
            if class_of(verdict(run, state)) and state != "optimized"]


def answer(run):
    """What the run comes to; empty where the summary does not say."""
    return run.summary.get("answer") or {}


def answer_class(run):
    """Of an optimization or a simulation; None where nobody knows."""
    return answer(run).get("class") or class_of(verdict(run, result_of(run)))


def alternative(run):
    """Block of the sequence that the answer is compared with: the best alternative, or else planar layers;
    None without any."""
    best = answer(run).get("best_alternative")
    return best["block"] if best else "baseline" if "baseline" in run.summary else None


def answer_words(run):
    """The verdict of the run's layers, as a title has it; nothing where nobody knows."""
    return whole(buildable(run, result_of(run)) or "")[:-1]


def gain_words(run):
    """A sentence on what is gained, where the run has an answer."""
    told = answer(run)
    if not told:
        return ""
    if told.get("gain") is None or not told.get("best_alternative"):
        return whole(NO_ALTERNATIVE)
    best = told["best_alternative"]
    title = best["title"] + ("" if best.get("class") == told.get("class") else f" ({class_words(best.get('class'))})")
    return f"The skin distorts {less(told['gain'])} in the best alternative, {title}."


def class_words(name):
    """A class alone, without the number of places."""
    return (name or "not judged").replace("_", " ")


def class_with_places(name, count):
    """A class as verdicts have it in short: "buildable but for 2 places"."""
    return f"buildable but for {count:,} place{'s' * (count != 1)}" if name == CLASSES[1] else class_words(name)


def why_not(run):
    """The reasons against the run's layers, a sentence each."""
    found = verdict(run, result_of(run))
    return [whole(reason["words"]) for reason in found.get("reasons", [])] if answer_class(run) == CLASSES[-1] else []


def answer_sentences(run):
    """What stands below the verdict: why not, and what is gained."""
    return [sentence for sentence in (*why_not(run), gain_words(run)) if sentence]


def headline_sentences(run):
    """The first is the headline."""
    return [whole(words) for words in run.summary.get("headline", {}).get("words", [])]


def misses_constraints(run):
    """Whether the result misses constraints. Smooth counts that adapt are stricter than the exact checks: of
    what can be built they say nothing."""
    if run.summary.get("feasible", True):
        return False
    return "violated" in run.summary or answer_class(run) != CLASSES[0]


def missed_words(run):
    """The constraint that the result misses by most."""
    missed = run.summary.get("violated")
    return whole(f"constraint {missed['words']}") if missed and not run.summary.get("feasible", True) else ""
