# SPDX-License-Identifier: MIT
"""Writes a CalculiX deck of bricks that shrink.

Each inherent strain is a thermal expansion under a temperature of 1 everywhere. The bricks are C3D8, which
ccx integrates with 2x2x2 points, as fabseq does. Elements of plane stress are one brick across the thickness
with no displacement along z, of a material whose sides do not narrow when it is pulled in the plane: stress
and strain in the plane are those of plane stress then. The elements CPS4 are not the same (4 % on a small
wall).
"""

import numpy as np

BRICK = (0, 1, 3, 2, 4, 5, 7, 6)  # corners around each face, from x fastest
PER_LINE = 12
DIGITS = 13                       # of a number: ccx reads 20 characters
DISTINCT = 10                     # digits by which materials differ


def write_deck(path, title, nodes, bricks, young, strain, poisson, plane, fixed):
    """`nodes`: positions (n, 3) by number; `bricks`: {element number: 8 node numbers}, as arrays (numbers,
    corners); `young`, `strain`: a number and a tensor (3, 3) per brick; `plane`: whether they are slabs;
    `fixed`: (node numbers, first axis, last axis), from 0. Files number nodes and elements from 1."""
    numbers, corners = bricks
    values, axes, turned = principal(strain, 2 if plane else 3)
    kinds, kind = distinct(np.column_stack([young, values]))
    groups = [(k, turn, (kind == k) & (turned == turn)) for k in range(len(kinds)) for turn in (False, True)]
    with open(path, "w", encoding="ascii", errors="replace") as file:
        file.write("".join(f"** {line}\n" for line in title))
        file.write("*NODE, NSET=ALL\n")
        for node in np.unique(corners):
            file.write(f"{node + 1}, " + ", ".join(map(figure, nodes[node])) + "\n")
        if turned.any():
            write_axes(file, numbers[turned], axes[turned])
        for k, turn, members in groups:
            if members.any():
                name = f"M{k + 1}" + "T" * turn
                file.write(f"*ELEMENT, TYPE=C3D8, ELSET={name}\n")
                for number, brick in zip(numbers[members], corners[members][:, BRICK]):
                    file.write(", ".join(map(str, (number + 1, *(brick + 1)))) + "\n")
                write_material(file, name, *kinds[k], poisson=poisson, plane=plane)
                file.write(f"*SOLID SECTION, ELSET={name}, MATERIAL={name}" + ", ORIENTATION=AXES" * turn + "\n")
        write_supports(file, fixed, plane)
        file.write("*INITIAL CONDITIONS, TYPE=TEMPERATURE\nALL, 0.\n*STEP\n*STATIC\n*TEMPERATURE\nALL, 1.\n"
                   "*NODE PRINT, NSET=ALL\nU\n*NODE FILE\nU\n*EL FILE\nS\n*END STEP\n")


def figure(value):
    text = f"{value:.{DIGITS}g}"
    return text if any(mark in text for mark in ".e") else text + "."


def principal(strain, dimension):
    """Principal strains (n, 3), and their directions (n, direction, axis), of which in 2D the last is z. A
    tensor that is diagonal stays as it is."""
    shear = np.abs(strain * (1 - np.eye(3))).max(axis=(1, 2))
    turned = shear > 1e-12 * np.abs(strain).max(axis=(1, 2))
    values, axes = np.diagonal(strain, axis1=1, axis2=2).copy(), np.tile(np.eye(3), (len(strain), 1, 1))
    values[turned, :dimension], columns = np.linalg.eigh(strain[turned, :dimension, :dimension])
    axes[turned, :dimension, :dimension] = columns.swapaxes(1, 2)
    return values, axes, turned


def distinct(rows):
    """Rows (modulus, expansions) that differ by more than rounding, and which of them each row is."""
    keys = np.column_stack([np.log(rows[:, 0]), rows[:, 1:] / max(np.abs(rows[:, 1:]).max(), 1e-300)])
    _, first, which = np.unique(keys.round(DISTINCT), axis=0, return_index=True, return_inverse=True)
    return rows[first], which.ravel()


def write_axes(file, numbers, axes):
    """Local axes of those elements, of which the first line gives the others'."""
    file.write("*DISTRIBUTION, NAME=TURNED\n, 1., 0., 0., 0., 1., 0.\n")
    for number, (first, second, _) in zip(numbers, axes):
        file.write(f"{number + 1}, " + ", ".join(map(figure, (*first, *second))) + "\n")
    file.write("*ORIENTATION, NAME=AXES\nTURNED\n")


def write_material(file, name, young, *expansion, poisson, plane):
    shear = figure(young / (2 + 2 * poisson))
    young, poisson = figure(young), figure(poisson)
    file.write(f"*MATERIAL, NAME={name}\n")
    if plane:
        constants = ", ".join([young] * 3 + [poisson, "0.", "0."] + [shear] * 2)
        file.write(f"*ELASTIC, TYPE=ENGINEERING CONSTANTS\n{constants}\n{shear}\n")
    else:
        file.write(f"*ELASTIC\n{young}, {poisson}\n")
    file.write("*EXPANSION, TYPE=ORTHO, ZERO=0.\n" + ", ".join(map(figure, expansion)) + "\n")


def write_supports(file, fixed, plane):
    for count, (nodes, first, last) in enumerate(fixed, start=1):
        file.write(f"*NSET, NSET=HELD{count}\n")
        for start in range(0, len(nodes), PER_LINE):
            file.write(", ".join(str(node + 1) for node in nodes[start:start + PER_LINE]) + "\n")
        file.write(f"*BOUNDARY\nHELD{count}, {first + 1}, {last + 1}\n")
    if plane:
        file.write("*BOUNDARY\nALL, 3, 3\n")
