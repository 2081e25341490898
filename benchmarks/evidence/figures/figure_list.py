# SPDX-License-Identifier: MIT
"""The figures that stand on more than one page: results/figures.json."""

import json
import os
import re

from fabseq_tools.run.places import ROOT

PATH = os.path.join(ROOT, "benchmarks", "evidence", "results", "figures.json")


def read_figures():
    """A list of figures: "name", "what", "value" as the pages print it, "pages" [[page, text], ...],
    and either "by", what made it, or "run", from which fill_figures.py takes it: "study", "case", and
    "lengths": [numerator, denominator] or "worst": true."""
    with open(PATH, encoding="utf-8") as file:
        return json.load(file)


def write_figures(figures):
    with open(PATH, "w", encoding="utf-8") as file:
        json.dump(figures, file, ensure_ascii=False, indent=1)
        file.write("\n")


def faults(figures):
    """One line for each place where a page says another figure."""
    result = []
    for figure in figures:
        for page, around in figure["pages"]:
            text = around.replace("{}", figure["value"])
            if single_spaced(text) not in single_spaced(page_text(page)):
                result.append(f'{page}: found no "{text}"; {figure["name"]} is {figure["value"]}')
    return result


def page_text(page):
    with open(os.path.join(ROOT, page), encoding="utf-8") as file:
        return file.read()


def single_spaced(text):
    return re.sub(r"\s+", " ", text)
