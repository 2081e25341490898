# SPDX-License-Identifier: MIT
"""What a design iteration computes and sends, derived from the code: one rank's work, messages, and collective calls.

Kinds of entries: "halo" (sum over shared nodes, SharedNodes::sum: one message to each neighbour), "exchange" (PETSc's halo of the nodes of
the whole box, one message to each neighbour), and collectives, over the ranks of a group ("domain"), a rank and its copies ("across"), or
all ("world").
"""

from collections import Counter, defaultdict
from dataclasses import dataclass, field

import numpy as np

from scaling.costs import DOUBLE, ELASTICITY, HEAT, PATIENCE, SINGLE, Work, coarse_step, outer_step, visit
from scaling.dealing import deal_equal_layers, deal_out_layers, relative_cost
from scaling.decomposition import choose
from scaling.geometry import Hierarchy

# IslandMap::largest, elements.
LARGEST_ISLAND_FIELD = 100_000_000


@dataclass
class Iteration:
    """What the counts depend on beside the grid: lane iterations, in the order of the layers, and those of the optimizer."""
    primal: list
    adjoint: list
    heat: list             # the forward solve, then a number a row: the objective and every constrained component
    newton_steps: int
    rows: int              # of the optimizer's subproblem, at most
    part_elements: float
    expected_work: list = None  # of the layers, that they were dealt out by
    serial: dict = field(default_factory=dict)


class Tally:
    """Of one group."""

    def __init__(self):
        self.work = defaultdict(Work)          # phase: a rank's kernels
        self.halos = Counter()                 # (phase, level, bytes a node): how often
        self.exchanges = Counter()             # (phase, bytes a node)
        self.collectives = Counter()           # (phase, kind, comm, bytes a rank)
        self.serial = Counter()                # (phase, what): units on one rank

    def collective(self, phase, kind, comm, size, times=1):
        self.collectives[phase, kind, comm, size] += times

    def add(self, phase, work, times, slower=1.0):
        """`slower`: how much longer arithmetic takes because registers are filled in part only."""
        self.work[phase].add(slower * work.flops, work.bytes, times)


