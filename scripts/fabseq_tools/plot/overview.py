# SPDX-License-Identifier: MIT
"""Draws a finished run as one picture: layers, distorted shapes and curves.

    fabseq-tools overview OUTPUT_DIR [PICTURE.png] [--table]

OUTPUT_DIR is the output directory of a run with `-task optimize` or `simulate`; the picture goes to
OUTPUT_DIR/overview.png unless said otherwise. `--table` also prints the main figures. Of an optimization
the picture shows layers and distortion beside those of planar layers, and how it got there; of a simulation
its layers, and the distorted shape as built and released. Without a display it is drawn in memory.
"""

import os
from functools import partial

from fabseq_tools.plot import overview_charts as charts
from fabseq_tools.plot.drawing import INK, OPTIMIZED, PLANAR
from fabseq_tools.plot.overview_pictures import Pictures
from fabseq_tools.plot.overview_sheet import draw_sheet
from fabseq_tools.plot.virtual_display import ensure_display
from fabseq_tools.run.check_words import check_sentences, failing_elements, out_of_thickness, result_of
from fabseq_tools.run.command_line import parser_of
from fabseq_tools.run.read_run import Run
from fabseq_tools.run.verdict_words import headline_sentences, missed_words, thickest_sentence, verdict_sentences
from fabseq_tools.run.words import alike, duration, factor, quantity

COMMAND = "overview"


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
    pictures = pictures_of(run)
    kinds, colours = ("planar", "optimized"), (PLANAR, OPTIMIZED)
    words = [f"{kind}, {len(run.layers(block))} layers" for kind, block in zip(kinds, ("baseline", "optimized"))]
    kinds = [kind + ", released" * is_released(run) for kind in kinds]
    words += [f"{kind}, moved by up to {quantity(length, run.unit)}" for kind, length in zip(kinds, pictures.largest_each)]
    constrained = run.config.get("constraints") and any(line["worst_constraint"] is not None for line in run.history)
    plots = [charts.plot_distortion] + [charts.plot_violation] * bool(constrained)
    plots += [charts.plot_layers] * any(layer["thickness"] is not None for layer in run.layers("optimized"))
    draw_sheet(path, title(run), sentences(run), pictures, [*zip(words, 2 * colours)],
               [partial(plot, run=run) for plot in plots], run.unit)


def title(run):
    """What the program concludes; of results of older programs, the distortion beside planar layers'."""
    concluded = run.summary.get("headline", {}).get("words")
    if concluded:
        return f"{title_name(run)}: {concluded[0]}"
    nodes = run.distortion_config.get("nodes")
    place = f" of the {nodes.replace('_', ' ')}" if nodes else ""
    return f"{title_name(run)}: distortion{place} {compared(run.length('baseline'), run.length('binary'))} with planar layers"


def pictures_of(run):
    """Planar beside optimized: two pictures of layers, two of the distorted shape with binary layers. That is
    the released one where the headline is of it."""
    fields, moved = run.fields, [shape_of(run, group) for group in ("planar/", optimized_group(run))]
    return Pictures(run, [fields["planar/layer"], fields["layer"]], moved,
                    *([find(run, group) for group in ("planar/", "")] for find in (failing_elements, out_of_thickness)))


def optimized_group(run):
    return "binary/" if "binary/displacement" in run.fields else ""


def is_released(run):
    """Whether the headline is of the released part, and the file has its shape."""
    return bool(run.distortion_config.get("after_release")) and all(
        group + "release_displacement" in run.fields for group in ("planar/", optimized_group(run)))


def shape_of(run, group):
    displacement = run.fields[group + "displacement"]
    return displacement + run.fields[group + "release_displacement"] if is_released(run) else displacement


def title_name(run):
    name = run.name.replace("_", " ")
    return f"{name[:1].upper()}{name[1:]}"


def compared(planar, other):
    """How a distortion compares with another one, which is named next."""
    if alike(planar, other):
        return "about as large as"
    return f"{factor(planar / other)} times smaller than" if other <= planar else f"{factor(other / planar)} times larger than"


def sentences(run):
    """What stands below the headline of an optimization."""
    length = {block: quantity(run.length(block), run.length_unit())
              for block in ("baseline", "start", "optimized", "binary") if block in run.summary}
    start = f", not optimized {length['start']}" if "start" in length else ""
    unmet = "" if run.summary.get("feasible", True) else f"  {missed_words(run) or 'Not all constraints are satisfied.'}"
    states = {"start": "start", "baseline": "planar", "baseline_tilted": "planar, tilted", "baseline_even": "even layers",
              "binary": "optimized"}
    return [*headline_sentences(run)[1:],
            f"Distortion ({run.measure()}): planar {length['baseline']}{start}, optimized {length['binary']} "
            f"(with smooth layers {length['optimized']}).",
            f"{elements(run)}, {len(run.layers('optimized'))} layers, "
            f"{run.summary['iterations']} iterations in {duration(run.summary['seconds']['total'])}.{unmet}",
            *verdict_sentences(run, states), *filter(None, [thickest_sentence(run, result_of(run))]),
            *check_sentences(run)]


def elements(run):
    return f"{int((run.fields['density'] > 0).sum()):,} elements"


def draw_simulation(run, path):
    moved = {"as built": run.fields["displacement"]}
    if "release_displacement" in run.fields:
        moved["released"] = moved["as built"] + run.fields["release_displacement"]
    pictures = Pictures(run, [run.fields["layer"]], list(moved.values()), [failing_elements(run, "")],
                        [out_of_thickness(run, "")])
    labels = [(f"{len(run.layers('simulated'))} layers", INK)]
    labels += [(f"{state}, moved by up to {quantity(length, run.unit)}", colour)
               for state, length, colour in zip(moved, pictures.largest_each, (INK, OPTIMIZED))]
    plots = [charts.plot_motion] + [partial(charts.plot_layers, block="simulated")] * any(
        layer["thickness"] is not None for layer in run.layers("simulated"))
    draw_sheet(path, f"{title_name(run)}, as built: displaced by {size_words(run.summary, run)}", simulation_sentences(run),
               pictures, labels, [partial(plot, run=run) for plot in plots], run.unit)


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
            *verdict_sentences(run, {"simulated": "these layers"}), *check_sentences(run)]


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
