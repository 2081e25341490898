# SPDX-License-Identifier: MIT
"""Pages of the published cases. results/cases/cases.csv holds the figures. From it, from the list of cases
and from the pictures beside it, the marked parts of these pages are made:

    cases.md            <!-- cases --> ... <!-- end of cases -->: a row per case
    results/cases/*.md    <!-- cases of SOURCE, SOURCE --> ... : what all cases of these sources come to

A page takes the cases whose source is one of those that it names, or a section of it. What stands outside the
marks is written by hand and stays as it is. figures/reproduce.py calls this.
"""

import contextlib
import csv
import fcntl
import glob
import os
import re
import textwrap

from fabseq_tools.run.command_line import RunError
from case_figures import COLUMNS, LENGTHS, TARGETS, factor, number

OVERVIEW = re.compile(r"<!-- (cases) -->\n(.*?)<!-- end of cases -->", re.DOTALL)
GALLERY = re.compile(r"<!-- cases of ([^>]*) -->\n(.*?)<!-- end of cases -->", re.DOTALL)
WIDTH = 110
VANISHED = 1e6  # a factor beyond which there is no distortion to speak of
NOTE = ("A factor above 1e6 stands as > 1e6: the distortion has vanished, because the optimizer can drive a functional of "
        "a few nodes to zero. How small it is says nothing.")


class Pages:
    """The overview, and beside it in results/cases the table of figures, the galleries and the pictures."""

    def __init__(self, overview, cases):
        """`cases`: by name, in order (reproduce.Cases)."""
        self.overview, self.cases = overview, cases
        self.folder = os.path.join(os.path.dirname(os.path.abspath(overview)), "results", "cases")
        self.table = os.path.join(self.folder, "cases.csv")

    def picture(self, name):
        return os.path.join(self.folder, name + ".png")

    def record(self, name, rows):
        """Puts the rows of a case in place of those in the table, and writes the pages."""
        with self.locked() as kept:
            self.write([*(row for row in kept if row["case"] != name), *rows])

    def write_again(self):
        with self.locked() as rows:
            self.write(rows)

    @contextlib.contextmanager
    def locked(self):
        """The rows of the table. Several programs may record a case at a time."""
        with open(self.table, "a+", encoding="utf-8", newline="") as file:
            fcntl.flock(file, fcntl.LOCK_EX)
            file.seek(0)
            yield list(csv.DictReader(file))

    def write(self, rows):
        order = {name: number for number, name in enumerate(self.cases.table)}
        unknown = [row["case"] for row in rows if row["case"] not in order]
        if unknown:
            raise RunError(f"{self.table}: {unknown[0]} is none of the cases")
        rows = sorted(rows, key=lambda row: (order[row["case"]], int(row.get("cut_into") or 0)))
        pages = self.pages(rows)
        write_table(self.table, rows)
        for path, text in pages.items():
            with open(path, "w", encoding="utf-8") as file:
                file.write(text)

    def pages(self, rows):
        """Text by path. Every case is on one of the galleries."""
        with open(self.overview, encoding="utf-8") as file:
            overview = file.read()
        galleries, page_of = {}, {}
        for path in sorted(glob.glob(os.path.join(self.folder, "*.md"))):
            with open(path, encoding="utf-8") as file:
                text = file.read()
            found = GALLERY.search(text)
            if not found:
                raise RunError(f"{path}: has no line '<!-- cases of SOURCE -->' with '<!-- end of cases -->' below it")
            sources = [source.strip() for source in found[1].split(",")]
            own = [row for row in rows if any(is_of(self.cases[row["case"]]["source"], source) for source in sources)]
            twice = [row["case"] for row in own if row["case"] in page_of]
            if twice:
                raise RunError(f"{path}: {twice[0]} is on another page, too")
            page_of |= {row["case"]: path for row in own}
            galleries[path] = with_part(text, found, self.gallery(own))
        lost = [row["case"] for row in rows if row["case"] not in page_of]
        if lost:
            raise RunError(f"{lost[0]}: no page of {self.folder} names the source {self.cases[lost[0]]['source']}")
        found = OVERVIEW.search(overview)
        if not found:
            raise RunError(f"{self.overview}: has no line '<!-- cases -->' with '<!-- end of cases -->' below it")
        links = {name: os.path.relpath(path, os.path.dirname(os.path.abspath(self.overview))) for name, path in page_of.items()}
        return {**galleries, self.overview: with_part(overview, found, self.summary(rows, links))}

    def summary(self, rows, links):
        """The table of the overview."""
        cells = [[f"[{row['case']}]({links[row['case']]})", published_factor(self.cases[row["case"]], row),
                  *(shown(row[key]) for key in ("smooth_factor", "binary_factor", "nominal_factor")), row["constraints"]]
                 for row in map(complete, rows) if not row["cut_into"]]
        return "\n".join(table(["case", "published", "smooth", "binary", "nominal", "constraints"], cells, whole=True))

    def gallery(self, rows):
        """What a page has of its cases: what they are, tables, pictures."""
        rows = list(map(complete, rows))
        whole = [row for row in rows if not row["cut_into"]]
        parts = ["\n".join(self.description(row) for row in whole),
                 *table(["case", "published", "planar", "smooth", "binary"],
                        [[label(row), published(self.cases[row["case"]], row), row["planar"], with_factor(row, "smooth"),
                          with_factor(row, "binary")] for row in rows],
                        "Distortion, and behind the colon how many times less than in planar layers it is:")]
        if any(float(row[key] or 0) > VANISHED for row in rows for key in ("smooth_factor", "binary_factor", "nominal_factor")):
            parts.append("\n".join(textwrap.wrap(NOTE, WIDTH)))
        parts += table(["case", "nominal: planar → binary", "constraints", "print angles", "interior minima"],
                       [[row["case"], nominal(row), row["constraints"], row["print_angles"], row["interior_minima"]]
                        for row in whole])
        for unit, caption in (TARGETS, "Thickness of layers, relative to the target:"), (LENGTHS, "Thickness of layers:"):
            parts += table(["case", "smooth", "binary", "geometric"],
                           [[label(row), *(row["thickness_" + kind] for kind in ("smooth", "binary", "geometric"))]
                            for row in rows if row["thickness_in"] == unit], caption)
        pictures = [row["case"] for row in whole if os.path.exists(self.picture(row["case"]))]
        parts += [f"`{name}`:\n\n![layers and distorted shapes, planar and optimized]({name}.png)" for name in pictures]
        return "\n\n".join(parts)

    def description(self, row):
        case = self.cases[row["case"]]
        note = f"; {case['note']}" if "note" in case else ""
        return textwrap.fill(f"- `{row['case']}`: {case['what']} [{case['source']}]{note}; {row['run']}.", WIDTH,
                             subsequent_indent="  ", break_on_hyphens=False)


