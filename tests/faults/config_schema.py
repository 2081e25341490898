# SPDX-License-Identifier: MIT
"""Which keys a config may have, and legal values of them, extreme ones among them: from `fabseq
-help_markdown`."""

import dataclasses
import re
import subprocess

CODES = r"`[^`]+`(?:, `[^`]+`)*"
ENTRY = re.compile(rf"- `(?P<name>[^`]+)`(?: \((?P<variants>{CODES})\))?: .*\. "
                   r"(?:Required|Optional|Default `[^`]*`)(?:, in 2D `[^`]*`)?(?:; (?P<allowed>.*))?\.$")
REFERENCE = re.compile(rf"- (?P<names>{CODES}) \(`(?P<variant>[^`]+)`\): as in `(?P<section>[^`]+)`\.$")
NUMBERS = re.compile(r"(an?|a list of two ascending|a list of 2 or 3) (number|integer)s?( ?(?:in|>=|>) ?.*)?$")
TEXTS = ("x", "ü ñ €", "a/b", "..", " ", "-x", "name with spaces", "'; \"quoted\" \\", "n" * 300, "%s%n", "tab\there")
# What a run costs is not what is looked for.
MOST = {"max_iterations": 3, "coarse_iterations": 2, "binary_iterations": 3, "count": 12, "layers": 12, "subparts": 6,
        "sampling": 3, "coarse_grids": 2, "start_iterations": 2}


@dataclasses.dataclass
class Key:
    """`section`: its dotted path; `variant`: the type of the object that it stands in, None for all;
    `option`: the flat one, None for most."""

    section: str
    name: str
    variant: str
    allowed: str
    option: str


def parse(markdown):
    """List of keys."""
    keys, section = [], ""
    text = re.sub(r"\n  (?=\S)", " ", markdown)
    for line in text.splitlines():
        if line.startswith("### "):
            path = re.match(r"### `([^`]+)`", line)
            section = path.group(1) if path else ""
        entry, reference = ENTRY.match(line), REFERENCE.match(line)
        if entry:
            values = entry["allowed"] or ""  # none of a section
            allowed = re.sub(r"( \[[^\],]*\])?(; `-[^`]*`)?$", "", values)
            option = re.search(r"; `(-[^`]+)`$", values)
            for variant in re.findall("`([^`]+)`", entry["variants"] or "") or [None]:
                keys.append(Key(section, entry["name"], variant, re.sub(r" \(only in .D\)$", "", allowed), option and option[1]))
        if reference:
            names = re.findall("`([^`]+)`", reference["names"])
            keys += [dataclasses.replace(key, section=section) for key in keys
                     if (key.section, key.variant) == (reference["section"], reference["variant"]) and key.name in names]
    return keys


def read_keys(program):
    return parse(subprocess.run([program, "-help_markdown"], stdout=subprocess.PIPE, text=True, check=True).stdout)


def limits(text):
    """Least and largest number in a range such as "in [0, 1)" or "> 0", ends left out where they are open."""
    interval = re.search(r"in ([\[(])([^,]+), ([^\])]+)([\])])", text or "")
    if interval:
        low, high = float(interval[2]), float(interval[3])
        tiny = 1e-9 * (high - low)
        return low + (tiny if interval[1] == "(" else 0), high - (tiny if interval[4] == ")" else 0)
    bound = re.search(r"(>=|>) (-?[0-9.]+)", text or "")
    if bound:
        return float(bound[2]) + (1e-9 if bound[1] == ">" else 0), 1e9
    return -1e9, 1e9


def number(chance, text, whole, most):
    low, high = limits(text)
    high = min(high, most) if most is not None else high
    value = chance.choice([low, high, chance.uniform(low, high), chance.uniform(max(low, -10), min(high, 10)),
                           low + (high - low) * 10**chance.uniform(-12, 0)])
    return round(value) if whole else value


def near(chance, key, value):
    """A legal number, larger or smaller than `value` by a few orders of magnitude."""
    other = value * 10**chance.uniform(-4, 4)
    text = re.search(r"(number|integer)( ?(?:in|>=|>) ?.*)?$", key.allowed)
    low, high = limits(text and text[2])
    other = min(max(other, low), high, MOST.get(key.name, high))
    return round(other) if isinstance(value, int) else other


def legal_value(chance, key, dimension):
    """A value that the key's own range allows; None where only the key's section knows what that is."""
    allowed = key.allowed
    word = re.match(r'"([^"]+)" or (.*)', allowed)
    if word:
        if chance.random() < 0.3:
            return word[1]
        allowed = word[2]
    if allowed == "true or false":
        return chance.choice([True, False])
    if allowed == "a text":
        return chance.choice(TEXTS)
    numbers = NUMBERS.match(allowed)
    if numbers:
        values = [number(chance, numbers[3], numbers[2] == "integer", MOST.get(key.name)) for _ in range(dimension)]
        return {"an": values[0], "a": values[0], "a list of two ascending": sorted(values[:2])}.get(numbers[1], values)
    some = re.match("a list of some of (.*)", allowed)
    if some:
        return [name for name in some[1].split(", ") if chance.random() < 0.5]
    if allowed.startswith("a list of lists of 2 or 3 numbers"):
        return [[number(chance, ">= 0", False, 10) for _ in range(dimension)] for _ in range(chance.randrange(4))]
    if re.fullmatch(r"[a-z_+-]+(, [a-z_+-]+)+", allowed):
        return chance.choice(allowed.split(", "))
    return None
