# SPDX-License-Identifier: MIT
"""What a design iteration computes and sends, derived from the code: one rank's work, messages, and
collective calls.

A "halo" is a sum over shared nodes (SharedNodes::sum), an "exchange" PETSc's halo of the nodes of the whole
box, or a copy of the elements around the rank's own: one message to each neighbour. A "gather" takes
values to the ranks that hold the next level, or back (LevelGather); a "deal" takes lanes to those that solve
them on the last level, or back (LaneDeal). Collectives are over the ranks of a group ("domain"), those of
them that hold a level (its number), a rank and its copies ("across"), or all ("world").
"""

from collections import Counter, defaultdict
from dataclasses import dataclass

import numpy as np

from .costs import DOUBLE, SINGLE, coarse_step, outer_step, visit


@dataclass
class Iteration:
    """What the counts depend on beside the grid: iterations of the lanes, by layer, and of the optimizer."""
    primal: list
    adjoint: list
    heat: list                  # the forward solve, then a number for each row: the objective and every constrained component
    newton_steps: int
    rows: int                   # of the optimizer's subproblem, at most
    expected_work: list = None  # of the layers, that they were dealt out by

    def deals(self):
        """Work that is dealt out to the groups: of layers, of rows."""
        return self.expected_work or [1 + a + b for a, b in zip(self.primal, self.adjoint)], [1.0] * (len(self.heat) - 1)


class Tally:
    """Of one group."""

    def __init__(self):
        self.work = defaultdict(lambda: np.zeros(2))  # phase: a rank's kernels
        self.traffic = Counter()                      # (phase, function of System, its arguments): how often
        self.collectives = Counter()                  # (phase, kind, comm, bytes per rank)
        self.serial = Counter()                       # (phase, what): units on one rank


def width_of(lanes):
    return 1 << (lanes - 1).bit_length()


def most_lanes(owners):
    return max(Counter(owners).values())


class LaneSolver:
    """A system in a phase, and what its solves take."""

    def __init__(self, plan, tally, phase, system):
        self.plan, self.tally, self.phase, self.system = plan, tally, phase, system
        self.problem, self.levels, self.parallel = system.problem, system.levels, system.ranks > 1

    def collective(self, kind, comm, size, times=1):
        if comm == "across" or self.parallel:
            self.tally.collectives[self.phase, kind, comm, size] += times

    def reduce(self, size, times=1):
        self.collective("allreduce", "domain", size, times)

    def halo(self, level, size, times=1):
        if self.levels[level].ranks > 1:
            self.tally.traffic[self.phase, "halo", level, size] += times

    def exchange(self, values, times=1, kind="nodes"):
        if self.parallel:
            self.tally.traffic[self.phase, "exchange", kind, values * DOUBLE] += times

    def serial(self, what, units):
        self.tally.serial[self.phase, what] += units

    def work(self, amount, times, width):
        """Arithmetic takes longer in registers filled in part. One heat system alone fills them."""
        alone = width == 1 and not self.problem.own_operators
        self.tally.work[self.phase] += times * amount * (1.0 if alone else 8 * self.plan.relative_cost[width] / width, 1.0)

    def transfer_down(self, fine, of_nodes, of_elements, times=1):
        """Bytes of the level below `fine`: nodes of a cycle, there and back, or elements of the set-up."""
        coarse = self.levels[fine + 1]
        if coarse.lanes_dealt:
            self.reduce(round(of_elements * coarse.elements), times if of_elements else 0)
            return
        for kind, size, ways in (("nodes", of_nodes, 2), ("elements", of_elements, 1)):
            if size:
                self.tally.traffic[self.phase, "gather", fine + 1, kind, size] += ways * times
        if of_nodes:
            self.halo(fine + 1, of_nodes, times)

    def owners(self, width):
        """Rank that solves each lane on the last level; one operator for all lanes is the first rank's."""
        return tuple(lane % self.system.ranks if self.problem.own_operators else 0 for lane in range(width))

    def set_up(self, width):
        problem, operators = self.problem, self.problem.operators(width)
        for level in range(len(self.levels) - 1):
            self.halo(level, problem.scaling() * operators * DOUBLE)
            self.transfer_down(level, 0, (width if problem.own_operators else 2) * SINGLE)
            self.tally.work[self.phase] += self.levels[level].own_nodes * operators * np.array(
                [70 * problem.components, problem.scaling() * SINGLE])
        self.reduce(operators * DOUBLE)  # of factor()
        self.serial("factor", most_lanes(self.owners(operators)))
        if not problem.own_operators or len(self.levels) == 1 or self.phase == "adjoint":
            return  # the islands of an adjoint are those of the solve before it
        self.reduce(2 * width * DOUBLE)  # extremes of the stiffness
        self.exchange(1, 2 * width, "elements")  # of the stiffness, of what elements are in
        for _ in "basins", "saddles", "islands":
            self.collective("alltoall", "domain", 4 * self.system.ranks)
            self.collective("alltoallv", "domain", 0)  # of the graphs: what check.py leaves out, too
        self.reduce(4 * width)
        self.serial("islands", width)
        self.reduce(0, width)  # centres of no islands

    def precondition(self, owners, patient):
        width = len(owners)
        problem, visits, last = self.problem, 1, len(self.levels) - 1
        value = problem.components * width
        for level in range(last):
            if level > 0:
                steps = problem.steps_on(level, len(self.levels), patient)
                visits *= steps
                if steps > 1:
                    self.halo(level, value * SINGLE, visits)
                    if self.levels[level].ranks > 1:
                        self.collective("allreduce", level, 3 * width * DOUBLE, visits)
                    self.work(coarse_step(problem, self.levels[level], width, steps), visits, width)
            self.halo(level, value * SINGLE, 3 * visits)
            self.transfer_down(level, value * SINGLE, 0, visits)
            self.work(visit(problem, self.levels[level], self.levels[level + 1], width), visits, width)
        if self.levels[-1].lanes_dealt:
            self.tally.traffic[self.phase, "deal", owners, problem.components * SINGLE] += 2 * visits
        if problem.own_operators:
            self.serial("direct", visits * most_lanes(owners))
        else:
            self.serial("direct heat", visits * width)

    def solve(self, iterations):
        """Lanes that take so many iterations; those that are left go on in half the width."""
        width, most = width_of(len(iterations)), max(iterations)
        owners, lanes = self.owners(width), list(range(len(iterations)))
        self.exchange(self.problem.components * len(iterations), 2)  # to the mesh and back
        self.reduce(width * DOUBLE)                                  # |f|
        for done in range(most + 1):
            self.precondition(owners, done >= self.problem.patience)
            self.reduce((4 * width + 1) * DOUBLE)                    # and whether to stop
            if done < most:
                self.halo(0, self.problem.components * width * DOUBLE)
                self.reduce(width * DOUBLE)
                self.work(outer_step(self.problem, self.levels[0], width), 1, width)
                left = [place for place, lane in enumerate(lanes) if iterations[lane] > done]
                if width > 1 and len(left) <= width // 2:
                    width //= 2
                    owners = tuple(owners[left[place if place < len(left) else 0]] for place in range(width))
                    lanes = [lanes[place] for place in left]


