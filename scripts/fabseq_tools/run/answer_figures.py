# SPDX-License-Identifier: MIT
"""What the answer of a run is made of, in figures: today's planar layers, the best alternative and the
optimized layers side by side."""

import dataclasses

from fabseq_tools.run import verdict_words as verdicts
from fabseq_tools.run.check_words import result_of
from fabseq_tools.run.words import number, quantity, whole


@dataclasses.dataclass
class Figures:
    """Of one sequence: `rms` and `largest` of the skin's deviation, None where nobody knows; `more`: pairs of
    a name and a text; `kind`: its class; `verdict`: in short. `is_ours`: the layers that the run is about."""

    title: str
    kind: str = None
    verdict: str = ""
    rms: float = None
    largest: float = None
    more: list = dataclasses.field(default_factory=list)
    is_ours: bool = False


def figures_of(run):
    """Today's way, the best alternative, ours. Less where two are the same, or where a file lacks them; none
    where no figure is known."""
    ours, best = result_of(run), verdicts.answer(run).get("best_alternative")
    found = []
    if "baseline" in run.summary:
        same = best and best["block"] == "baseline"
        found.append(of_block(run, "baseline", f"Planar layers, as today{', and the best alternative' * bool(same)}"))
    if best and best["block"] != "baseline":
        found.append(of_block(run, best["block"], f"Best alternative: {best['title']}", best))
    elif not best and verdicts.answer(run):
        found.append(Figures(whole(verdicts.NO_ALTERNATIVE)[:-1], more=list(refused(run))))
    if ours in run.summary:
        title = "Optimized layers" if ours == "binary" else "These layers"
        found.append(of_block(run, ours, title, verdicts.answer(run), is_ours=True))
    return found if any(one.rms is not None or one.verdict for one in found) else []


def refused(run):
    """The other sequences that the run has compared with, and why they are no alternative."""
    for state in ("baseline_even", "baseline_tilted"):
        if verdicts.buildable(run, state):
            rms = skin_of(run, run.summary[state]).get("rms")
            words = [verdicts.buildable(run, state)] + [quantity(rms, run.unit)] * (rms is not None)
            yield f"{verdicts.TITLES[state]}:", ", ".join(words)


def of_block(run, state, title, told=None, is_ours=False):
    """`told`: what the answer says of it, which comes before the block's own figures."""
    block, told = run.summary.get(state, {}), told or {}
    skin, kind = skin_of(run, block), verdicts.class_of(verdicts.verdict_of(block)) or told.get("class")
    return Figures(title, kind, verdicts.buildable(run, state) or "", told.get("rms", skin.get("rms")),
                   told.get("largest", skin.get("max")), list(more_of(run, state)), is_ours)


def is_released(run):
    """Whether the answer is of the part after its release."""
    released = verdicts.answer(run).get("released")
    return bool(run.distortion_config.get("after_release")) if released is None else released


def skin_of(run, block):
    finished = block.get("finished", {})
    return (finished.get("released" if is_released(run) else "as_built") or {}).get("skin") or {}


def skin_words(run):
    """What rms and largest measure."""
    return f"the skin's deviation from the drawing, {'after the release' if is_released(run) else 'as built'}"


def more_of(run, state):
    """Layers, hours, tilt, thickness: what is known."""
    block = run.summary.get(state, {})
    checks = block.get("checks") or {}
    if block.get("layers"):
        yield "layers", f"{len(run.layers(state))}"
    thickness = checks.get("local_thickness") or {}
    if thickness.get("least") is not None:
        largest = thickness.get("largest")
        ends = dict.fromkeys([number(thickness["least"]), "no end" if largest is None else number(largest)])
        yield "thickness", f"{' to '.join(ends)} {run.unit}".rstrip()
    tilt = (checks.get("tilt") or {}).get("largest")
    if tilt is not None:
        yield "largest tilt", f"{number(tilt)}°"
    hours = block.get("build_hours")
    if hours is not None:
        yield "build time", quantity(hours, "h")
    if state == "binary" and verdicts.answer(run).get("repaired"):
        yield "repaired", f"{verdicts.answer(run)['repaired']:,}"
