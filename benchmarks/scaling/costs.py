# SPDX-License-Identifier: MIT
"""Flops and bytes of the lane kernels, a node and lane (benchmarks/kernels/kernel_cost.h; vectors read and written once, no caches)."""

from dataclasses import dataclass

DOUBLE, SINGLE = 8, 4


def couplings():
    """Entries of the 8 blocks of an elastic element that are multiplied, and rows that have any (ParityMatrix::couples)."""
    entries = rows = 0
    for parity in range(8):
        for a in range(3):
            terms = sum(parity != 1 << a if a == b else (parity >> a & 1) == (parity >> b & 1) for b in range(3))
            entries, rows = entries + terms, rows + (terms > 0)
    return entries, rows


@dataclass(frozen=True)
class Problem:
    """Elasticity: a lane has an operator of its own; heat: all lanes of a block share one."""
    name: str
    components: int
    own_operators: bool
    steps: tuple         # of conjugate gradients on levels 1, 2, ...; the last goes on
    patient_steps: tuple
    tables: tuple = ()

    def operators(self, width):
        return width if self.own_operators else 1

    def coefficients(self, width):
        """Numbers an element."""
        return width if self.own_operators else 2

    def scaling(self):
        """Entries of a node's inverse block."""
        return self.components * (self.components + 1) // 2

    def steps_on(self, level, patient):
        steps = self.patient_steps if patient else self.steps
        return steps[min(level - 1, len(steps) - 1)]

    def sweep_flops(self, width):
        """An element and lane: a face's transform forward and back and its sum, and the blocks."""
        face = self.components * 4 * 5
        if not self.own_operators:
            return face + 28 + 24 / width
        entries, rows = couplings()
        return face + 2 * entries - rows + 4 * 3 * 7


ELASTICITY = Problem("elasticity", 3, True, (2, 4, 2), (6, 4, 2))
HEAT = Problem("heat", 1, False, (1, 4, 2), (1, 4, 2))
PATIENCE = 10


@dataclass
class Work:
    """Of one rank."""
    flops: float = 0.0
    bytes: float = 0.0

    def add(self, flops, size, times=1.0):
        self.flops += times * flops
        self.bytes += times * size


def sweep(problem, level, width, real, vectors, extra_flops=0.0, extra_bytes=0.0):
    """Flops and bytes of a pass over a rank's elements: `vectors` are read or written, `extra` a component and lane."""
    values = level.own_nodes * problem.components * width
    return (level.own_elements * width * problem.sweep_flops(width) + values * extra_flops,
            values * (vectors * real + extra_bytes) + level.own_elements * problem.coefficients(width) * real)


def visit(problem, level, coarse, width):
    """A cycle's work on a level: two smoothing steps before (the first from zero: no sweep) and two after, residual, transfers."""
    work = Work()
    values = level.own_nodes * problem.components * width
    blocks = problem.scaling() / problem.components * SINGLE / (1 if problem.own_operators else width)  # bytes a value
    scaled = 2.0 * problem.components - 1.0  # flops of a block, a value
    work.add(values * (scaled + 1), values * (2 * SINGLE + blocks))                                # first step
    work.add(*sweep(problem, level, width, SINGLE, 3, scaled + 5, blocks))                         # second: x twice, b
    work.add(*sweep(problem, level, width, SINGLE, 4, scaled + 3, blocks))                         # and its step kept
    work.add(*sweep(problem, level, width, SINGLE, 4, scaled + 5, blocks))                         # that step read
    work.add(*sweep(problem, level, width, SINGLE, 3, 1))                                          # residual
    coarse_values = coarse.own_nodes * problem.components * width
    work.add(6 * values, SINGLE * (3 * values + 3 * coarse_values))                                # down and up
    return work


def coarse_step(problem, level, width, steps):
    """The work of a step of conjugate gradients on a level below the finest, but for the cycle in it; the mean of `steps`."""
    work = Work()
    values = level.own_nodes * problem.components * width
    later = (steps - 1) / steps
    work.add(*sweep(problem, level, width, SINGLE, 2, 2))
    work.add(values * (2 + 2 * later), SINGLE * values * (2 + later))                              # inner products
    work.add(values * (2 + 2 * later), SINGLE * values * (3 + 2 * later))                          # direction, solution
    work.add(later * values * 4, later * SINGLE * values * 5)                                      # image, rest
    return work


def outer_step(problem, level, width):
    """An iteration outside of the preconditioner: product, vector updates, inner products; and the inner products of its end."""
    work = Work()
    values = level.own_nodes * problem.components * width
    work.add(*sweep(problem, level, width, DOUBLE, 2, 2))
    work.add(values * (6 + 2 + 6), values * (20 + 20 + 52))
    return work
