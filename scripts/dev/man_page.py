#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Keeps the manual page docs/fabseq.1 equal to what the program and the reference say.

    scripts/dev/man_page.py [--write] [PROGRAM [PAGE]]

PROGRAM is build/release/fabseq and PAGE docs/fabseq.1 unless said otherwise.

Fills scripts/dev/fabseq.1.in with options (`fabseq -help`, `fabseq -help_markdown`) and with the tables of
docs/reference.md: exit status 1 and a diff if the page differs; --write writes it.
"""

import re
import textwrap

from made_of_help import ROOT, keep_up_to_date, output_of

FLAT_OPTION = re.compile(r"- `(?P<key>[^`]+)`(?: \(`(?P<variant>[^`]+)`(?:, `[^`]+`)*\))?: "
                         r"(?P<text>.*); `(?P<option>-[^`]+)`\.")


def escaped(text):
    """Plain text for troff. Hyphens of options stay what they are, and can be copied."""
    text = text.replace("\\", "\\e").replace("-", "\\-")
    return re.sub("[^\x00-\x7f]", lambda match: f"\\[u{ord(match[0]):04X}]", text)


def troff(markdown):
    """Text in Markdown as lines: code is bold, links are their text."""
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", markdown).replace(r"\|", "|")
    parts = [escaped(part) for part in text.split("`")]
    text = "".join(f"\\fB{part}\\fP" if number % 2 else part for number, part in enumerate(parts))
    lines = textwrap.wrap(text, 79, break_long_words=False, break_on_hyphens=False)
    return "\n".join(re.sub(r"^(?=[.'])", r"\\&", line) for line in lines)


def entries(pairs):
    """A tagged paragraph for each pair of Markdown texts."""
    return "\n".join(f".TP\n{troff(tag)}\n{troff(text)}" for tag, text in pairs)


def table(reference, heading, number=0):
    """Rows of the number-th Markdown table below a heading, without its head."""
    below = reference.split(f"\n## {heading}\n")[1].split("\n## ")[0]
    found = re.findall(r"(?:^\|.*\n)+", below, flags=re.MULTILINE)[number]
    return [[cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]] for line in found.splitlines()[2:]]


def own_options(help_text):
    """Pairs of option and meaning of the first list of -help."""
    block = help_text.split("\nOptions:\n")[1].split("\nAll other options")[0]
    pairs = []
    for line in block.splitlines():
        option = re.match(r"  (-\S.*?)(?:  +|(?<=VALUE) )(\S.*)", line)
        if option:
            pairs.append([option[1], option[2]])
        else:
            pairs[-1][1] += " " + line.strip()
    for pair in pairs:
        pair[0] = ", ".join(re.sub(r"^(-\w+)", r"`\1`", word) for word in pair[0].split(", "))
        if ": the keys as tables" in pair[1]:  # two options in one line of -help
            pair[1] = "print and end"
            pairs.append(["`-help_markdown`", "prints the keys as lists for the manual and ends"])
        pair[1] = pair[1].replace("with the keys listed below", "with the keys that -help lists")
    return pairs


def flat_options(markdown):
    """Pairs of flat option and meaning with key, values and default."""
    pairs, section = [], ""
    for line in re.sub(r"\n  (?=\S)", " ", markdown).splitlines():
        if line.startswith("### "):
            section = (re.match(r"### `([^`]+)`", line) or ["", ""])[1]
        entry = FLAT_OPTION.match(line)
        if entry:
            type_ = entry["variant"] if section in ("objective", "constraints") else None
            path = ".".join(filter(None, [section, type_, entry["key"]]))
            pairs.append((f"`{entry['option']}` VALUE", f"(`{path}`) {entry['text']}"))
    return pairs


def page(program):
    reference = (ROOT / "docs/reference.md").read_text(encoding="utf-8")
    written = dict(table(reference, "Tasks", 1))
    fields = {
        "VERSION": output_of(program, "-version").split()[1],
        "OPTIONS": entries(own_options(output_of(program, "-help"))),
        "FLAT_OPTIONS": entries(flat_options(output_of(program, "-help_markdown"))),
        "PETSC_OPTIONS": entries(table(reference, "Command line", 1)),
        "TASKS": entries((task, f"{what}. Writes: {re.sub('everything in .*', 'all FILES', written[task])}.")
                         for task, what in table(reference, "Tasks")),
        "FILES": entries(table(reference, "Output")),
        "EXIT_STATUS": entries((status, f"{meaning}; {advice.replace('see below; ', '')}".removesuffix("; "))
                               for status, meaning, advice in table(reference, "Exit status and messages"))}
    text = (ROOT / "scripts/dev/fabseq.1.in").read_text(encoding="utf-8")
    return re.sub("@([A-Z_]+)@", lambda match: fields[match[1]], text)


if __name__ == "__main__":
    keep_up_to_date(__doc__, ROOT / "docs/fabseq.1", lambda program, _: page(program))
