#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""The table of a parameter study (CSV): one run a line.

    scripts/slurm/study_table.py TABLE.csv          prints how many runs it has
    scripts/slurm/study_table.py TABLE.csv NUMBER   prints the words of run NUMBER, from 1, a line each:
                                                    its name, -set KEY=VALUE for every other column

The first line names the columns: the first is `name`, for the run's directory; the others are keys as of
-set, which takes JSON or else a string. What contains a comma is put in quotation marks, in which a quotation
mark is doubled. An empty value leaves the key as it is in the config. Empty lines and lines that begin with #
do not count.
"""

import csv
import re
import sys


def read_table(path):
    """A list of runs, each a name and a list of (key, value)."""
    with open(path, encoding="utf-8-sig", newline="") as file:
        lines = [(number, line) for number, line in enumerate(file, start=1) if line.strip() and not line.startswith("#")]
    rows = list(csv.reader((line for _, line in lines), strict=True))
    if not rows or rows[0][0] != "name" or "" in rows[0]:
        raise ValueError(f"{path}: the first line must name all columns, the first of them 'name'")
    keys = rows[0][1:]
    runs = []
    for (number, _), row in zip(lines[1:], rows[1:]):
        if len(row) != len(keys) + 1:
            raise ValueError(f"{path}, line {number}: {len(row)} columns in place of {len(keys) + 1}")
        if not re.fullmatch(r"[\w.+-]*\w[\w.+-]*", row[0], re.ASCII):
            raise ValueError(f"{path}, line {number}: the name '{row[0]}' is to be of letters, digits, and . _ + -")
        if row[0] in [name for name, _ in runs]:
            raise ValueError(f"{path}, line {number}: there is another run '{row[0]}'")
        runs.append((row[0], [(key, value) for key, value in zip(keys, row[1:]) if value != ""]))
    return runs


def main():
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    try:
        runs = read_table(sys.argv[1])
    except (OSError, ValueError, csv.Error) as error:
        sys.exit(f"study_table.py: {error}")
    if len(sys.argv) == 2:
        print(len(runs))
        return
    if not sys.argv[2].isdigit() or not 1 <= int(sys.argv[2]) <= len(runs):
        sys.exit(f"study_table.py: {sys.argv[1]} has runs 1 to {len(runs)}, but no run {sys.argv[2]}")
    name, settings = runs[int(sys.argv[2]) - 1]
    print(name, *(word for key, value in settings for word in ("-set", f"{key}={value}")), sep="\n")


if __name__ == "__main__":
    main()
