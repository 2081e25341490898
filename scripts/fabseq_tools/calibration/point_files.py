# SPDX-License-Identifier: MIT
"""Points of meshes and clouds: the vertices of PLY, OBJ and STL files. Values are taken as they stand, also
those that are no numbers. `content`: the bytes of the file at a path, which is for messages."""

import re

import numpy as np

from fabseq_tools.calibration.point_columns import PointColumns, number_of
from fabseq_tools.run.command_line import RunError

XYZ = ["x", "y", "z"]
TYPES = {"char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4", "float": "f4", "double": "f8",
         "int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4", "float32": "f4",
         "float64": "f8"}
ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
STL_HEADER, STL_TRIANGLE = 84, np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("more", "<u2")])


def damaged(path, kind, found, allowed):
    return RunError(f"{path}: found {found}; allowed: {allowed} of an intact {kind} file")


class PlyHeader:
    """`order`: of bytes, "" for texts. `elements`: names, counts and properties, which are pairs of a name
    and a type; of a list a pair of types. `end`: where the values begin."""

    def __init__(self, path, content):
        found = re.match(rb"ply[ \t]*[\r\n].*?\bend_header[ \t]*(\r\n|\n|\r)", content, re.DOTALL)
        if not found:
            raise damaged(path, "PLY", "no header", "the lines ply ... end_header")
        self.order, self.elements, self.end = None, [], found.end()
        for line in re.split("[\r\n]+", found[0].decode("latin-1")):
            words = line.split()
            try:
                self.take(words)
            except (KeyError, IndexError, ValueError) as error:
                raise damaged(path, "PLY", f"'{line[:60]}'", "the header's lines") from error
        if self.order is None:
            raise damaged(path, "PLY", "no line format", f"one of {', '.join(ORDERS)}")

    def take(self, words):
        if words[:1] == ["format"]:
            self.order = ORDERS[words[1]]
        elif words[:1] == ["element"]:
            if not words[2].isdigit():
                raise ValueError
            self.elements.append((words[1], int(words[2]), []))
        elif words[:2] == ["property", "list"]:
            self.elements[-1][2].append((words[4], (TYPES[words[2]], TYPES[words[3]])))
        elif words[:1] == ["property"]:
            self.elements[-1][2].append((words[2], TYPES[words[1]]))


def read_ply(path, content):
    """The properties of the vertices."""
    header = PlyHeader(path, content)
    before = []
    for name, count, properties in header.elements:
        if name != "vertex":
            before.append((count, properties))
            continue
        names = [its.lower() for its, _ in properties]
        if any(isinstance(kind, tuple) for _, kind in properties) or len(set(names)) < len(names):
            raise damaged(path, "PLY", "a list, or two properties of one name, in element vertex", "single numbers")
        read = read_ply_binary if header.order else read_ply_text
        return PointColumns(path, names, read(path, content, header, before, count, properties))
    raise damaged(path, "PLY", "no element vertex", "one")


def read_ply_text(path, content, header, before, count, properties):
    lines = [line for line in content[header.end:].decode("latin-1").splitlines() if line.strip()]
    first = sum(number for number, _ in before)
    lines = lines[first:first + count]
    if len(lines) < count:
        raise damaged(path, "PLY", f"{len(lines)} of {count} points", "all")
    rows = []
    for number, line in enumerate(lines, start=1):
        row = list(map(number_of, line.split()))
        if len(row) != len(properties) or None in row:
            raise damaged(path, "PLY", f"'{line[:60]}' as point {number}", f"{len(properties)} numbers")
        rows.append(row)
    return np.array(rows, float).reshape(count, len(properties))


def read_ply_binary(path, content, header, before, count, properties):
    position = header.end
    for number, its in before:
        position = behind(path, content, header.order, position, number, its)
    kind = np.dtype([(f"{i}", header.order + its) for i, (_, its) in enumerate(properties)])
    there = max(len(content) - position, 0) // max(kind.itemsize, 1)
    if there < count:
        raise damaged(path, "PLY", f"{there} of {count} points", "all")
    values = np.frombuffer(content, kind, count, position)
    return np.stack([values[name].astype(float) for name in kind.names], axis=1) if properties else np.empty((count, 0))


def behind(path, content, order, position, count, properties):
    """Where `count` elements end that begin at `position`."""
    if not any(isinstance(kind, tuple) for _, kind in properties):
        return position + count * sum(np.dtype(kind).itemsize for _, kind in properties)
    for _ in range(count):
        for _, kind in properties:
            length = 1
            if isinstance(kind, tuple):
                size, kind = np.dtype(order + kind[0]), kind[1]
                if position + size.itemsize > len(content):
                    raise damaged(path, "PLY", "an end before the points", "all of its elements")
                length = int(np.frombuffer(content, size, 1, position)[0])
                position += size.itemsize
            if length < 0:
                raise damaged(path, "PLY", f"a list of {length} numbers", "0 and more")
            position += length * np.dtype(kind).itemsize
    return position


def read_obj(path, content):
    """The lines v."""
    rows = []
    for number, line in enumerate(content.decode("latin-1").splitlines(), start=1):
        words = line.split()
        if words[:1] != ["v"]:
            continue
        row = list(map(number_of, words[1:4]))
        if len(row) < 3 or None in row:
            raise damaged(path, "OBJ", f"'{line.strip()[:60]}' in line {number}", "v and three numbers")
        rows.append(row)
    return PointColumns(path, XYZ, np.array(rows, float).reshape(-1, 3))


def read_stl(path, content):
    """The corners of the triangles."""
    count = int.from_bytes(content[80:84], "little") if len(content) >= STL_HEADER else -1
    if len(content) == STL_HEADER + count * STL_TRIANGLE.itemsize:
        triangles = np.frombuffer(content, STL_TRIANGLE, count, STL_HEADER)
        return PointColumns(path, XYZ, triangles["corners"].reshape(-1, 3).astype(float))
    if not content.lstrip()[:5].lower() == b"solid" or b"\0" in content:
        raise damaged(path, "STL", f"{len(content)} bytes", f"{STL_HEADER} and {STL_TRIANGLE.itemsize} for each triangle, "
                      "or texts")
    rows = [list(map(number_of, line.split()[1:])) for line in content.decode("latin-1").lower().splitlines()
            if line.split()[:1] == ["vertex"]]
    if any(len(row) != 3 or None in row for row in rows) or len(rows) % 3 or b"endsolid" not in content.lower():
        raise damaged(path, "STL", "an end within a triangle, or a line vertex without its numbers",
                      "three corners of three numbers")
    return PointColumns(path, XYZ, np.array(rows, float).reshape(-1, 3))
