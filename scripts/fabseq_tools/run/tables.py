# SPDX-License-Identifier: MIT
"""Tables of numbers (CSV) with named columns, as programs and spreadsheets write them: cells apart by comma,
semicolon, tab or blanks, decimals after a point or, unless commas part the cells, a comma; UTF-8 or UTF-16,
or the encoding of Windows; units in the first line, such as "x [mm]". The first line may begin with // or,
before numbers, with #."""

import copy
import csv
import re

import numpy as np

from fabseq_tools.run.command_line import RunError

ALLOWED = "a table (CSV) whose first line names the columns, as UTF-8 or UTF-16"
NO_TEXT = re.compile("[\x00-\x08\x0b\x0e-\x1f]")
UNIT = re.compile(r"^(.*?)\s*[\[(]\s*([^\])]*?)\s*[\])]$")  # of a column: x [mm]
BLANKS = " "  # any number of them
DECIMAL_COMMA = re.compile(r"[+-]?(\d+,\d*|,\d+)([eE][+-]?\d+)?")


class Table:
    """`header`: names of the columns, in small letters; `units`: those of columns that name one; `rows`:
    texts; `places`: words for each row in messages."""

    def __init__(self, path, header, rows, places):
        self.path, self.rows, self.places, self.units = path, rows, places, {}
        self.header = []
        for cell in header:
            found = UNIT.match(cell.strip())
            name = (found[1] if found else cell.strip()).lower()
            if found and found[2]:
                self.units[name] = found[2]
            self.header.append(name)

    def cells(self, name):
        """The texts of a column."""
        if self.header.count(name) != 1:
            raise RunError(f"{self.path}: the first line names {self.header.count(name) or 'no'} columns {name}; allowed: one")
        index = self.header.index(name)
        return [row[index] if index < len(row) else "" for row in self.rows]

    def taken(self, kept):
        """The table with some of its rows."""
        chosen = np.flatnonzero(kept)
        result = copy.copy(self)
        result.rows, result.places = [self.rows[k] for k in chosen], [self.places[k] for k in chosen]
        return result

    def column(self, name, may_be_empty=False):
        """Its numbers; with `may_be_empty` NaN for an empty cell."""
        return np.array([np.nan if may_be_empty and not cell else self.number(name, cell, place)
                         for cell, place in zip(self.cells(name), self.places)])

    def number(self, name, cell, place):
        try:
            value = float(cell)
        except ValueError:
            value = np.nan
        if not np.isfinite(value):
            raise self.refusal(name, cell, place, "a finite number")
        return value

    def refusal(self, name, found, place, allowed):
        return RunError(f"{self.path}, {place}, column {name}: found '{found[:40]}'; allowed: {allowed}")

    def numbers(self, columns, may_be_empty=()):
        """Columns as an array (row, column)."""
        missing = [name for name in columns if name not in self.header]
        if missing:
            there = ", ".join(self.header)
            raise RunError(f"{self.path}: the first line names no column {', '.join(missing)}; needed: {', '.join(columns)}; "
                           f"found: {there[:100]}{'...' * (len(there) > 100)}")
        return np.stack([self.column(name, name in may_be_empty) for name in columns], axis=1)

    def whole_numbers(self, name):
        values = self.column(name)
        for value, place in zip(values, self.places):
            if value != np.floor(value):
                raise self.refusal(name, f"{value:g}", place, "a whole number")
        return values


