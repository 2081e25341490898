# SPDX-License-Identifier: MIT
"""The entry of all tools: finds the commands of this package, and runs one of them."""

import ast
import dataclasses
import difflib
import importlib
import sys
from pathlib import Path

from fabseq_tools import find_python
from fabseq_tools.run.command_line import run_script
from fabseq_tools.run.places import NAME
from fabseq_tools.run.registered import registered

USAGE = f"usage: {NAME} COMMAND [WORD]..."
HEAD = f"""{USAGE}
       {NAME} COMMAND --help

Pictures, tables, geometry and torch paths of the runs of fabseq, and what simulates in rounds."""


@dataclasses.dataclass
class Command:
    """`module`: its name for an import; `summary`: the first line of its docstring."""

    module: str
    summary: str


def find_commands(package=Path(__file__).parent):
    """All commands by name."""
    return {name: Command(".".join([package.name, *path.relative_to(package).with_suffix("").parts]), summary_of(path))
            for name, path in registered(package, "COMMAND").items()}


def summary_of(path):
    return ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))).splitlines()[0]


def listing(commands):
    width = max(map(len, commands))
    return "\n".join(f"  {name:<{width}}  {command.summary}" for name, command in commands.items())


def refuse(word, commands):
    """Ends with status 2."""
    near = difflib.get_close_matches(word, commands, n=1)
    print(f"{NAME}: {word}: no such command{f'; near: {near[0]}' if near else ''}; {NAME} --help lists all", file=sys.stderr)
    sys.exit(2)


def load(module):
    """The module; another Python goes on where this one lacks a package that the module needs."""
    try:
        return importlib.import_module(module)
    except ModuleNotFoundError as error:
        if (error.name or "").partition(".")[0] not in find_python.PACKAGES:
            raise
    return find_python.start_again()


def main():
    words, commands = sys.argv[1:], find_commands()
    if not words:
        print(f"{USAGE}; {NAME} --help lists the commands", file=sys.stderr)
        sys.exit(2)
    if words[0] in ("-h", "--help"):
        print(f"{HEAD}\n\n{listing(commands)}")
        return
    if words[0] not in commands:
        refuse(words[0], commands)
    module = load(commands[words[0]].module)
    run_script(lambda: module.main(words[1:]), words[0], words[1:])
