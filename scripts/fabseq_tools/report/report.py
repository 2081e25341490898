# SPDX-License-Identifier: MIT
"""Writes a page about one or several runs for any browser: verdict, figures, places, the part in 3D.

    fabseq-tools report OUTPUT_DIR... [-o PAGE.html]

The page of one run goes to OUTPUT_DIR/report.html, that of several to report_compare.html in the first of
them. It is one file that loads nothing else and works without a server. Of a run of `-task optimize` or
`simulate` it begins with the answer: whether the layers can be built, at which places they cannot, and what
is gained over planar layers and the best alternative. Of one that is going on, was stopped or has failed it
shows settings and curves.
"""

import json
import lzma
import os
from html import escape
from string import Template

from fabseq_tools.report.answer import answer_section, look, pair_of
from fabseq_tools.report.charts import charts_of
from fabseq_tools.report.tables import comparison, constraints, facts_table, results, sensitivity
from fabseq_tools.report.torch_paths import SUMMARY as PATHS, paths
from fabseq_tools.report.tradeoff import find_tradeoffs, tradeoff_charts, tradeoff_tables
from fabseq_tools.report.views import packed_scene, views_of
from fabseq_tools.report.words import headline, model_of, run_name, states_of, summary_line, unit_of, worst_case
from fabseq_tools.run.check_words import check_sentences
from fabseq_tools.run.command_line import RunError, parser_of
from fabseq_tools.run.read_run import Run, read_fields, read_history, read_json
from fabseq_tools.run.settings import NOT_COMPARED, flat
from fabseq_tools.run.verdict_words import (answer_class, answer_words, gain_words, headline_sentences, missed_words,
                                            verdict_sentences, why_not)

COMMAND = "report"

PARTS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "page")


class ReportRun(Run):
    """Whatever an output directory holds: only config.json must be there. `sensitivity` and `paths` may be
    None. `tradeoffs`: records of the folder or the one above."""

    def __init__(self, directory):
        def optional(name, read, otherwise):
            return read(directory, name) if os.path.exists(os.path.join(directory, name)) else otherwise

        self.take(read_json(directory, "config.json"), optional("summary.json", read_json, {}),
                  optional("history.jsonl", lambda folder, _: read_history(folder), []),
                  optional("result.h5", lambda folder, name: read_fields(os.path.join(folder, name)), {}))
        self.sensitivity = optional("sensitivity.json", read_json, None)
        self.paths = optional(PATHS, read_json, None)
        self.tradeoffs = find_tradeoffs(directory)
        self.label = os.path.basename(os.path.abspath(directory))
        self.settings = settings_of(self.config)


def settings_of(config):
    """Values by path as of -set; lists of numbers in one piece."""
    settings = {}
    for key, value in flat({key: value for key, value in config.items() if key not in NOT_COMPARED}):
        names = key.split(".")
        whole = next((position for position in range(len(names)) if all(map(str.isdigit, names[position:]))), len(names))
        settings.setdefault(".".join(names[:whole]), []).append(value)
    return {key: values[0] if len(values) == 1 else values for key, values in settings.items()}


def page_of(runs):
    """The page as text."""
    shown = [(run, views_of(run, view_labels(run, runs)) if "density" in run.fields else []) for run in runs]
    scene, factors = packed_scene(shown)
    charts = charts_of(runs) + (tradeoff_charts(runs[0]) if len(runs) == 1 else [])
    pair = pair_of(runs[0], scene) if len(runs) == 1 else []
    data = {"unit": unit_of(runs[0]), "charts": charts, "scene": scene, "answer": {"views": pair}}
    title = f"{run_name(runs[0])}: report" if len(runs) == 1 else "Comparison of runs"
    return Template(read("page.html")).substitute(
        title=escape(title), style=read("page.css"), body=body_of(runs, pair, notes_of(runs, scene, factors)),
        data=json.dumps(data, separators=(",", ":")).replace("<", "\\u003c"), script=bundle())


def view_labels(run, runs):
    """Which states are shown in 3D: all of one run; of several the result of each."""
    if len(runs) > 1:
        return {state: run.label for state in ("binary", "simulated") if state in run.summary}
    return states_of(runs[0]) | ({"binary": "optimized"} if "binary" in runs[0].summary else {})


