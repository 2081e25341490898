#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Checks how comments and commits are written: scripts/dev/check_comments.py [PROJECT]

Derivatives are "with respect to" something, never "by" it. A paragraph of a comment fills its lines: none is
left short, as formatters tear a line that has become too long. Doc comments (outside tests, but in
tests/support) open with a verb or a noun, not with one of NEVER_FIRST. Subjects of the last commits (RECENT)
have at most LONGEST signs and begin with a capital letter. Prints each offence as FILE:LINE: TEXT; exit
status 1 if there is one."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

BY = re.compile(r"\b(derivatives?|gradients?)\b( of [^.,;:()]{1,60})? by (?!adjoints|differences|the adjoint|finite|hand)",
                re.IGNORECASE)
COMMENT = re.compile(r"^(\s*///?)(?: (?! )(.*))?$")
ENDS = re.compile(r"^(\\|- |\d\. |SPDX|NOLINT|clang-format)")
DOC = re.compile(r"^\s*///(?!<)(?: ([A-Za-z']+)(?![\w(-]))?")
NEVER_FIRST = set("""about above across after against along also among and as at because before behind below beside between
beyond but by during for from if in inside into it its of on onto or over since such than that their there they those
though through to towards under unless until upon when while with within without""".split())
OPENED = ("include", "src", "tests/support")  # where the first words of doc comments are looked at
WIDTH = 110
TORN = 30  # signs that a line may be shorter than its next word allows
RECENT, LONGEST = 20, 72


def paragraphs(lines):
    """(number of the first line, text of each line) of comments, split where one ends on purpose."""
    found, indent = [], None
    for number, line in enumerate(lines, 1):
        match = COMMENT.match(line)
        text = match[2] if match and match[2] != "\\file" else None
        goes_on = bool(text) and not ENDS.match(text)
        if found and not (goes_on and match[1] == indent):
            yield number - len(found), found
            found = []
        if text:
            indent = match[1]
            found.append((line, text))
    if found:
        yield len(lines) + 1 - len(found), found


def offences_of(lines):
    for first, paragraph in paragraphs(lines):
        whole = " ".join(text for _, text in paragraph)
        if match := BY.search(whole):
            yield first, f"'{match[0].strip()}' something: derivatives are with respect to it"
        for number, ((line, _), (_, following)) in enumerate(zip(paragraph, paragraph[1:])):
            if len(line) + 1 + len(following.split()[0]) + TORN <= WIDTH:
                yield first + number, "this line of a comment is left short, and its sentence goes on: fill it"


def openings_of(lines):
    """(number, text) of doc comments that open with a preposition, a conjunction or a pronoun."""
    inside = False
    for number, line in enumerate(lines, 1):
        match = DOC.match(line)
        if match and not inside and (match[1] or "").lower() in NEVER_FIRST:
            yield number, f"'{match[1]}' opens this doc comment: a verb (function) or a noun (type, member) does"
        inside = bool(match)


def subjects(root):
    if not shutil.which("git"):
        return []
    git = ["git", "log", f"-{RECENT}", "--no-merges", "--format=%s"]
    done = subprocess.run(git, cwd=root, capture_output=True, text=True, check=False)
    return done.stdout.splitlines()  # none outside a repository


def main():
    root = Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).resolve().parents[2]).resolve()
    found = []
    for folder in ("include", "src", "tests", "benchmarks"):
        for path in sorted(p for p in (root / folder).rglob("*") if p.suffix in (".cc", ".h")):
            lines = path.read_text(encoding="utf-8").splitlines()
            offences = list(offences_of(lines))
            if str(path.relative_to(root)).startswith(tuple(f"{opened}/" for opened in OPENED)):
                offences += openings_of(lines)
            found += [f"{path.relative_to(root)}:{number}: {text}" for number, text in offences]
    for subject in subjects(root):
        if len(subject) > LONGEST or not subject[:1].isupper():
            found.append(f"commit '{subject}': found {len(subject)} signs; allowed: at most {LONGEST}, after a capital letter")
    print(*found, sep="\n", end="\n" if found else "")
    sys.exit(bool(found))


if __name__ == "__main__":
    main()