class LaneSolver:
    """A system's hierarchy and what its solves take."""

    def __init__(self, tally, problem, hierarchy):
        self.tally, self.problem, self.hierarchy, self.levels = tally, problem, hierarchy, hierarchy.levels
        self.parallel = hierarchy.ranks > 1

    def reduce(self, phase, size, times=1):
        if self.parallel:
            self.tally.collective(phase, "allreduce", "domain", size, times)

    def halo(self, phase, level, size, times=1):
        if self.levels[level].distributed:
            self.tally.halos[phase, level, size] += times

    def exchange(self, phase, components, times=1):
        if self.parallel:
            self.tally.exchanges[phase, components * DOUBLE] += times

    def transfer_down(self, phase, fine, node_bytes, element_bytes=None, times=1):
        """Values of the level below `fine`: summed with the neighbours', or over all ranks where they hold it whole."""
        coarse = self.levels[fine + 1]
        if coarse.distributed:
            if node_bytes:
                self.halo(phase, fine + 1, node_bytes, times)
        elif self.levels[fine].distributed:
            self.reduce(phase, round(node_bytes * coarse.nodes if node_bytes else element_bytes * coarse.elements), times)

    def set_up(self, phase, width):
        problem = self.problem
        for level in range(len(self.levels) - 1):
            self.halo(phase, level, problem.scaling() * problem.operators(width) * DOUBLE)
            self.transfer_down(phase, level, 0, problem.coefficients(width) * SINGLE)
            nodes = self.levels[level].own_nodes * problem.operators(width)
            self.tally.work[phase].add(70 * nodes * problem.components, nodes * problem.scaling() * (4 * DOUBLE + SINGLE))
        self.reduce(phase, problem.operators(width) * DOUBLE)  # of factor()
        self.tally.serial[phase, "factor"] += self.lanes_here(problem.operators(width))
        if not problem.own_operators or len(self.levels) == 1:
            return
        if self.hierarchy.box[0] * self.hierarchy.box[1] * self.hierarchy.box[2] <= LARGEST_ISLAND_FIELD:
            if self.parallel:
                self.tally.collective(phase, "gather", "domain", round(
                    self.levels[0].elements / self.hierarchy.ranks) * DOUBLE, width)
                self.tally.collective(phase, "bcast", "domain", 4, width)
            self.tally.serial[phase, "islands"] += self.lanes_here(width)
        self.reduce(phase, 0, width)  # centres of no islands

    def slower(self, width):
        """Of narrow blocks (measured: process/layer_dealing). One heat system alone has its elements side by side instead."""
        return 1.0 if width == 1 and not self.problem.own_operators else 8 * relative_cost(width) / width

    def lanes_here(self, lanes):
        return -(-lanes // self.hierarchy.ranks)

    def precondition(self, phase, width, patient, times):
        problem, visits = self.problem, 1
        value = problem.components * width
        last = len(self.levels) - 1
        for level in range(last):
            if level > 0:
                steps = problem.steps_on(level, patient)
                visits *= steps
                if steps > 1:
                    self.halo(phase, level, value * SINGLE, visits * times)
                    if self.levels[level].distributed:
                        self.reduce(phase, 3 * width * DOUBLE, visits * times)
                    self.tally.add(phase, coarse_step(
                        problem, self.levels[level], width, steps), visits * times, self.slower(width))
            self.halo(phase, level, value * SINGLE, 3 * visits * times)
            self.transfer_down(phase, level, value * SINGLE, times=visits * times)
            self.tally.add(phase, visit(problem, self.levels[level],
                           self.levels[level + 1], width), visits * times, self.slower(width))
        if problem.own_operators:
            self.reduce(phase, round(self.hierarchy.rows()) * width * DOUBLE, visits * times)
        self.tally.serial[phase, "direct" if problem.own_operators else "direct heat"] += visits * times * (
            self.lanes_here(width) if problem.own_operators else width)

    def solve(self, phase, iterations):
        """Lanes that take so many iterations; those that are left go on in half the width."""
        width = 8 if len(iterations) > 4 else 4 if len(iterations) > 2 else len(iterations)
        value = self.problem.components * width
        self.exchange(phase, self.problem.components * len(iterations), 2)  # to the mesh and back
        self.reduce(phase, width * DOUBLE)  # |f|
        for done in range(max(iterations) + 1):
            self.precondition(phase, width, done >= PATIENCE, 1)
            self.reduce(phase, (4 * width + 1) * DOUBLE)  # and whether to stop
            if done == max(iterations):
                return
            value = self.problem.components * width
            self.halo(phase, 0, value * DOUBLE)
            self.reduce(phase, width * DOUBLE)
            self.tally.add(phase, outer_step(self.problem, self.levels[0], width), 1, self.slower(width))
            active = sum(lane > done for lane in iterations)
            if width > 1 and active <= width // 2:
                width //= 2


def count_heat(tally, solver, group, groups, iteration, rows):
    phase = "heat"
    if groups > 1:
        tally.collective(phase, "allreduce", "across", 8, 2)      # verdicts of forward and adjoint
        tally.collective(phase, "allgather", "across", 4)         # the design: counts, values
        tally.collective(phase, "allgather", "across", round(iteration.part_elements / solver.hierarchy.ranks / groups) * DOUBLE)
        tally.collective(phase, "bcast", "across", round(solver.hierarchy.own_box_nodes()) * DOUBLE)
        tally.collective(phase, "bcast", "across", 4)
        tally.collective(phase, "allreduce", "across", 4 * len(iteration.heat[1:]))
    solver.exchange(phase, 1, 3)                                  # load: fixed nodes, sum; T
    solver.reduce(phase, 4)                                       # numbers?
    solver.reduce(phase, DOUBLE, 2)                               # range of T
    widths = set()

    def solve(lanes):
        width = 8 if len(lanes) > 4 else 4 if len(lanes) > 2 else len(lanes)
        if width not in widths:
            solver.set_up(phase, width)
        widths.add(width)
        solver.solve(phase, lanes)

    if group == 0:
        solve(iteration.heat[:1])
    own = [iteration.heat[1 + row] for row in rows]
    for first in range(0, len(own), 8):
        lanes = own[first:first + 8]
        solver.exchange(phase, len(lanes), 2)                     # loads, adjoints
        solve(lanes)
    if groups > 1:
        tally.collective(phase, "alltoall", "across", round(
            len(rows) * iteration.part_elements / solver.hierarchy.ranks) * DOUBLE)


def count_elastic(tally, solver, phase, blocks, iterations, groups):
    if groups > 1:
        tally.collective(phase, "allreduce", "across", 8)
        tally.collective(phase, "allreduce", "across", 4 * len(iterations))
        if phase == "primal":
            tally.collective(phase, "allreduce", "across", round(solver.hierarchy.own_box_nodes()) * 3 * DOUBLE)
    for first, lanes in blocks:
        width = 8 if lanes > 4 else 4 if lanes > 2 else lanes
        solver.reduce(phase, lanes * DOUBLE)                      # numbers?
        solver.set_up(phase, width)
        solver.exchange(phase, 3 * lanes, 1 if phase == "primal" else 2)  # loads; u and lambda of the derivatives
        solver.solve(phase, iterations[first:first + lanes])
        tally.serial[phase, "layer elements"] += lanes


def count_rest(tally, ranks, groups, layers, rows, iteration):
    parallel = ranks > 1
    if parallel:
        # Values: distortion, uniformity, thickness; derivatives of this group's rows.
        reductions = [(8, 1)] + (2 + (0 in rows)) * [(8, 1), (24 * layers, 1),
                                                     (8 * layers, 1)] + [(24, sum(row > 0 for row in rows))]
        for size, times in reductions:
            tally.collective("responses", "allreduce", "domain", size, times)
    if groups > 1:
        for size, times in ((8, 2), (8 * layers, 1)):
            tally.collective("responses", "bcast", "across", size, times)
        tally.collective("responses", "allreduce", "across", 8)
        tally.collective("layers", "reduce", "across", round(iteration.part_elements / ranks) * DOUBLE)
    tally.serial["layers", "layer densities"] += layers
    if parallel or groups > 1:
        m = iteration.rows
        tally.collective("optimizer", "allreduce", "world", 4, 1)
        tally.collective("optimizer", "allreduce", "world", 8, 2)
        tally.collective("optimizer", "bcast", "world", m * DOUBLE)
        tally.collective("optimizer", "allreduce", "world", m * DOUBLE)
        tally.collective("optimizer", "bcast", "world", (2 * m + 1) * DOUBLE, iteration.newton_steps)
        tally.collective("optimizer", "allreduce", "world", ((m + 1) * (m + 2) // 2 + 2 * m) * DOUBLE, iteration.newton_steps + 1)


def hierarchies(box, part, ranks, staged=False):
    """Of the elastic and of the heat problem; None if the box cannot be dealt out to so many ranks."""
    voxels = None if np.isscalar(part) else part
    decomposition = choose(ranks, tuple(box), voxels)
    if decomposition is None:
        return None
    return Hierarchy(box, part, decomposition, 3, staged), Hierarchy(box, 1.0 if voxels is None else np.ones_like(part), decomposition, 1, staged)


def count_iteration(elastic, heat, groups, iteration):
    """Tallies of all groups."""
    ranks = elastic.ranks
    layers = len(iteration.primal)
    work = iteration.expected_work or [1.0 + a + b for a, b in zip(iteration.primal, iteration.adjoint)]
    blocks = deal_out_layers(work, groups) if len(set(work)) > 1 else deal_equal_layers(layers, groups)
    dealt_rows = deal_equal_layers(len(iteration.heat) - 1, groups)
    tallies = []
    for group in range(groups):
        tally = Tally()
        rows = [row for first, lanes in dealt_rows[group] for row in range(first, first + lanes)]
        count_heat(tally, LaneSolver(tally, HEAT, heat), group, groups, iteration, rows)
        for phase, iterations in (("primal", iteration.primal), ("adjoint", iteration.adjoint)):
            count_elastic(tally, LaneSolver(tally, ELASTICITY, elastic), phase, blocks[group], iterations, groups)
        count_rest(tally, ranks, groups, layers, rows, iteration)
        tallies.append(tally)
    return tallies
