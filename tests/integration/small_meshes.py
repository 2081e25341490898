# SPDX-License-Identifier: MIT
"""STL files of bodies of a few triangles."""

import itertools
import math


def box_triangles(low, high):
    corners = list(itertools.product(*zip(low, high)))
    for a, b, c, d in ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)):
        yield corners[a], corners[b], corners[c]
        yield corners[a], corners[c], corners[d]


def wedge_triangles(length, width, height):
    """It runs out to an edge at x = length."""
    corners = [(0, 0, 0), (length, 0, 0), (0, 0, height), (0, width, 0), (length, width, 0), (0, width, height)]
    faces = (0, 1, 2), (3, 5, 4), (0, 3, 4), (0, 4, 1), (1, 4, 5), (1, 5, 2), (0, 2, 5), (0, 5, 3)
    return [[corners[i] for i in face] for face in faces]


def cone_triangles(radius, height, around=24):
    """It stands on its point."""
    angles = [2 * math.pi * k / around for k in range(around)]
    rim = [(radius * math.cos(angle), radius * math.sin(angle), height) for angle in angles]
    for one, next_one in zip(rim, rim[1:] + rim[:1]):
        yield (0.0, 0.0, 0.0), next_one, one
        yield (0.0, 0.0, height), one, next_one


def write_stl(path, triangles):
    with open(path, "w", encoding="utf-8") as file:
        file.write("solid body\n")
        for triangle in triangles:
            vertices = "".join(f"vertex {x:g} {y:g} {z:g}\n" for x, y, z in triangle)
            file.write(f"facet normal 0 0 0\nouter loop\n{vertices}endloop\nendfacet\n")
        file.write("endsolid body\n")


def write_box(path, size):
    write_stl(path, box_triangles((0.0, 0.0, 0.0), size))
