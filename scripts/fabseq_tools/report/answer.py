# SPDX-License-Identifier: MIT
"""What a report begins with: the verdict as a colour, three figures, the best alternative and the optimized
layers in 3D, and the places where they cannot be built."""

from html import escape

from fabseq_tools.geometry.grid import origin_of
from fabseq_tools.run import verdict_words as verdicts
from fabseq_tools.run.answer_figures import figures_of, skin_words
from fabseq_tools.run.check_words import result_of
from fabseq_tools.run.words import number

MOST_OF_ALTERNATIVE = 10  # places in the list
UNKNOWN = "unknown"       # look of what nobody has judged


def look(kind):
    return verdicts.LOOKS.get(kind, UNKNOWN)


def pair_of(run, scene):
    """What the page draws in its two views: the alternative, if it is stored, and the layers of the run;
    empty where no file says what is wrong with them."""
    stored = {view["state"]: number for number, view in enumerate(scene["views"]) if "fault" in view["ranges"]}
    ours = result_of(run)
    if ours not in stored:
        return []
    other = next((state for state in (verdicts.alternative(run), "baseline") if state in stored and state != ours), None)
    return [view_of(run, state, stored[state]) for state in (other, ours) if state]


def view_of(run, state, stored):
    block = run.summary[state]
    kind = verdicts.class_of(verdicts.verdict_of(block))
    return {"view": stored, "state": state, "title": title_of(run, state), "verdict": verdicts.buildable(run, state) or "",
            "look": look(kind), "places": [shown(run, place) for place in verdicts.places(block)]}


def title_of(run, state):
    if state == result_of(run):
        return "Optimized layers" if state == "binary" else "These layers"
    best = verdicts.answer(run).get("best_alternative") or {}
    return f"Best alternative: {best['title']}" if best.get("block") == state else verdicts.TITLES[state].capitalize()


def shown(run, place):
    """A place as the views need it: from the corner of the box."""
    origin = origin_of(run.config)
    colours = {name: colour for name, _, colour in verdicts.FAULTS}
    points = {key: [round(float(x - o), 6) for x, o in zip(place[key], origin)] for key in ("centre", "lower", "upper")}
    return {"kind": place["kind"], "layer": place["layer"], "words": place["words"], "colour": colours[place["kind"]], **points}


def answer_section(run, pair):
    """The first screen, as HTML; empty where nobody has judged the layers."""
    words = verdicts.answer_words(run)
    if not words:
        return ""
    kind = look(verdicts.answer_class(run))
    told = "".join(f'<p class="gain">{escape(sentence)}</p>' for sentence in verdicts.answer_sentences(run))
    lines = [f'<section id="answer" class="{kind}"><p class="verdict">{escape(words)}</p>{told}</section>',
             f'<section id="figures">{"".join(map(lambda one: card(run, one), figures_of(run)))}</section>',
             f'<p class="note">Large: root mean square of {skin_words(run)}, after the best rigid fit.</p>']
    if pair:
        lines.append(f'<section id="screen"><section id="pair"></section>{place_lists(run, pair)}</section>')
    return "\n".join(lines)


def card(run, figures):
    """One of the three figures."""
    unit = escape(run.unit)
    large = "" if figures.rms is None else (
        f'<p class="figure"><b title="{figures.rms!r}">{number(figures.rms)}</b> {unit}'
        + ("" if figures.largest is None else f' <span>largest {number(figures.largest)} {unit}</span>') + "</p>")
    verdict = f'<p class="{look(figures.kind)}">{escape(figures.verdict)}</p>' if figures.verdict else ""
    more = "".join(f"<div><dt>{escape(name)}</dt> <dd>{escape(text)}</dd></div>" for name, text in figures.more)
    return (f'<div class="card{" ours" * figures.is_ours}"><h3>{escape(figures.title)}</h3>{large}{verdict}'
            f'{f"<dl>{more}</dl>" if more else ""}</div>')


def place_lists(run, pair):
    """Ours first; a click on an entry turns the views to its place."""
    lists = []
    for number_of_view, view in reversed(list(enumerate(pair))):
        block = run.summary[view["state"]]
        most = len(view["places"]) if view["state"] == result_of(run) else MOST_OF_ALTERNATIVE
        entries = "".join(
            f'<li><button type="button" data-view="{number_of_view}" data-place="{place}" style="--pin: {found["colour"]}">'
            f'{escape(found["words"])}</button></li>' for place, found in enumerate(view["places"][:most]))
        left = block.get("places_in_all", 0) - min(len(view["places"]), most)
        entries += f'<li class="note">and {left:,} more</li>' * (left > 0)
        count = block.get("places_in_all", 0)
        name = title_of(run, view["state"]).removeprefix("Best alternative: ").capitalize()
        title = f"{name}: {count:,} place{'s' * (count != 1)}" if count else f"{name}: can be built everywhere"
        lists.append(f"<h3>{escape(title)}</h3>{f'<ol>{entries}</ol>' if entries else ''}")
    return f'<aside id="places">{"".join(lists)}</aside>'
