# SPDX-License-Identifier: MIT
"""Work of the lane kernels on one rank: flops and bytes as an array (vectors read and written once, no
caches)."""

import numpy as np

DOUBLE, SINGLE = 8, 4


def values_of(problem, level, width):
    return level.own_nodes * problem.components * width


def sweep(problem, level, width, real, vectors, extra_flops=0.0, extra_bytes=0.0):
    """A pass over a rank's elements: `vectors` are read or written, `extra` is per component and lane."""
    values, coefficients = values_of(problem, level, width), width if problem.own_operators else 2
    return np.array([level.own_elements * width * problem.flops[str(width)] + values * extra_flops,
                     values * (vectors * real + extra_bytes) + level.own_elements * coefficients * real])


def visit(problem, level, coarse, width):
    """A cycle's work on a level: two smoothing steps before and two after, residual, transfers."""
    values = values_of(problem, level, width)
    blocks = problem.scaling() / problem.components * SINGLE / (1 if problem.own_operators else width)  # bytes per value
    scaled = 2.0 * problem.components - 1.0  # flops of a block, per value
    return (values * np.array([scaled + 1, 2 * SINGLE + blocks])  # first step
            + sweep(problem, level, width, SINGLE, 3, scaled + 5, blocks)  # second: x twice, b
            + sweep(problem, level, width, SINGLE, 4, scaled + 3, blocks)  # and its step kept
            + sweep(problem, level, width, SINGLE, 4, scaled + 5, blocks)  # that step read
            + sweep(problem, level, width, SINGLE, 3, 1)  # residual
            + np.array([6 * values, SINGLE * (3 * values + 3 * values_of(problem, coarse, width))]))  # down and up


def coarse_step(problem, level, width, steps):
    """A step of conjugate gradients on a level below the finest, but for the cycle in it; the mean of
    `steps`: inner products, direction and solution, and, in all but the first, image and rest."""
    later = (steps - 1) / steps
    return (sweep(problem, level, width, SINGLE, 2, 2)
            + values_of(problem, level, width) * np.array([4 + 8 * later, SINGLE * (5 + 8 * later)]))


def outer_step(problem, level, width):
    """What is outside of the preconditioner: product, vector updates, inner products."""
    return sweep(problem, level, width, DOUBLE, 2, 2) + values_of(problem, level, width) * np.array([6 + 2 + 6, 20 + 20 + 52])
