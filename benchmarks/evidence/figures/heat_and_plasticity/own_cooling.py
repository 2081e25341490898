# SPDX-License-Identifier: MIT
"""A linear model in which what is built follows its own temperature, too.

In docs/formulation.md 14.2 a layer shrinks once, from the temperature at which it solidifies to that of its
ground. Here each element shrinks from the solidus to its temperature as its layer's pause ends, and then with
every change of its temperature, down to that of the air. The strain stays elastic, as in fabseq, so that one
factor scales it. Cubes of eight nodes, integrated as fabseq's; material at nominal positions.
"""

import numpy as np
import scipy.sparse as sparse
from scipy.sparse.linalg import splu

from heat_and_plasticity import steel

EXPANSION = 1e-5  # per kelvin, before it is scaled
SUPPORT = 1e-9    # of the largest stiffness: springs that hold the released part
CORNERS = np.array([[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1],
                    [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]], dtype=float)
SHEARS = ((0, 1), (1, 2), (2, 0))


def cube(edge):
    """Stiffness (24, 24) of a cube with a modulus of 1, and its nodal forces per uniform free strain."""
    stiffness, force = np.zeros((24, 24)), np.zeros(24)
    shear, nu = 0.5 / (1 + steel.POISSON), steel.POISSON
    material = np.diag([2 * shear] * 3 + [shear] * 3)
    material[:3, :3] += nu / ((1 + nu) * (1 - 2 * nu))
    for point in CORNERS / np.sqrt(3.0):
        factors = 1.0 + CORNERS * point
        slopes = CORNERS * factors[:, [1, 0, 0]] * factors[:, [2, 2, 1]] / (4.0 * edge)
        strain = np.zeros((6, 24))
        for axis in range(3):
            strain[axis, axis::3] = slopes[:, axis]
        for row, (a, b) in enumerate(SHEARS, start=3):
            strain[row, a::3], strain[row, b::3] = slopes[:, b], slopes[:, a]
        stiffness += strain.T @ material @ strain * edge**3 / 8.0
        force += strain.T @ material @ [1, 1, 1, 0, 0, 0] * edge**3 / 8.0
    return stiffness, force


class Linear:
    """Steps of a linear model of the bricks, which are cubes."""

    def __init__(self, bricks):
        self.bricks, self.size = bricks, 3 * len(bricks.positions)
        self.stiffness, self.force = cube(np.cbrt(bricks.volume))
        self.unknowns = (3 * bricks.corners[:, :, None] + np.arange(3)).reshape(-1, 24)
        self.held = (3 * bricks.supports[:, None] + np.arange(3)).ravel()

    def matrix(self, built):
        at, count = self.unknowns[built], np.count_nonzero(built)
        rows, columns = np.repeat(at, 24, axis=1).ravel(), np.tile(at, (1, 24)).ravel()
        return sparse.csc_matrix((np.tile(self.stiffness.ravel(), count), (rows, columns)), (self.size,) * 2), np.unique(at)

    def step(self, built, strain):
        """Displacement of what is built under free strains per element, and the forces of the supports."""
        matrix, there = self.matrix(built)
        load = np.zeros(self.size)
        np.add.at(load, self.unknowns[built], strain[built][:, None] * self.force)
        free, moved = np.setdiff1d(there, self.held), np.zeros(self.size)
        moved[free] = splu(matrix[free][:, free]).solve(load[free])
        return moved, matrix @ moved - load

    def released(self, forces):
        """Displacement of the whole part as these forces of its supports vanish, but for a rigid motion."""
        matrix, there = self.matrix(np.ones(len(self.bricks.layer), dtype=bool))
        load, moved = np.zeros(self.size), np.zeros(self.size)
        load[self.held] = -forces[self.held]
        soft = SUPPORT * matrix.diagonal().max() * sparse.eye(len(there))
        moved[there] = splu((matrix[there][:, there] + soft).tocsc()).solve(load[there])
        return moved


def displacements(bricks, heat, ambient):
    """Of the nodes (node, 3), cold and released, unscaled. `heat`: [layer - 1][time][node]."""
    linear = Linear(bricks)
    ends = np.minimum(np.nan_to_num(heat[:, -1], nan=ambient)[:, bricks.corners].mean(axis=2), steel.SOLIDUS)
    ends[-1] = ambient
    now = np.where(bricks.layer == 0, ambient, steel.SOLIDUS)
    moved, forces = np.zeros(linear.size), np.zeros(linear.size)
    for layer in range(1, bricks.layers + 1):
        built = bricks.layer <= layer
        strain = np.where(built, EXPANSION * (ends[layer - 1] - now), 0.0)
        now = np.where(built, ends[layer - 1], now)
        for total, part in zip((moved, forces), linear.step(built, strain)):
            total += part
    return (moved + linear.released(forces)).reshape(-1, 3)
