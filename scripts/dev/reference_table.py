#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Keeps the lists of keys in docs/reference.md equal to what the program says.

    scripts/dev/reference_table.py [--write] [PROGRAM [GUIDE]]

PROGRAM is build/release/fabseq and GUIDE docs/reference.md unless said otherwise.

Compares `fabseq -help_markdown` with the block between the two marker comments: exit status 1 and a diff if
they differ; --write replaces the block.
"""

import argparse
import difflib
import subprocess
import sys
from pathlib import Path

BEGIN, END = "<!-- reference table -->", "<!-- end of reference table -->"


def split(guide_text, name):
    """Text up to and with the first marker, the block, and the rest from the second marker on."""
    if guide_text.count(BEGIN) != 1 or guide_text.count(END) != 1 or guide_text.index(BEGIN) > guide_text.index(END):
        sys.exit(f"reference_table.py: {name} needs the lines '{BEGIN}' and '{END}', once each and in this order")
    head, rest = guide_text.split(BEGIN)
    block, tail = rest.split(END)
    return head + BEGIN, block, END + tail


def main():
    root = Path(__file__).resolve().parents[2]
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--write", action="store_true")
    parser.add_argument("program", nargs="?", default=root / "build/release/fabseq")
    parser.add_argument("guide", nargs="?", type=Path, default=root / "docs/reference.md")
    arguments = parser.parse_args()
    done = subprocess.run([arguments.program, "-help_markdown"], stdout=subprocess.PIPE, text=True)
    if done.returncode != 0:
        sys.exit(f"reference_table.py: {arguments.program} -help_markdown ended with status {done.returncode}")
    table = done.stdout.strip()
    head, block, tail = split(arguments.guide.read_text(encoding="utf-8"), arguments.guide)
    if arguments.write:
        arguments.guide.write_text(f"{head}\n{table}\n{tail}", encoding="utf-8")
    elif block.strip() != table:
        sys.stdout.writelines(line + "\n" for line in difflib.unified_diff(
            block.strip().splitlines(), table.splitlines(), str(arguments.guide), "fabseq -help_markdown", lineterm=""))
        sys.exit(f"reference_table.py: {arguments.guide} is out of date; scripts/dev/reference_table.py --write mends it")


if __name__ == "__main__":
    main()
