# SPDX-License-Identifier: MIT
"""One wrong thing, or an extreme one, in a config. Each function of TREE and LEGAL changes a config (a dict)
in place, each of TEXT returns other bytes in place of a config's; all say what they did."""

import json

from config_schema import legal_value, near


class Raw(str):
    """Text that stands in the file as it is."""


class Pairs(list):
    """Members of an object, names and values, where a name may come twice."""


NUMBERS = (0, -1, 0.5, 1, 2, 3, 7, 1e300, -1e300, 1e-300, 5e-324, 1e40, 1e-40, 1e-12, 1e12, 2147483647, 2147483648,
           -2147483649, Raw("9223372036854775808"), Raw("1e999"), Raw("-1e999"), Raw("NaN"), Raw("Infinity"), Raw("-Infinity"),
           Raw("nan"),
           Raw("0x10"), Raw("1."), Raw("01"), Raw("1e"), Raw("-0.0"), Raw("9" * 400), "NaN", "inf", "1", "1e3")
VALUES = ("", "text", "auto", "../x", True, False, None, [], {}, [1], [[]], [None], {"a": 1}, {"": 0}, 3, -0.5,
          [1, 2, 3, 4], [[1, 2], [3, 4]], {"type": "distortion"}, {"box": {"min": [0, 0], "max": [1, 1]}})
STRINGS = ("", " ", "auto", "none", "z", "x", "N" * 5000, "ä\u0000b", "\ud7ff", "../../..", "heat ", "HEAT", "1", "\n",
           "%d", "-x")


def dumps(value):
    """JSON text, but for Raw and Pairs."""
    if isinstance(value, Raw):
        return str(value)
    if isinstance(value, (dict, Pairs)):
        members = value.items() if isinstance(value, dict) else value
        return "{" + ", ".join(f"{json.dumps(name)}: {dumps(item)}" for name, item in members) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(dumps(item) for item in value) + "]"
    return json.dumps(value)


def places(node, path=()):
    """All values below a node: container, key and path of each."""
    items = node.items() if isinstance(node, dict) else enumerate(node) if isinstance(node, list) else ()
    for key, value in items if not isinstance(node, Pairs) else ():
        yield node, key, (*path, str(key))
        yield from places(value, (*path, str(key)))


def chosen(chance, config, wanted=lambda value: True):
    """A place with such a value."""
    found = [place for place in places(config) if wanted(place[0][place[1]])]
    return chance.choice(found) if found else (config, "name", ("name",))


def shown(value):
    text = dumps(value)
    return text if len(text) < 60 else text[:57] + "..."


def put(place, value):
    container, key, path = place
    container[key] = value
    return f"/{'/'.join(path)} = {shown(value)}"


def is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def other_number(chance, config, _):
    place = chosen(chance, config, is_number)
    value = place[0][place[1]]
    near = (-value, 10 * value, value / 10, value + 1, value * (1 + 1e-7)) if is_number(value) else ()
    return put(place, chance.choice(near) if near and chance.random() < 0.3 else chance.choice(NUMBERS))


def legal_number(chance, config, _):
    """A number of which JSON at least thinks nothing."""
    return put(chosen(chance, config, is_number), chance.choice([0, -1, 1, 2, 5, 1e-3, 1e-6, 1e-12, 1e3, 1e6, 1e12, 1e30, 1e-30]))


def other_type(chance, config, _):
    return put(chosen(chance, config), chance.choice(VALUES))


def other_string(chance, config, _):
    return put(chosen(chance, config, lambda value: isinstance(value, str)), chance.choice(STRINGS))


def deleted_key(chance, config, _):
    container, key, path = chosen(chance, config)
    del container[key]
    return f"no /{'/'.join(path)}"


def repeated_key(chance, config, _):
    place = chosen(chance, config, lambda value: isinstance(value, dict) and value)
    if not isinstance(place[0][place[1]], dict):
        return put(place, 0)
    members = Pairs(place[0][place[1]].items())
    name = chance.choice(members)[0]
    members.insert(chance.randrange(len(members) + 1), (name, chance.choice(VALUES)))
    return put(place, members) + f" with {name} twice"


def misspelt(chance, word):
    at = chance.randrange(len(word)) if word else 0
    return chance.choice([word[:at] + word[at + 1:], word[:at] + word[at:at + 1] + word[at:], word.upper(), word + " ",
                          word[:at] + word[at + 1:at + 2] + word[at:at + 1] + word[at + 2:], word[:at] + "é" + word[at + 1:]])


def misspelt_key(chance, config, _):
    container, key, path = chosen(chance, config)
    if isinstance(container, list):
        return put((container, key, path), chance.choice(VALUES))
    name = misspelt(chance, key)
    container[name] = container.pop(key)
    return f"/{'/'.join(path)} named {name!r}"


def unknown_key(chance, config, keys):
    container, _, path = chosen(chance, config, lambda value: True)
    name = chance.choice(["unknown", "", "a.b", "a/b~c", "ключ", *(key.name for key in keys)])
    if isinstance(container, list):
        container.append({name: 1})
        return f"/{'/'.join(path[:-1])} with an entry {name!r}"
    container[name] = chance.choice(VALUES)
    return f"/{'/'.join(path[:-1])} with {name!r} = {shown(container[name])}"


def other_length(chance, config, _):
    place = chosen(chance, config, lambda value: isinstance(value, list) and value)
    value = place[0][place[1]]
    if not isinstance(value, list):
        return put(place, [])
    return put(place, chance.choice([value[:-1], value + value[-1:], value * 2, [], value[:1], value[::-1], value * 50, [value]]))


