#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Names what a change touches: scripts/dev/touched.py --since COMMIT (--sources | --tests)

    --since COMMIT  the change: all files that differ from this commit, new ones included
    --sources       sources of the program that changed, or name a header that changed, one a line, for
                    scripts/dev/lint.sh --tidy
    --tests         a regular expression for ctest -R: unit tests that changed, that name a header
                    that changed, or the header beside one of those sources; nothing where there is none

A header counts where a file names it, for tests also through their own headers: what lies behind
others, the next full run looks at. Runs of the whole program belong to no file: --tests names none."""

import argparse
import functools
import subprocess
import sys
from pathlib import Path

from check_include_graph import includes

FOLDERS = "include", "src", "tests"  # that names of headers begin in


class Tree:
    """The files of a project and what they include."""

    def __init__(self, root):
        self.root = root

    def files(self, folder, pattern):
        return sorted(path.relative_to(self.root) for path in (self.root / folder).rglob(pattern))

    @functools.lru_cache(maxsize=None)
    def headers(self, path):
        """Headers of the project that a file names itself."""
        places = [Path(folder) / name for _, name in includes(self.root / path) for folder in FOLDERS]
        return [place for place in places if (self.root / place).is_file()]

    def names(self, path):
        """The file and the headers of the project that it, or a header of the tests that it names, names."""
        found, waiting = {path}, [path]
        while waiting:
            new = [header for header in self.headers(waiting.pop()) if header not in found]
            found.update(new)
            waiting += [header for header in new if header.parts[0] == "tests"]
        return found

    @functools.lru_cache(maxsize=None)
    def source_of(self, header):
        """The source that a header declares; None where there is none."""
        parts = header.parts[2:] if header.parts[0] == "include" else header.parts[1:]
        source = Path("src", *parts).with_suffix(".cc")
        return source if (self.root / source).is_file() else None


def touched_sources(tree, changed):
    return [path for path in tree.files("src", "*.cc") if tree.names(path) & changed]


def touched_tests(tree, changed):
    """Names of unit tests: those of their files without the suffix."""
    sources_touched = set(touched_sources(tree, changed))
    for path in tree.files("tests", "*_test.cc"):
        names = tree.names(path)
        if names & changed or {tree.source_of(name) for name in names if name.suffix == ".h"} & sources_touched:
            yield path.stem


def changed_since(root, commit):
    def git(*words):
        return subprocess.run(["git", *words], cwd=root, capture_output=True, text=True, check=True).stdout.splitlines()
    try:
        names = git("diff", "--name-only", commit, "--") + git("ls-files", "--others", "--exclude-standard")
    except subprocess.CalledProcessError as error:
        sys.exit(f"touched.py: --since {commit}: {error.stderr.strip()}; allowed: a commit of this repository")
    return {Path(name) for name in names}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--since", metavar="COMMIT", required=True)
    kind = parser.add_mutually_exclusive_group(required=True)
    kind.add_argument("--sources", action="store_true")
    kind.add_argument("--tests", action="store_true")
    arguments = parser.parse_args()
    root = Path(__file__).resolve().parents[2]
    tree, changed = Tree(root), changed_since(root, arguments.since)
    if arguments.sources:
        print("".join(f"{path}\n" for path in touched_sources(tree, changed)), end="")
    elif names := list(touched_tests(tree, changed)):
        print(f"^({'|'.join(names)})\\.np")


if __name__ == "__main__":
    main()
