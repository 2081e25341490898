#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Checks who includes whom: scripts/dev/check_include_graph.py [PROJECT]

Modules are the folders of include/fabseq and src (docs/architecture.md). A module may use itself and those
above it in MODULES, never those below; headers include each other without a circle; every included header
exists. Headers in include/fabseq are installed: they include no header of src, and what nothing outside its
module needs is none of them. Headers in src are their own module's; those of the lane engine (ENGINE) serve
all sources. src/main.cc and the tests may use everything. Prints each offence as FILE:LINE: TEXT; exit status
1 if there is one."""

import graphlib
import re
import sys
from pathlib import Path

MODULES = ["base", "keys", "parallel", "grid", "mesh", "part", "files", "fem", "kernels", "ranks", "multigrid",
           "islands", "cg", "solve", "sequence", "layers", "machine", "process", "thermal", "responses", "mma",
           "model", "chain", "optimize", "report", "repair", "config", "output", "tasks", "python"]
ENGINE = {"kernels", "ranks", "multigrid", "islands", "cg"}
INCLUDE = re.compile(r'^\s*#\s*include\s*(?:[<"](fabseq/[^>"]+)[>"]|"([a-z_]+/[^"]+)")')


def includes(path):
    """(line number, name) of each header of fabseq that a file includes: fabseq/MODULE/..., or MODULE/..."""
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        if match := INCLUDE.match(line):
            yield number, match[1] or match[2]


def header_path(name, root):
    return root / ("include" if name.startswith("fabseq/") else "src") / name


def module_of(path, root):
    """Folder that a file of include/fabseq or src lies in; None for one directly in these, and elsewhere."""
    for base in ("include/fabseq", "src"):
        if path.is_relative_to(root / base):
            parts = path.relative_to(root / base).parts
            return parts[0] if len(parts) > 1 else None
    return None


def include_offence(root, path, target):
    """What is wrong with a file of a module, or src/main.cc, including a header; None if nothing is."""
    module, used = module_of(path, root), module_of(target, root)
    if not target.is_file():
        return f"{target.relative_to(root)} does not exist"
    if module is None or used not in MODULES:
        return None
    if MODULES.index(used) > MODULES.index(module):
        return f"module '{module}' must not use '{used}', which comes after it"
    if target.is_relative_to(root / "src"):
        if path.is_relative_to(root / "include"):
            return f"an installed header must not include {target.relative_to(root)}, which is not installed"
        if used not in (module, *ENGINE):
            return f"{target.relative_to(root)} is for module '{used}' alone"
    return None


def layering_offences(root, files):
    """Includes that must not be, and folders that are no module."""
    for path in files:
        module, where = module_of(path, root), path.relative_to(root)
        if module is not None and module not in MODULES:
            yield f"{where}:1: folder '{module}' is no module; the modules are {', '.join(MODULES)}"
            continue
        for number, name in includes(path):
            if offence := include_offence(root, path, header_path(name, root)):
                yield f"{where}:{number}: {offence}"


def needless_offences(root, headers, sources):
    """Installed headers that neither another module nor a header which that needs includes."""
    needed = set()
    waiting = [name for path in headers + sources for _, name in includes(path)
               if module_of(path, root) != module_of(header_path(name, root), root)]
    while waiting:
        name = waiting.pop()
        path = header_path(name, root)
        if name.startswith("fabseq/") and name not in needed and path.is_file():
            needed.add(name)
            waiting += [other for _, other in includes(path)]
    for path in headers:
        name = str(path.relative_to(root / "include"))
        if name.startswith("fabseq/") and name not in needed and module_of(path, root) in MODULES:
            yield f"include/{name}:1: only its own module uses it: it belongs beside its source in src"


def circle(root, headers):
    """Headers each of which includes the next, the last being the first again; None without a circle."""
    graph = {h: [header_path(name, root) for _, name in includes(h)] for h in sorted(headers)}
    try:
        graphlib.TopologicalSorter(graph).prepare()
    except graphlib.CycleError as error:
        return [str(h.relative_to(root)) for h in error.args[1][::-1]]  # its edges run from the included header
    return None


def offences(root):
    """All offences of the project at `root`, as lines of text."""
    headers = sorted((root / "include").rglob("*.h"))
    sources = sorted(p for p in (root / "src").rglob("*") if p.suffix in (".cc", ".h"))
    found = list(layering_offences(root, headers + sources))
    found += needless_offences(root, headers, [*sources, *sorted((root / "docs").rglob("*.cc"))])
    if ring := circle(root, headers + [p for p in sources if p.suffix == ".h"]):
        found.append(f"{ring[0]}:1: headers include each other in a circle: {' -> '.join(ring)}")
    return found


def main():
    root = Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).resolve().parents[2]).resolve()
    found = offences(root)
    print(*found, sep="\n", end="\n" if found else "")
    sys.exit(bool(found))


if __name__ == "__main__":
    main()
