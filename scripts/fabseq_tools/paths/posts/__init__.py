# SPDX-License-Identifier: MIT
"""Post-processors: programs of machines from the paths of a part.

A module of this folder with a line `POST = "name"` is the post-processor `name`; nothing else names it. It
has a docstring, whose first line stands in the help of `fabseq-tools paths`, and

- ENDINGS: of its files, a tuple; files with them that it does not write are removed from its folder.
- KEPT: names of files that are left as they are where they are there.
- add_options(group): adds its options to an argparse group.
- program_files(program, options): returns the texts of its files by name, one per layer and one that calls
  them. `program`: Program of programs.py. Raises RunError where the machine cannot do it."""

import argparse
import importlib
from pathlib import Path

from fabseq_tools.run.registered import registered


def find_posts(folder=Path(__file__).parent):
    """All post-processors' modules by name."""
    return {name: importlib.import_module(f"{__name__}.{path.stem}") for name, path in registered(folder, "POST").items()}


def summary(post):
    """The first line of its docstring."""
    return post.__doc__.splitlines()[0].rstrip(".")


def add_options(parser):
    """Adds --post and the options of all post-processors to a parser."""
    posts = find_posts()
    parser.add_argument("--post", action="append", default=[], choices=list(posts), metavar="NAME",
                        help="also writes a program for a machine, DIR/NAME; may be given several times: "
                        + "; ".join(f"{name}: {summary(post)}" for name, post in posts.items()))
    for name, post in posts.items():
        post.add_options(parser.add_argument_group(f"--post {name}"))
    return posts


def words_of(arguments):
    """Words of the command line that give another command the same of these options."""
    parser, words = argparse.ArgumentParser(), []
    add_options(parser)
    for name, usual in vars(parser.parse_args([])).items():
        value, option = getattr(arguments, name), f"--{name.replace('_', '-')}"
        for one in value if isinstance(value, list) else [value] * (value != usual):
            words.append(option if one is True else f"{option}={one}")
    return words
