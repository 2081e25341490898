#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Writes the voxels of a flanged elbow, in millimetres: two flanges, which are discs with a bore, and a tube
between them that bends by a right angle.

    scripts/figures/flanged_elbow.py [--edge 5] FILE.h5

The box is 230 x 160 x 205, the lower flange lies on its floor. The tube is 90 wide outside and 70 inside.
"""

import argparse

import h5py
import numpy as np

SIZE = 230, 160, 205
FLANGE_RADIUS, FLANGE_WIDTH = 80.0, 15.0
OUTER, INNER = 45.0, 35.0  # radii of the tube
BEND, BEND_HEIGHT = 90.0, 35.0  # radius of the tube's axis, height at which the bend begins
FOOT = 80.0, 80.0  # where the axis starts, x and y


def inside(x, y, z):
    """Whether points lie in the part."""
    x, y = x - FOOT[0], y - FOOT[1]
    outlet = BEND_HEIGHT + BEND
    in_upright, in_outlet = z < BEND_HEIGHT, x > BEND
    # Distance from the tube's axis: upright, bend, outlet.
    distance = np.where(in_upright, np.hypot(x, y),
                        np.where(in_outlet, np.hypot(y, z - outlet),
                                 np.hypot(np.hypot(x - BEND, z - BEND_HEIGHT) - BEND, y)))
    in_bend = ~in_upright & ~in_outlet
    behind = in_bend & (z < BEND_HEIGHT)
    flanges = ((z < FLANGE_WIDTH) & (np.hypot(x, y) < FLANGE_RADIUS)
               | (x > SIZE[0] - FOOT[0] - FLANGE_WIDTH) & (np.hypot(y, z - outlet) < FLANGE_RADIUS))
    # The bore goes through both flanges.
    bore = (in_upright & (np.hypot(x, y) < INNER)) | (in_outlet & (np.hypot(y, z - outlet) < INNER))
    return ((distance < OUTER) & (distance > INNER) & ~behind | flanges) & ~bore


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--edge", type=float, default=5.0, help="edge of an element; divides 230, 160 and 205")
    parser.add_argument("file")
    arguments = parser.parse_args()
    counts = [round(size / arguments.edge) for size in SIZE]
    samples = 4  # along each axis of an element: it is part where more than half of them are inside
    axes = [(np.arange(samples * n) + 0.5) * arguments.edge / samples for n in counts]
    z, y, x = np.meshgrid(*reversed(axes), indexing="ij")
    fill = inside(x, y, z).reshape(counts[2], samples, counts[1], samples, counts[0], samples).mean((1, 3, 5))
    with h5py.File(arguments.file, "w") as file:
        file.create_dataset("density", data=(fill > 0.5).astype("uint8"), compression="gzip")


if __name__ == "__main__":
    main()