def bundle():
    """The page's script, of a packed file whose checksum is compared as it is unpacked."""
    path = os.path.join(PARTS, "bundle.js.xz")
    try:
        with lzma.open(path, "rt", encoding="utf-8") as file:
            return file.read()
    except (lzma.LZMAError, EOFError) as error:
        raise RunError(f"{path} is damaged: {error}") from error


def read(name):
    with open(os.path.join(PARTS, name), encoding="utf-8") as file:
        return file.read()


def body_of(runs, pair, notes):
    """The answer, and below it the other sections; charts and views are drawn into theirs by the script."""
    run, several = runs[0], len(runs) > 1
    first = comparison_head(runs) if several else answer_section(run, pair)
    lines = [f"<h1>{escape('Comparison of runs' if several else run_name(run))}</h1>", first]
    views = '<section id="viewer"></section>' + "".join(f'<p class="note">{escape(note)}</p>' for note in notes)
    sections = [("Conclusions", "" if several else sentences(run)),
                ("Figures", comparison(runs) if several else results(run)), ("Part and layers", views),
                ("Under other assumptions, binary layers", "" if several else sensitivity(run)),
                ("Trade-off, binary layers", "" if several else tradeoff_tables(run)),
                ("Constraints", "" if several else constraints(run)),
                ("Torch paths", "" if several else paths(run)), ("Curves", '<section id="charts"></section>'),
                ("What was run", facts_table(runs))]
    opened = " open" if several or not first else ""  # without an answer the rest is all there is
    return "\n".join(lines + [f"<details{opened}><summary>{title}</summary>{content}</details>"
                              for title, content in sections if content])


def comparison_head(runs):
    """A line for each run: what it comes to."""
    lines = []
    for run in runs:
        words, first = answer_words(run), [*headline_sentences(run), headline(run)][0]
        chip = f'<span class="chip {look(answer_class(run))}">{escape(words)}</span> ' if words else ""
        lines.append(f'<p class="headline"><b>{escape(run.label)}</b>: {chip}{escape(gain_words(run) or first)}</p>')
        lines += [f'<p class="worst">{escape(words)}</p>' for words in conclusions(run, True) if words]
    return "\n".join(lines)


def sentences(run):
    """What the program concludes, and how it ended."""
    first, *others = [*headline_sentences(run), headline(run)]
    lines = [f'<p class="headline">{escape(first)}</p>']
    lines += [f'<p class="worst">{escape(words)}</p>' for words in (*others, *conclusions(run, False)) if words]
    return "\n".join([*lines, f'<p class="note">{escape(summary_line(run))}</p>'])


def conclusions(run, several):
    """Sentences below the headline: of several runs only on what the run is about."""
    judged = why_not(run) if several else verdict_sentences(run, states_of(run))
    return [worst_case(run), missed_words(run), *judged, *check_sentences(run)]


def notes_of(runs, scene, factors):
    """What the views cannot show, and why."""
    notes = []
    if not scene["views"]:
        return ["There is no result.h5 with times and displacements to show."]
    if max(factors) > 1:
        notes.append(f"Drawn on a coarser grid, with blocks of {max(factors)} elements an edge, so that the page stays small.")
    if "displacement" in scene["fields"]:
        models = {model_of(run) for run in runs}
        model = f"{models.pop()} deposition" if len(models) == 1 else "each run's own model of deposition"
        released = any("released" in view for view in scene["views"])
        place = "on its plate, or of the released part where this is chosen" if released else "on its plate"
        notes.append(f"Displacements are those of the finished part {place} ({model}, binary layers where the file has "
                     "them), also while the slider shows the part half built.")
        if not released and any(term.get("after_release") for run in runs for term in run.config.get("objective", [])):
            notes.append("The objective measures the part after its release, which result.h5 does not hold.")
    return notes


def main(words):
    parser = parser_of(__doc__, COMMAND)
    parser.add_argument("directories", nargs="+", metavar="OUTPUT_DIR")
    parser.add_argument("-o", "--output", metavar="PAGE.html", help="where to write the page")
    arguments = parser.parse_args(words)
    name = "report_compare.html" if len(arguments.directories) > 1 else "report.html"
    path = arguments.output or os.path.join(arguments.directories[0], name)
    page = page_of([ReportRun(directory) for directory in arguments.directories])
    with open(path, "w", encoding="utf-8") as file:
        file.write(page)
    print(path)
