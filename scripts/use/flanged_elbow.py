#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Writes the voxels or the surface of a flanged elbow, in millimetres: two flanges, which are discs with a
bore, and a tube between them that bends by a right angle.

    scripts/use/flanged_elbow.py [--edge 5] FILE.h5
    scripts/use/flanged_elbow.py FILE.stl

The box is 230 x 160 x 205, the lower flange lies on its floor. The tube is 90 wide outside and 70 inside. In
the STL file (binary) the axis of the foot is at x = y = 0, and the three bodies overlap as they were drawn.
"""

import argparse

from fabseq_tools import find_python

find_python.require()  # before any package

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


def sweep(frames, inner, outer, around=72):
    """Triangles of a tube through circles: `frames` has centre and two unit vectors of each."""
    angle = 2 * np.pi * np.arange(around) / around
    rings = np.array([[centre + radius * (np.outer(np.cos(angle), u) + np.outer(np.sin(angle), v)) for radius in (inner, outer)]
                      for centre, u, v in frames])
    following = np.roll(rings, -1, axis=2)

    def strip(a, b, c, d):
        return np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])

    triangles = []
    for k in range(len(frames) - 1):
        triangles.append(strip(rings[k, 1], following[k, 1], following[k + 1, 1], rings[k + 1, 1]))
        triangles.append(strip(rings[k, 0], rings[k + 1, 0], following[k + 1, 0], following[k, 0]))
    triangles.append(strip(rings[0, 0], following[0, 0], following[0, 1], rings[0, 1]))
    triangles.append(strip(rings[-1, 0], rings[-1, 1], following[-1, 1], following[-1, 0]))
    return np.concatenate(triangles)


def surface():
    """Triangles, (n, corner, axis): the two flanges and the tube, each a closed surface."""
    def frame(x, z, turn):
        across = np.array([np.cos(turn), 0.0, -np.sin(turn)])
        return np.array([x, 0.0, z]), across, np.array([0.0, 1.0, 0.0])

    outlet, end = BEND_HEIGHT + BEND, SIZE[0] - FOOT[0]
    bend = [frame(BEND - BEND * np.cos(turn), BEND_HEIGHT + BEND * np.sin(turn), turn)
            for turn in np.linspace(0.0, np.pi / 2, 25)]
    tube = [frame(0.0, 0.0, 0.0), *bend, frame(end, outlet, np.pi / 2)]
    lower = [frame(0.0, 0.0, 0.0), frame(0.0, FLANGE_WIDTH, 0.0)]
    upper = [frame(end - FLANGE_WIDTH, outlet, np.pi / 2), frame(end, outlet, np.pi / 2)]
    return np.concatenate([sweep(tube, INNER, OUTER), sweep(lower, INNER, FLANGE_RADIUS), sweep(upper, INNER, FLANGE_RADIUS)])


def write_stl(path, triangles, title):
    """Binary STL, without normals, which follow from the corners."""
    record = np.zeros(len(triangles), dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    record["corners"] = triangles
    with open(path, "wb") as file:
        file.write(title.encode().ljust(80) + np.uint32(len(triangles)).tobytes() + record.tobytes())


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--edge", type=float, default=5.0, help="edge of an element; divides 230, 160 and 205")
    parser.add_argument("file")
    arguments = parser.parse_args()
    if arguments.file.endswith(".stl"):
        return write_stl(arguments.file, surface(), "flanged elbow, mm")
    counts = [round(size / arguments.edge) for size in SIZE]
    samples = 4  # along each axis of an element: it is part where more than half of them are inside
    axes = [(np.arange(samples * n) + 0.5) * arguments.edge / samples for n in counts]
    z, y, x = np.meshgrid(*reversed(axes), indexing="ij")
    fill = inside(x, y, z).reshape(counts[2], samples, counts[1], samples, counts[0], samples).mean((1, 3, 5))
    with h5py.File(arguments.file, "w") as file:
        file.create_dataset("density", data=(fill > 0.5).astype("uint8"), compression="gzip")


if __name__ == "__main__":
    main()
