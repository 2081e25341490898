# SPDX-License-Identifier: MIT
"""Draws a finished run as one picture: whether it can be built, where it cannot, and what it gains.

    fabseq-tools overview OUTPUT_DIR [PICTURE.png] [--table]

OUTPUT_DIR is the output directory of a run with `-task optimize` or `simulate`; the picture goes to
OUTPUT_DIR/overview.png unless said otherwise. `--table` also prints the main figures. The colour of the title
is the verdict: green can be built, amber but for the places that are numbered, red cannot. Of an optimization
the picture shows planar layers, the best alternative and the optimized layers in figures, the latter two as
layers, with what cannot be built in colour; smaller the distorted shapes and how the run got there. Of a
simulation it shows its layers, and the distorted shape as built and released. Without a display it is drawn
in memory.
"""

import os
from functools import partial

from fabseq_tools.plot import overview_charts as charts
from fabseq_tools.plot.drawing import INK, OPTIMIZED, PLANAR
from fabseq_tools.plot.overview_pictures import Layers, Shapes
from fabseq_tools.plot.overview_sheet import Content, draw_sheet
from fabseq_tools.plot.virtual_display import ensure_display
from fabseq_tools.run import verdict_words as verdicts
from fabseq_tools.run.answer_figures import figures_of, skin_words
from fabseq_tools.run.check_words import check_sentences, result_of
from fabseq_tools.run.command_line import parser_of
from fabseq_tools.run.read_run import Run
from fabseq_tools.run.words import alike, duration, factor, quantity

COMMAND = "overview"

MOST_LINES = 6  # of places


def main(words):
    parser = parser_of(__doc__, COMMAND)
    parser.add_argument("directory", metavar="OUTPUT_DIR")
    parser.add_argument("picture", metavar="PICTURE.png", nargs="?")
    parser.add_argument("--table", action="store_true", help="print the main figures")
    arguments = parser.parse_args(words)
    run = Run(arguments.directory, simulations=True)
    ensure_display()
    path = arguments.picture or os.path.join(arguments.directory, "overview.png")
    (draw_simulation if "simulated" in run.summary else draw_optimization)(run, path)
    if arguments.table:
        print(table(run))


def draw_optimization(run, path):
    states = compared_states(run)
    names = verdicts.TITLES[states[0]], "optimized layers"
    layers, shapes = pictures_of(run)
    labels = [f"{name}{', released' * is_released(run)}: moved by up to {quantity(length, run.unit)}"
              for name, length in zip(names, shapes.largest_each)]
    plots = [charts.plot_distortion]
    plots += [charts.plot_layers] * any(layer["thickness"] is not None for layer in run.layers("optimized"))
    draw_sheet(path, Content(title(run), verdicts.answer_class(run), verdicts.answer_sentences(run), figures_of(run),
                             [caption(run, state) for state in states], numbered(run, "binary"),
                             list(zip(labels, (PLANAR, OPTIMIZED))), [partial(plot, run=run) for plot in plots], run.unit,
                             skin_words(run), sentences(run)), layers, shapes)


def compared_states(run):
    return alternative_of(run), "binary"


def pictures_of(run):
    """Layers and distorted shapes of the alternative and of the optimized sequence."""
    states = compared_states(run)
    moved = [shape_of(run, group) for group in (verdicts.GROUPS[states[0]], optimized_group(run))]
    return (Layers(run, [verdicts.GROUPS[state] for state in states],
                   [verdicts.places(run.summary[state]) for state in states]), Shapes(run, moved))


def alternative_of(run):
    """The alternative, if result.h5 has its layers and displacements, or else planar layers."""
    found = verdicts.alternative(run)
    group = verdicts.GROUPS.get(found)
    return found if group is not None and {group + "layer", group + "displacement"} <= set(run.fields) else "baseline"


def caption(run, state):
    """Title of a picture of layers, the verdict in short, and its class."""
    names = {"binary": "Optimized layers", "simulated": "These layers"}
    best = verdicts.answer(run).get("best_alternative") or {}
    name = f"Best alternative: {best['title']}" if best.get("block") == state else verdicts.TITLES[state].capitalize()
    found = verdicts.verdict(run, state)
    return names.get(state, name), verdicts.in_short(found) or "", verdicts.class_of(found)


def numbered(run, state):
    """A line for each of the largest places, with the number that it has in the picture."""
    block = run.summary[state]
    found = verdicts.place_lines(block, MOST_LINES)
    count = min(len(verdicts.places(block)), MOST_LINES)
    return [f"{number}   {words}" if number <= count else words for number, words in enumerate(found, start=1)]


def title(run):
    """The verdict; of results that do not say, the distortion beside planar layers'."""
    if verdicts.answer_words(run):
        return f"{title_name(run)}: {verdicts.buildable(run, result_of(run))}"
    nodes = run.distortion_config.get("nodes")
    place = f" of the {nodes.replace('_', ' ')}" if nodes else ""
    return f"{title_name(run)}: distortion{place} {compared(run.length('baseline'), run.length('binary'))} planar layers"


def optimized_group(run):
    return "binary/" if "binary/displacement" in run.fields else ""


