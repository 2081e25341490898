#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Keeps the lists of keys in docs/reference.md equal to what the program says.

    scripts/dev/reference_table.py [--write] [PROGRAM [GUIDE]]

PROGRAM is build/release/fabseq and GUIDE docs/reference.md unless said otherwise.

Compares `fabseq -help_markdown` with the block between the two marker comments: exit status 1 and a diff if
they differ; --write replaces the block.
"""

import sys

from made_of_help import ROOT, keep_up_to_date, output_of

BEGIN, END = "<!-- reference table -->", "<!-- end of reference table -->"


def with_table(program, path):
    """The guide with the program's table between the markers."""
    guide = path.read_text(encoding="utf-8")
    if guide.count(BEGIN) != 1 or guide.count(END) != 1 or guide.index(BEGIN) > guide.index(END):
        sys.exit(f"reference_table.py: {path} needs the lines '{BEGIN}' and '{END}', once each and in this order")
    head, tail = guide.split(BEGIN)[0], guide.split(END)[1]
    return f"{head}{BEGIN}\n{output_of(program, '-help_markdown').strip()}\n{END}{tail}"


if __name__ == "__main__":
    keep_up_to_date(__doc__, ROOT / "docs/reference.md", with_table)
