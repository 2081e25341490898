# SPDX-License-Identifier: MIT
"""Modules that register themselves by a line of their own."""

import re


def registered(folder, word):
    """Files below a folder (a Path) that have a line `WORD = "name"`, by that name, sorted. They are read,
    not imported: this needs none of their packages."""
    line = re.compile(rf'^{word} = "([a-z0-9-]+)"$', re.MULTILINE)
    found = {path: line.search(path.read_text(encoding="utf-8")) for path in folder.rglob("*.py")}
    return dict(sorted((name[1], path) for path, name in found.items() if name))
