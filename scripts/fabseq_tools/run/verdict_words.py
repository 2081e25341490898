# SPDX-License-Identifier: MIT
"""What the program concludes of a run (docs/reference.md, summary.json), for the report and the overview: the
headline, whether each sequence can be built, and which constraint is missed. Empty for results of older
programs, which do not say."""


def headline_sentences(run):
    """The first is the headline."""
    return [whole(words) for words in run.summary.get("headline", {}).get("words", [])]


def whole(words):
    return f"{words[:1].upper()}{words[1:]}."


def verdict(run, state):
    """The verdict's object in summary.json; empty without one."""
    return run.summary.get(state, {}).get("verdict") or {}


def buildable(run, state):
    """In one word, for tables; None where nobody knows."""
    found = verdict(run, state)
    return ("yes" if found["buildable"] else "no") if found else None


def verdict_sentences(run, states):
    """Whether each can be built on the machine. `states`: words by state; the smooth layers never are."""
    return [f"Buildable on this machine, {words}: {verdict(run, state)['words']}." for state, words in states.items()
            if verdict(run, state) and state != "optimized"]


def thickest_sentence(run, state):
    """The largest local thickness and its place, where some are out of range: a meeting of fronts is no
    layer."""
    found = run.summary.get(state, {}).get("checks", {}).get("local_thickness") or {}
    if not found.get("share_outside") or not found.get("largest_at"):
        return ""
    place = ", ".join(f"{x:.4g}" for x in found["largest_at"])
    size = "beyond all bounds" if found["largest"] is None else f"{found['largest']:.3g} {run.unit}".rstrip()
    what = ("fronts meet there and the gradient of the time vanishes, so it is no thick layer" if found["largest_is_meeting"]
            else "a thick layer")
    return f"The largest local thickness is {size} near [{place}]: {what}."


def missed_words(run):
    """The constraint that the result misses by most."""
    missed = run.summary.get("violated")
    return whole(f"constraint {missed['words']}") if missed and not run.summary.get("feasible", True) else ""
