#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Writes the surface of a pipe bend on a flange, in millimetres, as a binary STL file.

    scripts/figures/pipe_bend.py FILE.stl [--turn 90]

The flange, a disc with a bore, lies on z = 0 around the origin. The pipe is 90 wide outside and 60 inside; it
rises, bends by --turn degrees towards x and goes on straight. The two bodies overlap as they were drawn.
"""

import argparse

import needs_packages  # noqa: F401 (before any package)

import numpy as np

from flanged_elbow import sweep, write_stl

FLANGE_RADIUS, FLANGE_WIDTH = 75.0, 15.0
OUTER, INNER = 45.0, 30.0  # radii of the pipe
BEND, BEND_HEIGHT = 90.0, 40.0  # radius of the pipe's axis, height at which the bend begins
STRAIGHT = 40.0  # behind the bend


def frame(x, z, turn):
    """Centre of a circle and two unit vectors in its plane, across an axis that has turned by so much."""
    return np.array([x, 0.0, z]), np.array([np.cos(turn), 0.0, -np.sin(turn)]), np.array([0.0, 1.0, 0.0])


def surface(turn):
    """Triangles, (n, corner, axis): the flange and the pipe, each a closed surface."""
    bend = [frame(BEND * (1 - np.cos(angle)), BEND_HEIGHT + BEND * np.sin(angle), angle) for angle in np.linspace(0, turn, 25)]
    centre, _, _ = bend[-1]
    end = frame(centre[0] + STRAIGHT * np.sin(turn), centre[2] + STRAIGHT * np.cos(turn), turn)
    pipe = sweep([frame(0.0, 0.0, 0.0), *bend, end], INNER, OUTER)
    flange = sweep([frame(0.0, 0.0, 0.0), frame(0.0, FLANGE_WIDTH, 0.0)], INNER, FLANGE_RADIUS)
    return np.concatenate([pipe, flange])


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--turn", type=float, default=90.0, help="degrees by which the pipe bends")
    parser.add_argument("file")
    arguments = parser.parse_args()
    write_stl(arguments.file, surface(np.radians(arguments.turn)), "pipe bend, mm")


if __name__ == "__main__":
    main()
