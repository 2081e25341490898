# SPDX-License-Identifier: MIT
"""Boxes as STL and 3MF files for the scripts of this folder; run by itself: what stands in an STL file."""
import sys
import zipfile

CORNERS = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
TRIANGLES = [(0, 2, 1), (0, 3, 2), (4, 5, 6), (4, 6, 7), (0, 1, 5), (0, 5, 4),
             (1, 2, 6), (1, 6, 5), (2, 3, 7), (2, 7, 6), (3, 0, 4), (3, 4, 7)]


def box(origin, size, inwards=False):
    """Returns 12 triangles of three corners, counterclockwise from outside; from inside with `inwards`."""
    corners = [tuple(o + s * c for o, s, c in zip(origin, size, corner)) for corner in CORNERS]
    return [tuple(corners[i] for i in (reversed(triangle) if inwards else triangle)) for triangle in TRIANGLES]


def normal(triangle):
    """Returns the unit normal of a triangle that has an area."""
    a, b, c = triangle
    u, v = [q - p for p, q in zip(a, b)], [q - p for p, q in zip(a, c)]
    n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
    length = sum(x * x for x in n) ** 0.5
    return [x / length for x in n]


def write_stl(path, triangles):
    """Writes an ASCII STL file with the normals that the corners mean."""
    with open(path, "w") as file:
        file.write("solid part\n")
        for triangle in triangles:
            file.write("facet normal %.9g %.9g %.9g\nouter loop\n" % tuple(normal(triangle)))
            for corner in triangle:
                file.write("vertex %.9g %.9g %.9g\n" % corner)
            file.write("endloop\nendfacet\n")
        file.write("endsolid part\n")


def read_stl(path):
    """Returns the triangles of an ASCII STL file."""
    with open(path) as file:
        corners = [tuple(map(float, line.split()[1:])) for line in file if line.split()[:1] == ["vertex"]]
    return list(zip(corners[::3], corners[1::3], corners[2::3]))


def volume(triangles):
    """Returns the signed volume: negative if the triangles are inside out."""
    total = 0.0
    for a, b, c in triangles:
        total += a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])
    return total / 6


def extent(triangles):
    """Returns the extent as text: least to greatest coordinate along x, y, z."""
    corners = [corner for triangle in triangles for corner in triangle]
    return ", ".join("%.6g to %.6g" % (min(axis), max(axis)) for axis in zip(*corners))


def mesh_3mf(size=1):
    """Returns the XML of a 3MF mesh: a cube at the origin."""
    vertices = "".join('<vertex x="%g" y="%g" z="%g"/>' % tuple(size * c for c in corner) for corner in CORNERS)
    triangles = "".join('<triangle v1="%d" v2="%d" v3="%d"/>' % triangle for triangle in TRIANGLES)
    return f"<mesh><vertices>{vertices}</vertices><triangles>{triangles}</triangles></mesh>"


def write_3mf(path, resources, build, unit="millimeter"):
    """Writes a 3MF file with these resources and build items, given as XML."""
    types = ("application/vnd.openxmlformats-package.relationships+xml",
             "application/vnd.ms-package.3dmanufacturing-3dmodel+xml")
    package, core = "http://schemas.openxmlformats.org/package/2006/", "http://schemas.microsoft.com/3dmanufacturing/"
    head = '<?xml version="1.0" encoding="UTF-8"?>'
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as file:
        file.writestr("[Content_Types].xml", f'{head}<Types xmlns="{package}content-types"><Default Extension="rels" '
                      f'ContentType="{types[0]}"/><Default Extension="model" ContentType="{types[1]}"/></Types>')
        file.writestr("_rels/.rels", f'{head}<Relationships xmlns="{package}relationships"><Relationship Id="model" '
                      f'Target="/3D/3dmodel.model" Type="{core}2013/01/3dmodel"/></Relationships>')
        file.writestr("3D/3dmodel.model", f'{head}<model unit="{unit}" xml:lang="en-US" xmlns="{core}core/2015/02">'
                      f"<resources>{resources}</resources><build>{build}</build></model>")


if __name__ == "__main__":
    solid = read_stl(sys.argv[1])
    print("%s; %g mm3" % (extent(solid), volume(solid)))
