#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""clang-tidy over the program's sources, with the flags of the release build, each a source of its own.

    scripts/dev/check_tidy.py [--jobs N] [FILE.cc...]     with files: these only

Most of its time goes into the headers of PETSc and the standard library, so the files of a folder are looked
at together, as one source that includes them. Where that finds something, or names of two files clash, each
of them is looked at alone, and only this counts. (The program is what is checked; the tests would double the
time.)
"""

import argparse
import concurrent.futures
import itertools
import json
import os
import re
import shlex
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
GROUP = 12
# Warnings in system headers are counted on stderr, to no one's use.
CHATTER = re.compile(r"^\d+ warnings? (and \d+ errors? )?generated\.$|^Suppressed |^Use -header-filter|^Error while processing ")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("files", nargs="*", metavar="FILE.cc")
    arguments = parser.parse_args()
    sources = program_sources()
    groups = [[os.path.abspath(name)] for name in arguments.files] or list(folders(sources))
    with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        found = pool.map(lambda group: look_at_group(group, sources), groups)
        suspects = [name for group, suspected in zip(groups, found) if suspected for name in group]
        messages = [text for text in pool.map(lambda name: look_at_file(name, sources), suspects) if text]
    print("\n".join(messages), end="\n" if messages else "")
    sys.exit(1 if messages else 0)


def program_sources():
    """Command of each source file of the program, where it is not compiled together with others."""
    build = os.path.join(ROOT, "build", "lint")
    subprocess.run(["cmake", "--preset", "release", "-B", build, "-D", "FABSEQ_UNITY=OFF", "-D", "FABSEQ_TESTS=OFF",
                    "--log-level=WARNING"], cwd=ROOT, stdout=subprocess.DEVNULL, check=True)
    with open(os.path.join(build, "compile_commands.json"), encoding="utf-8") as file:
        return {entry["file"]: entry["command"] for entry in json.load(file)
                if entry["file"].startswith(os.path.join(ROOT, "src") + os.sep)}


def folders(sources):
    """Groups of files in a folder with the same flags; neighbours, which may share names, lie in others."""
    def kind(name):
        return os.path.dirname(name), flags(sources[name])
    for _, group in itertools.groupby(sorted(sources, key=kind), kind):
        names = list(group)
        count = -(-len(names) // GROUP)
        yield from (names[first::count] for first in range(count))


def flags(command):
    """The compiler's options but for file names and the precompiled header, which clang-tidy cannot read."""
    words = shlex.split(command)[1:]
    left_out = ("-c", "-o", "-include", "-Winvalid-pch")
    return [word for word in words if word not in left_out and not word.endswith((".cc", ".o", "cmake_pch.hxx"))]


def look_at_group(names, sources):
    """Whether the files have to be looked at one by one."""
    if len(names) == 1:
        return True
    with tempfile.TemporaryDirectory() as folder:
        together = os.path.join(folder, "together.cc")
        with open(together, "w", encoding="utf-8") as file:
            for number, name in enumerate(names):  # each response registers itself under the same name
                file.write(f"#define registered registered_{number}  // NOLINT\n"
                           f'#include "{name}"  // NOLINT(bugprone-suspicious-include)\n#undef registered\n')
        # One file's names hide no other's when they are compiled one by one.
        return clang_tidy(together, *flags(sources[names[0]]), "-Wno-shadow").returncode != 0


def clang_tidy(name, *compiler_flags):
    command = ["clang-tidy", "--quiet", f"--config-file={os.path.join(ROOT, '.clang-tidy')}",
               f"--header-filter={re.escape(ROOT)}/(src|include)/.*", name, "--", *compiler_flags]
    return subprocess.run(command, capture_output=True, text=True, cwd=ROOT, check=False)


def look_at_file(name, sources):
    """What is wrong with a file; nothing where nothing is."""
    result = clang_tidy(name, *flags(sources.get(name) or next(iter(sources.values()))))
    lines = [line for line in (result.stdout + result.stderr).splitlines() if line.strip() and not CHATTER.match(line)]
    if result.returncode == 0:
        return ""
    return "\n".join(lines) or f"{name}: clang-tidy ends with status {result.returncode}"


if __name__ == "__main__":
    main()