def read_table(path, unnamed=()):
    """The table in a file. `unnamed`: names of the columns where the first line has as many numbers
    instead."""
    lines = [(number, line) for number, line in enumerate(re.split("\r\n|\n|\r", text_of(path)), start=1)
             if line.strip(" \t;,")]
    if lines and lines[0][1].startswith("//"):  # the names of CloudCompare
        lines[0] = lines[0][0], lines[0][1].lstrip("/ ")
    begin = next((i for i, (_, line) in enumerate(lines) if not is_remark(line)), len(lines))
    remarks, lines = lines[:begin], [one for one in lines[begin:] if not is_remark(one[1])]
    given = re.fullmatch(r"sep=(.)", lines[0][1].strip("\r\n ")) if lines else None  # a spreadsheet's own line
    lines = lines[1:] if given else lines
    if not lines:
        raise RunError(f"{path}: holds no points; allowed: {ALLOWED}")
    separator = given[1] if given else separator_of(lines[0][1])
    rows = [cells_of(line, separator, f"{path}, line {number}") for number, line in lines]
    places = [f"line {number}" for number, _ in lines]
    header = names_above(rows[0], [line for _, line in remarks], unnamed) if all(map(is_number, rows[0])) else None
    if header is None:
        header, rows, places = rows[0], rows[1:], places[1:]
    while header and not header[-1]:
        header.pop()
    if rows and rows[0] == [str(len(rows) - 1)] and len(header) > 1:  # how many points follow
        rows, places = rows[1:], places[1:]
    if not rows:
        raise RunError(f"{path}: holds no points; allowed: {ALLOWED}")
    for row, place in zip(rows, places):
        while len(row) > len(header) and not row[-1]:
            row.pop()
        if len(row) > len(header) or (separator == BLANKS and len(row) < len(header)):
            raise RunError(f"{path}, {place}: found {len(row)} cells; allowed: {len(header)}, as many as the first line has"
                           f"{' (decimal commas need semicolons or tabs between cells)' * (separator == ',')}")
    return Table(path, header, rows, places)


def is_remark(line):
    return line.startswith(("#", "//")) and not line.lower().startswith("#n/a")  # a cell of spreadsheets


def names_above(numbers, remarks, unnamed):
    """Names of the columns of a table that begins with a line of numbers: those in the last remark that has
    as many and names x, or else `unnamed`; None where there are none."""
    for remark in reversed(remarks):
        text = remark.strip("#/ \t")
        names = cells_of(text, separator_of(text), "") if '"' not in text else []
        if len(names) == len(numbers) and any(re.search(r"\bx(\b|_)", name.replace("_", " ").lower()) for name in names):
            return names
    return list(unnamed) if len(numbers) == len(unnamed) else None


def is_number(cell):
    try:
        float(cell.replace(",", "."))
    except ValueError:
        return False
    return True


def separator_of(header):
    return next((one for one in ";\t," if one in header), BLANKS)


def cells_of(line, separator, place):
    if separator == BLANKS:
        line = re.sub(r"\s+(?=[\[(])", "", line.strip())  # "x [mm]" is one cell
    try:
        cells = [cell.strip() for cell in next(csv.reader([line], delimiter=separator, strict=True,
                                                          skipinitialspace=separator == BLANKS), [])]
    except csv.Error as error:
        raise RunError(f"{place}: found {error}; allowed: quotes around a whole cell") from error
    if separator == BLANKS:
        cells = [cell for cell in cells if cell]
    if separator == ",":
        return cells
    return [cell.replace(",", ".") if DECIMAL_COMMA.fullmatch(cell) else cell for cell in cells]


def text_of(path, allowed=ALLOWED):
    """A file's text, whichever of the usual encodings it has."""
    with open(path, "rb") as file:
        content = file.read()
    if content[:2] in (b"\xff\xfe", b"\xfe\xff"):
        encodings = ["utf-16"]
    elif b"\0" in content[:2]:  # UTF-16 whose first character is a usual letter
        encodings = ["utf-16-be" if content[:1] == b"\0" else "utf-16-le"]
    else:
        encodings = ["utf-8-sig", "cp1252"]
    for encoding in encodings:
        try:
            text = content.decode(encoding)
        except UnicodeDecodeError:
            continue
        if not NO_TEXT.search(text):
            return text
    raise RunError(f"{path}: is no text; allowed: {allowed}")
