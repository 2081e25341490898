#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Writes the surface of a bent bar on a foot, in millimetres, as a binary STL file.

    scripts/use/bent_bar.py FILE.stl

The foot, 120 x 80 x 20, lies on z = 0. The bar, 70 x 60, rises from its middle, bends by a right angle
towards x and goes on straight. The two bodies overlap as they were drawn.
"""

import argparse

from fabseq_tools import find_python

find_python.require()  # before any package

import numpy as np

from flanged_elbow import write_stl

FOOT = 120.0, 80.0, 20.0
BAR = 70.0, 60.0  # width in the plane of the bend, and across it
RISE, BEND, REACH = 70.0, 90.0, 60.0  # height of the upright, radius of the bar's axis, length behind the bend


def sweep(frames, width, depth):
    """Triangles of a bar through rectangles: `frames` has centre and two unit vectors of each."""
    corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) / 2 * (width, depth)
    rings = [centre + corners @ np.array(across) for centre, *across in frames]
    sides = [(rings[k][i], rings[k][j], rings[k + 1][j], rings[k + 1][i])
             for k in range(len(rings) - 1) for i, j in ((0, 1), (1, 2), (2, 3), (3, 0))]
    faces = np.array([rings[0][::-1], *sides, rings[-1]])
    return np.concatenate([faces[:, [0, 1, 2]], faces[:, [0, 2, 3]]])


def frame(x, z, turn):
    return np.array([x, 0.0, z]), np.array([np.cos(turn), 0.0, -np.sin(turn)]), np.array([0.0, 1.0, 0.0])


def surface():
    """Triangles, (n, corner, axis): the foot and the bar, each a closed surface."""
    bend = [frame(BEND * (1 - np.cos(turn)), RISE + BEND * np.sin(turn), turn) for turn in np.linspace(0.0, np.pi / 2, 25)]
    bar = [frame(0.0, 0.0, 0.0), *bend, frame(BEND + REACH, RISE + BEND, np.pi / 2)]
    foot = [frame(0.0, 0.0, 0.0), frame(0.0, FOOT[2], 0.0)]
    return np.concatenate([sweep(bar, *BAR), sweep(foot, *FOOT[:2])])


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("file")
    write_stl(parser.parse_args().file, surface(), "bent bar, mm")


if __name__ == "__main__":
    main()
