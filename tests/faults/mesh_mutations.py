# SPDX-License-Identifier: MIT
"""Mesh files with something wrong in them: STL, OBJ, PLY and 3MF of a small part, changed at random."""

import io
import re
import struct
import zipfile

FORMATS = ("stl", "text.stl", "obj", "ply", "text.ply", "3mf")
EXTREMES = ["nan", "inf", "-1e308", "1e-320", "0", "-1", "2147483648", "99999999999999999999", "1e3", "1,5", "", "x"]
WORDS = [b"\0\0\xc0\x7f", b"\0\0\x80\x7f", b"\xff\xff\xff\xff", b"\0\0\0\0", b"\xff\xff\x7f\x7f"]  # NaN, infinity, ...
PACKAGES = "http://schemas.openxmlformats.org/package/2006"
NAMESPACE = "http://schemas.microsoft.com/3dmanufacturing"


def tube():
    """Corners and triangles of a box with a square hole along z, 60 x 20 x 20."""
    outer, inner = [(0, 0), (60, 0), (60, 20), (0, 20)], [(20, 5), (40, 5), (40, 15), (20, 15)]
    corners = [(x, y, z) for z in (0, 20) for x, y in outer + inner]
    triangles = []
    for i in range(4):
        j = (i + 1) % 4
        for a, b, c, d in ((i, j, j + 8, i + 8), (j + 4, i + 4, i + 12, j + 12), (j, i, i + 4, j + 4),
                           (i + 8, j + 8, j + 12, i + 12)):
            triangles += [(a, b, c), (a, c, d)]
    return corners, triangles


def three_mf(model, others=()):
    types = (f'<Types xmlns="{PACKAGES}/content-types">'
             '<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
             '<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>')
    relations = (f'<Relationships xmlns="{PACKAGES}/relationships"><Relationship Id="r" Target="/3D/3dmodel.model" '
                 f'Type="{NAMESPACE}/2013/01/3dmodel"/></Relationships>')
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in (("[Content_Types].xml", types), ("_rels/.rels", relations), ("3D/3dmodel.model", model), *others):
            archive.writestr(zipfile.ZipInfo(name), text)
    return buffer.getvalue()


def model_text(corners, triangles):
    """The part in two objects, one of which has the other as a component, and an item that is not printed."""
    vertices = "".join(f'<vertex x="{x}" y="{y}" z="{z}"/>' for x, y, z in corners)
    faces = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in triangles)
    return (f'<model unit="millimeter" xmlns="{NAMESPACE}/core/2015/02"><resources><object id="1" type="model"><mesh>'
            f'<vertices>{vertices}</vertices><triangles>{faces}</triangles></mesh></object><object id="2"><components>'
            '<component objectid="1" transform="1 0 0 0 1 0 0 0 1 0 0 0"/></components></object></resources><build>'
            '<item objectid="2"/><item objectid="1" printable="0"/></build></model>')


def whole(form):
    """The bytes of the part in a format; of 3MF, those of its model."""
    corners, triangles = tube()
    points = [[corners[corner] for corner in triangle] for triangle in triangles]
    if form == "stl":
        return bytes(80) + struct.pack("<I", len(triangles)) + b"".join(
            struct.pack("<12fH", 0, 0, 0, *(x for point in three for x in point), 0) for three in points)
    if form == "text.stl":
        facets = "".join("facet normal 0 0 0\nouter loop\n" + "".join("vertex {:e} {:e} {:e}\n".format(*p) for p in three)
                         + "endloop\nendfacet\n" for three in points)
        return f"solid part\n{facets}endsolid part\n".encode()
    if form == "obj":
        return ("".join(f"v {x} {y} {z}\n" for x, y, z in corners)
                + "".join(f"f {a + 1} {b + 1}// {c + 1}\n" for a, b, c in triangles)).encode()
    if form == "3mf":
        return model_text(corners, triangles).encode()
    binary = form == "ply"
    head = (f"ply\nformat {'binary_little_endian' if binary else 'ascii'} 1.0\nelement vertex {len(corners)}\n"
            f"property float x\nproperty float y\nproperty float z\nelement face {len(triangles)}\n"
            "property list uchar int vertex_indices\nend_header\n").encode()
    if binary:
        return head + b"".join(struct.pack("<3f", *p) for p in corners) + b"".join(struct.pack("<B3i", 3, *t) for t in triangles)
    return head + ("".join("{} {} {}\n".format(*p) for p in corners)
                   + "".join("3 {} {} {}\n".format(*t) for t in triangles)).encode()


def flip_bits(chance, data):
    for _ in range(chance.choice([1, 1, 3, 30])):
        place = chance.randrange(len(data))
        data[place] ^= 1 << chance.randrange(8)
    return "bits"


def cut(chance, data):
    del data[chance.randrange(len(data)):]
    return "cut off"


def remove(chance, data):
    place = chance.randrange(len(data))
    del data[place:place + chance.choice([1, 4, 50, 400])]
    return "a piece removed"


def repeat(chance, data):
    place, length = chance.randrange(len(data)), chance.choice([1, 12, 50, 1000])
    data[place:place] = data[place:place + length] * chance.choice([1, 2, 50])
    return "a piece repeated"


def put_bytes(chance, data):
    place = chance.randrange(len(data) + 1)
    data[place:place] = chance.choice([b"\n", b"\r\n", b"\0", b"\xff\xff\xff\xff", b"\xef\xbb\xbf", b" ", b"\n\n\n", b"<", b'"'])
    return "bytes put in"


def other_number(chance, data):
    """Text: a number; else four bytes of it."""
    numbers = list(re.finditer(rb"-?\d+(\.\d+)?(e[+-]?\d+)?", bytes(data)))
    if len(numbers) < 50:
        place = chance.randrange(max(1, len(data) - 4))
        data[place:place + 4] = chance.choice(WORDS)
        return "four bytes"
    found = chance.choice(numbers)
    data[found.start():found.end()] = chance.choice(EXTREMES).encode()
    return "a number"


def other_case(chance, data):
    data[:] = chance.choice([bytes.upper, bytes.lower, bytes.title])(bytes(data))
    return "letters"


def swap(chance, data):
    a, b = sorted(chance.randrange(len(data)) for _ in range(2))
    length = chance.choice([4, 12, 50])
    data[a:a + length], data[b:b + length] = data[b:b + length], data[a:a + length]
    return "two pieces swapped"


CHANGES = (flip_bits, cut, remove, repeat, put_bytes, other_number, other_number, other_number, other_case, swap)


def changed_mesh(chance):
    """A name, the bytes of the file, and what was done to it."""
    form = chance.choice(FORMATS)
    data, told = bytearray(whole(form)), []
    in_archive = form == "3mf" and chance.random() < 0.3
    if in_archive:
        data = bytearray(three_mf(bytes(data)))
    for _ in range(chance.choices([0, 1, 2, 3], [2, 68, 20, 10])[0]):
        if data:
            told.append(chance.choice(CHANGES)(chance, data))
    if form == "3mf" and not in_archive:
        data = three_mf(bytes(data))
    return "part." + form.rpartition(".")[2], bytes(data), f"{form}: " + ", ".join(told)