def is_released(run):
    """Whether the distortion is of the released part, and the file has its shape."""
    groups = verdicts.GROUPS[alternative_of(run)], optimized_group(run)
    return bool(run.distortion_config.get("after_release")) and all(
        group + "release_displacement" in run.fields for group in groups)


def shape_of(run, group):
    displacement = run.fields[group + "displacement"]
    return displacement + run.fields[group + "release_displacement"] if is_released(run) else displacement


def title_name(run):
    name = run.name.replace("_", " ")
    return f"{name[:1].upper()}{name[1:]}"


def compared(planar, other):
    """How a distortion compares with another one, which is named next."""
    if alike(planar, other):
        return "about as large as with"
    return (f"{factor(planar / other)} times smaller than with" if other <= planar else
            f"{factor(other / planar)} times larger than with")


def sentences(run):
    """What stands small at the end of an optimization's sheet."""
    length = {block: quantity(run.length(block), run.length_unit())
              for block in ("baseline", "start", "optimized", "binary") if block in run.summary}
    start = f", not optimized {length['start']}" if "start" in length else ""
    unmet = f"  {verdicts.missed_words(run) or 'Not all constraints are satisfied.'}" if verdicts.misses_constraints(run) else ""
    return [f"Distortion ({run.measure()}): planar {length['baseline']}{start}, optimized {length['binary']} "
            f"(with smooth layers {length['optimized']}).",
            f"{elements(run)}, {run.summary['iterations']} iterations in {duration(run.summary['seconds']['total'])}.{unmet}",
            *check_sentences(run)]


def elements(run):
    return f"{int((run.fields['density'] > 0).sum()):,} elements"


def draw_simulation(run, path):
    moved = {"as built": run.fields["displacement"]}
    if "release_displacement" in run.fields:
        moved["released"] = moved["as built"] + run.fields["release_displacement"]
    shapes = Shapes(run, list(moved.values()))
    layers = Layers(run, [""], [verdicts.places(run.summary)])
    labels = [(f"{state}: moved by up to {quantity(length, run.unit)}", colour)
              for state, length, colour in zip(moved, shapes.largest_each, (INK, OPTIMIZED))]
    plots = [charts.plot_motion] + [partial(charts.plot_layers, block="simulated")] * any(
        layer["thickness"] is not None for layer in run.layers("simulated"))
    known = verdicts.buildable(run, "simulated")
    draw_sheet(path, Content(f"{title_name(run)}: {known or f'as built displaced by {size_words(run.summary, run)}'}",
                             verdicts.answer_class(run), verdicts.answer_sentences(run), figures_of(run),
                             [caption(run, "simulated")], numbered(run, "simulated"), labels,
                             [partial(plot, run=run) for plot in plots], run.unit, skin_words(run),
                             simulation_sentences(run)), layers, shapes)


def size_words(block, run):
    size = block["displacement"]
    return f"{quantity(size['rms'], run.unit)} root mean square, {quantity(size['max'], run.unit)} at most"


def simulation_sentences(run):
    """What stands below the headline of a simulation."""
    released = run.summary.get("released")
    after = f"Displacement after the release: {size_words(released, run)}." if released else "There is no shape after a release."
    known = run.distortion_config.get("type") == "distortion"
    distortion = f"  Distortion ({run.measure()}): {quantity(run.length('simulated'), run.length_unit())}." if known else ""
    return [f"{after}{distortion}",
            f"{elements(run)}, {len(run.layers('simulated'))} layers, {duration(run.summary['seconds']['total'])}.",
            *check_sentences(run)]


def table(run):
    """The main figures of a run, planar beside optimized, as lines of text."""
    names = {"baseline": "planar", "start": "start, binary", "optimized": "optimized, smooth", "binary": "optimized, binary",
             "simulated": "simulated"}
    blocks = [block for block in names if block in run.summary]
    constraint = run.thickness_constraint()
    unit = constraint["target"] if constraint else 1.0

    def span(block):
        values = [layer["thickness"] / unit for layer in run.layers(block) if layer["thickness"] is not None]
        return f"{min(values):.2f} .. {max(values):.2f}" if values else "-"

    rows = {f"lengths in {run.unit}" if run.unit else "": (names[block] for block in blocks),
            "distortion": (f"{run.distortion(block):.3e}" for block in blocks),
            "length": (f"{run.length(block):.3e}" for block in blocks),
            "planar / this": (factor(run.length("baseline") / run.length(block)) for block in blocks),
            "largest displacement": (f"{run.summary[block]['displacement']['max']:.3e}" for block in blocks),
            "thickness" + " / target" * bool(constraint): map(span, blocks),
            "layers used": (len(run.layers(block)) for block in blocks)}
    if "baseline" not in blocks:
        del rows["planar / this"]
    lines = [f"{name:<22}" + "".join(f"{cell:>20}" for cell in cells) for name, cells in rows.items()]
    seconds = run.summary["seconds"]["total"]
    iterations = f"{run.summary['iterations']} iterations, " if "iterations" in run.summary else ""
    return "\n".join([*lines, f"{iterations}{seconds:.{0 if seconds >= 10 else 1}f} seconds"])
