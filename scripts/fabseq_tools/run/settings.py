# SPDX-License-Identifier: MIT
"""The settings of a run, by path, and in which of them runs differ."""

from fabseq_tools.run.command_line import RunError

NOT_COMPARED = ("name", "run", "output")  # keys of a config that do not change the result


def flat(value, path=""):
    """(path as of -set, value) of a config's entries. Entries of lists go by their type if it is unique."""
    if isinstance(value, (dict, list)):
        for key, entry in value.items() if isinstance(value, dict) else zip(entry_names(value), value):
            yield from flat(entry, f"{path}.{key}" if path else str(key))
    else:
        yield path, value


def differing_keys(runs):
    """In the order of their `settings`; a key that only some of them have counts, too."""
    keys = dict.fromkeys(key for run in runs for key in run.settings)
    return [key for key in keys if len({repr(run.settings.get(key)) for run in runs}) > 1]


def put(config, path, value, place):
    """Sets an entry of a config by its path, as -set does. `place`: of the config, for messages."""
    *parents, last = path.split(".")
    entry = config
    for name in parents:
        entry = entry[index_of(entry, name, path, place)] if isinstance(entry, list) else entry.setdefault(name, {})
        if not isinstance(entry, (dict, list)):
            raise RunError(f"{place}: {path}: found {entry!r} for {name}; allowed: an object or a list")
    entry[index_of(entry, last, path, place) if isinstance(entry, list) else last] = value


def index_of(entries, name, path, place):
    """Of the entry with that number, or the first of that type."""
    types = [entry.get("type") if isinstance(entry, dict) else None for entry in entries]
    found = [number for number, kind in enumerate(types) if name in (str(number), kind)]
    if not found:
        raise RunError(f"{place}: {path}: found no entry {name}; allowed: a number or a type of the list")
    return found[0]


def entry_names(entries):
    types = [entry.get("type") if isinstance(entry, dict) else None for entry in entries]
    return [kind if kind and types.count(kind) == 1 else number for number, kind in enumerate(types)]