def count_heat(solver, group, groups, rows):
    share, iterations = solver.plan.part_elements / solver.system.ranks, solver.plan.iteration.heat
    if groups > 1:
        solver.collective("allreduce", "across", 8, 2)               # verdicts of forward and adjoint
        solver.collective("allgather", "across", 4)                  # the design: counts, values
        solver.collective("allgather", "across", round(share / groups) * DOUBLE)
        solver.collective("bcast", "across", round(solver.system.own_box_nodes()) * DOUBLE)
        solver.collective("bcast", "across", 4)
        solver.collective("allreduce", "across", 4 * len(iterations[1:]))
        solver.collective("alltoall", "across", round(len(rows) * share) * DOUBLE)
    solver.collective("allreduce", "world", 4)                       # is the time of this design known?
    solver.exchange(1, 3)                                            # load: fixed nodes, sum; T
    solver.reduce(4)                                                 # numbers?
    solver.reduce(DOUBLE, 2)                                         # range of T
    own = [iterations[1 + row] for row in rows]
    adjoints = [own[first:first + 8] for first in range(0, len(own), 8)]
    blocks = [iterations[:1]] * (group == 0) + adjoints
    for width in {width_of(len(lanes)) for lanes in blocks}:
        solver.set_up(width)
    for lanes in adjoints:
        solver.exchange(len(lanes), 2)                               # loads, adjoints
    for lanes in blocks:
        solver.solve(lanes)


def count_elastic(solver, blocks, iterations, groups):
    if groups > 1:
        solver.collective("allreduce", "across", 8)
        solver.collective("allreduce", "across", 8 * len(iterations))  # of layers: the largest and all
        if solver.phase == "primal":
            solver.collective("allreduce", "across", round(solver.system.own_box_nodes()) * 3 * DOUBLE)
    for first, lanes in blocks:
        solver.reduce(lanes * DOUBLE)                                # numbers?
        solver.set_up(width_of(lanes))
        solver.exchange(3 * lanes, 1 if solver.phase == "primal" else 2)  # loads; u and lambda of the derivatives
        solver.solve(iterations[first:first + lanes])
        solver.serial("layer elements", lanes)


def count_rest(plan, tally, ranks, groups, rows):
    iteration = plan.iteration
    layers, m = len(iteration.primal), iteration.rows
    tally.serial["layers", "layer densities"] += layers
    if ranks > 1:  # values: distortion, uniformity, thickness; derivatives of this group's rows
        times = 2 + (0 in rows)
        for size, count in (8, 1 + times), (24 * layers, times), (8 * layers, times), (24, sum(row > 0 for row in rows)):
            tally.collectives["responses", "allreduce", "domain", size] += count
    if groups > 1:
        tally.collectives["responses", "bcast", "across", 8] += 2
        tally.collectives["responses", "bcast", "across", 8 * layers] += 1
        tally.collectives["responses", "allreduce", "across", 8] += 1
        tally.collectives["layers", "reduce", "across", round(plan.part_elements / ranks) * DOUBLE] += 1
    if ranks > 1 or groups > 1:
        for kind, size, count in (("allreduce", 4, 1), ("allreduce", 8, 2),
                                  ("bcast", m * DOUBLE, 1), ("allreduce", m * DOUBLE, 1),
                                  ("bcast", (2 * m + 1) * DOUBLE, iteration.newton_steps),
                                  ("allreduce", ((m + 1) * (m + 2) // 2 + 2 * m) * DOUBLE, iteration.newton_steps + 1)):
            tally.collectives["optimizer", kind, "world", size] += count


def count_iteration(plan, elastic, heat, groups):
    """Tallies of all groups."""
    of_layers, of_rows = (plan.deals[tuple(work), groups] for work in plan.iteration.deals())
    tallies = []
    for group in range(groups):
        tally = Tally()
        rows = [row for first, lanes in of_rows[group] for row in range(first, first + lanes)]
        count_heat(LaneSolver(plan, tally, "heat", heat), group, groups, rows)
        for phase, iterations in (("primal", plan.iteration.primal), ("adjoint", plan.iteration.adjoint)):
            count_elastic(LaneSolver(plan, tally, phase, elastic), of_layers[group], iterations, groups)
        count_rest(plan, tally, elastic.ranks, groups, rows)
        tallies.append(tally)
    return tallies