def swapped(chance, config, _):
    one, other = chosen(chance, config), chosen(chance, config)
    first, second = one[0][one[1]], other[0][other[1]]
    if dumps(first) in dumps(second) or dumps(second) in dumps(first):  # one may stand in the other
        return put(one, chance.choice(VALUES))
    one[0][one[1]], other[0][other[1]] = second, first
    return f"/{'/'.join(one[2])} and /{'/'.join(other[2])} swapped"


def containers(config, key):
    """Objects of the config that the key may stand in."""
    if key.section in ("objective", "constraints"):
        return [entry for entry in config.get(key.section, []) if isinstance(entry, dict)
                and key.variant in (None, entry.get("type"))]
    if key.section.startswith("node_sets."):
        return [node_set for node_set in config.get("node_sets", {}).values() if isinstance(node_set, dict)]
    if key.section == "shape" or key.section.startswith("shape.") or key.name == "elements":
        return []
    node = config
    for name in filter(None, key.section.split(".")):
        node = node.setdefault(name, {}) if name not in ("voxels", "mesh") else node.get(name)
        if not isinstance(node, dict):
            return []
    return [node] if key.variant in (None, node.get("type", "curved" if key.section == "layers" else None)) else []


# Keys that only go with a mesh, or with one measure.
FOR_FEW = ("type", "to", "nodes", "axis", "distance", "element", "margin", "all", "near")


def legal_values(chance, config, keys):
    """Up to five keys with values from the ends of their ranges."""
    told = []
    for _ in range(100):
        key = chance.choice(keys)
        if key.name in FOR_FEW:
            continue
        value = legal_value(chance, key, len(config["domain"]["size"]))
        try:
            found = containers(config, key)
        except (AttributeError, TypeError):  # an earlier change left something else there
            continue
        if value is None or not found:
            continue
        chosen_one = chance.choice(found)
        if is_number(value) and is_number(chosen_one.get(key.name)) and chance.random() < 0.6:
            value = near(chance, key, chosen_one[key.name])
        chosen_one[key.name] = value
        told.append(f"{key.section}.{key.name} = {shown(value)}")
        if len(told) == 5 or chance.random() < 0.5:
            break
    return "legal: " + ", ".join(told)


def new_term(chance, config, keys):
    """An objective term or a constraint of any type."""
    section = chance.choice(["objective", "constraints"])
    types = {key.variant for key in keys if key.section == section and key.variant}
    term = {"type": chance.choice(sorted(types))}
    for key in keys:
        value = legal_value(chance, key, len(config["domain"]["size"]))
        fits = key.section == section and key.variant == term["type"] and key.name not in FOR_FEW
        if fits and value is not None and chance.random() < 0.25:
            term[key.name] = value
    for key in ("target", "limit"):
        if key in term or (term["type"], key) in (("layer_thickness", "target"), ("distortion", "limit")):
            term[key] = 10**chance.uniform(-6, 3)
    if term["type"] == "distortion" or chance.random() < 0.1:
        term["nodes"] = chance.choice([*config.get("node_sets", {}), "nowhere"])
    entries = config.setdefault(section, [])
    entries.insert(chance.randrange(len(entries) + 1), term)
    return f"/{section} with {shown(term)}"


def nested(chance, config, _):
    """Shapes within shapes, or lists within lists."""
    depth = chance.choice([5, 20, 60, 63, 70, 1000])
    place = chosen(chance, config)
    kind = chance.choice(["union", "intersection", "difference", "list"])
    text = dumps(place[0][place[1]])
    opening, closing = ("[", "]") if kind == "list" else (f'{{"{kind}": [', "]}")
    place[0][place[1]] = Raw(opening * depth + text + closing * depth)
    return f"/{'/'.join(place[2])} within {depth} of {kind}"


TREE = (other_number, other_number, other_number, other_type, other_string, deleted_key, repeated_key, misspelt_key,
        unknown_key, other_length, swapped, nested)
LEGAL = (legal_values, legal_values, new_term, legal_number)


def cut_off(chance, content):
    at = chance.randrange(len(content))
    return content[:at], f"cut off after {at} bytes"


def inserted(chance, content):
    what = chance.choice([b"\xff", b"\xc3", b"\x00", b"\xed\xa0\x80", b"\xef\xbb\xbf", b",", b"}", b"]", b"{", b"[", b'"', b"\\",
                          b"//", b"/*", b"/* x */", b"-", b"\x0b", "\u2028".encode()])
    at = chance.choice([0, len(content), chance.randrange(len(content))])
    return content[:at] + what + content[at:], f"{what!r} put in after {at} bytes"


def other_byte(chance, content):
    at, value = chance.randrange(len(content)), chance.randrange(256)
    return content[:at] + bytes([value]) + content[at + 1:], f"byte {at} is {value}"


def removed(chance, content):
    at, count = chance.randrange(len(content)), chance.randrange(1, 40)
    return content[:at] + content[at + count:], f"{count} bytes left out after {at}"


def something_else(chance, _):
    what = chance.choice([b"", b" ", b"null", b"[]", b"{}", b"1", b'"text"', b"[" * 100000, b'{"a":' * 100000, b"\x00" * 1000,
                          b"// only a comment", b"{}{}", b"\x89HDF\r\n\x1a\n", "{}".encode("utf-16")])
    return what, f"{what[:20]!r}, {len(what)} bytes, in place of the file"


TEXT = (cut_off, inserted, other_byte, removed, something_else)