def is_of(source, wanted):
    """Whether a source is the wanted one, or a section of it."""
    return source == wanted or re.match(re.escape(wanted) + r"(\W|$)", source) is not None


def with_part(text, found, part):
    return f"{text[:found.start(2)]}{part}\n{text[found.end(2):]}"


def write_table(path, rows):
    with open(path, "w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, restval="", lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def complete(row):
    return {column: row.get(column, "") for column in COLUMNS}


def table(head, rows, caption=None, whole=False):
    """Caption, if any, and table, without columns that have no entry unless told to be whole; neither if all
    are empty. A dash stands for what is not there."""
    used = [0, *(column for column in range(1, len(head)) if whole or any(row[column] for row in rows))]
    if len(used) == 1:
        return []
    lines = [head, ["---"] * len(head), *([cell or "–" for cell in row] for row in rows)]
    text = "\n".join("| " + " | ".join(line[column] for column in used) + " |" for line in lines)
    return [caption, text] if caption else [text]


def label(row):
    return f"{row['case']}, cut into {row['cut_into']}" if row["cut_into"] else row["case"]


def shown(text):
    """A factor, as it is printed."""
    return "> 1e6" if text and float(text) > VANISHED else text


def with_factor(row, kind):
    return f"{row[kind]}: {shown(row[kind + '_factor'])}" if row[kind] else ""


def nominal(row):
    if not row["binary_nominal"]:
        return row["planar_nominal"]
    return f"{row['planar_nominal']} → {row['binary_nominal']}: {shown(row['nominal_factor'])}"


def published_values(case, row):
    figures = case.get("published", {})
    return figures.get("planar"), figures.get("resliced" if row["cut_into"] else "optimized")


def published_factor(case, row):
    planar, best = published_values(case, row)
    return factor(planar / best) if planar and best else ""


def published(case, row):
    planar, best = published_values(case, row)
    if planar is None and best is None:
        return ""
    text = " → ".join("–" if value is None else number(value) for value in (planar, best))
    return text + (f": {published_factor(case, row)}" if planar and best else "")
