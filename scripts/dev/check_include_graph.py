#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Checks who includes whom: scripts/dev/check_include_graph.py [PROJECT]

Modules are the folders of include/fabseq and src. A module may use itself and those above it in MODULES,
never those below (docs/architecture.md); headers include each other without a circle; every included
header of fabseq exists. src/main.cc and the tests may use everything. Prints each offence as FILE:LINE:
TEXT; exit status 1 if there is one."""

import graphlib
import re
import sys
from pathlib import Path

MODULES = ["base", "keys", "parallel", "grid", "mesh", "part", "files", "fem", "lanes", "solve", "sequence",
           "layers", "machine", "process", "responses", "mma", "optimize", "config", "run"]
INCLUDE = re.compile(r'^\s*#\s*include\s*[<"](fabseq/[^>"]+)[>"]')


def includes(path):
    """(line number, included header relative to include/) of each header of fabseq that a file includes."""
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        if match := INCLUDE.match(line):
            yield number, match[1]


def module_of(path, root):
    """Folder that a file of include/fabseq or src lies in; None for a file directly in one of them."""
    for base in ("include/fabseq", "src"):
        if path.is_relative_to(root / base):
            parts = path.relative_to(root / base).parts
            return parts[0] if len(parts) > 1 else None
    return None


def layering_offences(root, files):
    """Includes of a module further down, of a header that does not exist, and folders that are no module."""
    for path in files:
        module, where = module_of(path, root), path.relative_to(root)
        if module is not None and module not in MODULES:
            yield f"{where}:1: folder '{module}' is no module; the modules are {', '.join(MODULES)}"
            continue
        for number, header in includes(path):
            target = root / "include" / header
            if not target.is_file():
                yield f"{where}:{number}: {header} does not exist"
            elif module is not None:
                used = module_of(target, root)
                if used in MODULES and MODULES.index(used) > MODULES.index(module):
                    yield f"{where}:{number}: module '{module}' must not use '{used}', which comes after it"


def circle(root, headers):
    """Headers each of which includes the next, the last being the first again; None without a circle."""
    graph = {str(h.relative_to(root / "include")): [name for _, name in includes(h)] for h in sorted(headers)}
    try:
        graphlib.TopologicalSorter(graph).prepare()
    except graphlib.CycleError as error:
        return error.args[1][::-1]  # its edges run from the included header
    return None


def offences(root):
    """All offences of the project at `root`, as lines of text."""
    headers = sorted((root / "include").rglob("*.h"))
    sources = sorted(p for p in (root / "src").rglob("*") if p.suffix in (".cc", ".h"))
    found = list(layering_offences(root, headers + sources))
    if ring := circle(root, headers):
        found.append(f"include/{ring[0]}:1: headers include each other in a circle: {' -> '.join(ring)}")
    return found


def main():
    root = Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).resolve().parents[2]).resolve()
    found = offences(root)
    print(*found, sep="\n", end="\n" if found else "")
    sys.exit(bool(found))


if __name__ == "__main__":
    main()
