# SPDX-License-Identifier: MIT
"""A config with a comment above each of its keys."""

import dataclasses
import json
import textwrap

WIDTH = 110


@dataclasses.dataclass
class Entry:
    """A key of a config. `remark` says why it has this value. `value` may be a list of Entry without a key,
    one for each object of a list."""

    key: str
    value: object
    remark: str

    def lines(self):
        """What the terminal says of it: the key with its value, and why."""
        if is_list_of_entries(self.value):
            return [f"{self.key}: {spaced(entry.value)}: {entry.remark}" for entry in self.value]
        return [f"{self.key}: {spaced(self.value)}: {self.remark}"]


def is_list_of_entries(value):
    return isinstance(value, list) and all(isinstance(entry, Entry) for entry in value) and bool(value)


def plain(entries):
    """The config as a dictionary."""
    return {entry.key: [one.value for one in entry.value] if is_list_of_entries(entry.value) else entry.value
            for entry in entries}


def spaced(value):
    return json.dumps(value, ensure_ascii=False)


def comment(text, indent):
    return textwrap.wrap(text, WIDTH, initial_indent=indent + "// ", subsequent_indent=indent + "// ",
                         break_long_words=False, break_on_hyphens=False)


def config_text(head, entries):
    lines = [*comment(head, ""), "{"]
    for number, entry in enumerate(entries):
        end = "," * (number + 1 < len(entries))
        if not is_list_of_entries(entry.value):
            lines += [*comment(entry.remark, "  "), f"  {json.dumps(entry.key)}: {spaced(entry.value)}{end}"]
            continue
        lines += [*comment(entry.remark, "  "), f"  {json.dumps(entry.key)}: ["]
        for place, one in enumerate(entry.value):
            lines += [*comment(one.remark, "    "), f"    {spaced(one.value)}{',' * (place + 1 < len(entry.value))}"]
        lines.append(f"  ]{end}")
    return "\n".join([*lines, "}", ""])
