# SPDX-License-Identifier: MIT
"""The settings of a run, by path, and in which of them runs differ."""

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


def entry_names(entries):
    types = [entry.get("type") if isinstance(entry, dict) else None for entry in entries]
    return [kind if kind and types.count(kind) == 1 else number for number, kind in enumerate(types)]
