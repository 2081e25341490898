# SPDX-License-Identifier: MIT
"""Keeps documents equal to what the program says of itself."""

import argparse
import difflib
import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SCRIPT = os.path.basename(sys.argv[0])


def output_of(program, option):
    done = subprocess.run([program, option], stdout=subprocess.PIPE, text=True)
    if done.returncode != 0:
        sys.exit(f"{SCRIPT}: {program} {option} ended with status {done.returncode}")
    return done.stdout


def keep_up_to_date(documentation, document, made):
    """The command line of a script: `made`, of the program and the document's path, is the text that
    should stand there. Exit status 1 and a diff if it does not; --write writes it."""
    parser = argparse.ArgumentParser(description=documentation, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--write", action="store_true")
    parser.add_argument("program", nargs="?", default=ROOT / "build/release/fabseq")
    parser.add_argument("document", nargs="?", type=Path, default=document)
    arguments = parser.parse_args()
    path = arguments.document
    text = made(arguments.program, path)
    there = path.read_text(encoding="utf-8") if path.exists() else ""
    if arguments.write:
        path.write_text(text, encoding="utf-8")
    elif there != text:
        sys.stdout.writelines(difflib.unified_diff(there.splitlines(True), text.splitlines(True),
                                                   str(path), "as it should be"))
        sys.exit(f"{SCRIPT}: {path} is out of date; scripts/dev/{SCRIPT} --write mends it")
