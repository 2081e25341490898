# SPDX-License-Identifier: MIT
"""Seconds of what counts.py counts, on a stated machine."""

import math
from dataclasses import dataclass

from scaling.costs import DOUBLE, SINGLE

PHASES = ["heat", "layers", "primal", "adjoint", "responses", "optimizer"]


@dataclass(frozen=True)
class Machine:
    """Network: round figures of a cluster. Core: measured (docs/performance.md) where not stated otherwise."""
    cores_a_node: int = 64
    latency: float = 1.5e-6          # of a message
    overhead: float = 0.4e-6         # a further message that one rank sends at the same time; assumed
    network: float = 12e9            # bytes/s of a node
    core_bandwidth: float = 37.5e9   # triad of one core alone
    node_bandwidth: float = 330e9    # of all cores together; assumed: 16 channels of DDR4-3200, 80 % of their peak
    cache: float = 512e6             # last-level, of a node; assumed
    flops: float = 50e9              # of a core: fitted to 0.08 s a layer of the V-shape on one; its multiply-adds alone reach 132e9
    memory: float = 512e9            # of a node; assumed

    def bandwidth(self, cores, working_set):
        """Of a core, if so many are used, each with a working set that stays in the cache or does not."""
        on_node = min(cores, self.cores_a_node)
        main = min(self.core_bandwidth, self.node_bandwidth / on_node)
        cached = min(1.0, self.cache / (on_node * working_set))
        return 1.0 / (cached / self.core_bandwidth + (1.0 - cached) / main)


# Seconds on one core, measured on the V-shape (docs/performance.md): an element of the part and layer.
LOAD_SECONDS, DERIVATIVE_SECONDS = 2.4e-8, 3.5e-8
LAYER_SECONDS = 2e-8
# An element of the part, of one lane: finding islands.
ISLAND_SECONDS = 4e-8
# Interior-point steps of the optimizer's small model, which every rank solves.
ROW_MODEL_STEPS = 15
# Of a rank's surface, share that lies on the surface of its node: 4 x 4 x 4 ranks.
OFF_NODE = 0.25


class Clock:
    """Times of one split."""

    def __init__(self, machine, elastic, heat, groups, part_elements):
        self.machine, self.elastic, self.heat, self.groups = machine, elastic, heat, groups
        self.ranks, self.cores = elastic.ranks, elastic.ranks * groups
        self.part_elements = part_elements
        # Vectors, coefficients and scaling of a solve with 8 lanes: double, single, coarse levels.
        level = elastic.levels[0]
        values = 24 * level.own_nodes
        working = values * (5 * DOUBLE + 5 * SINGLE + 2 * SINGLE) + 8 * level.own_elements * (DOUBLE + SINGLE)
        working += sum(24 * coarse.own_nodes * 9 * SINGLE for coarse in elastic.levels[1:])
        self.bandwidth = machine.bandwidth(self.cores, working)

    def hierarchy(self, phase):
        return self.heat if phase == "heat" else self.elastic

    def ranks_of(self, comm):
        return {"domain": self.ranks, "across": self.groups, "world": self.cores}[comm]

    def leaves_node(self, comm):
        return (self.ranks if comm == "domain" else self.cores) > self.machine.cores_a_node

    def message(self, neighbors, size):
        """An exchange with all neighbours at once; `size` bytes in all."""
        seconds = self.machine.latency + self.machine.overhead * max(0, neighbors - 1) + 2 * size / self.bandwidth
        if self.ranks > self.machine.cores_a_node:
            seconds += OFF_NODE * size * self.machine.cores_a_node / self.machine.network
        return seconds

    def collective(self, kind, comm, size):
        ranks = self.ranks_of(comm)
        steps = math.ceil(math.log2(ranks))
        through = self.machine.network / (min(self.ranks, self.machine.cores_a_node) if comm == "across" else 1)
        seconds = 2 * steps * self.machine.latency
        if kind in ("gather", "allgather"):
            size *= ranks
        seconds += 2 * size / self.bandwidth
        if self.leaves_node(comm):
            seconds += 2 * size / through
        return seconds

    def compute(self, work):
        """Memory and arithmetic at the same time: the slower of the two."""
        return max(work.bytes / self.bandwidth, work.flops / self.machine.flops)

    def serial(self, phase, what, times):
        hierarchy = self.hierarchy(phase)
        rows, band, elements = hierarchy.rows(), hierarchy.bandwidth(), self.part_elements / self.ranks
        if what == "factor":
            return times * rows * band**2 / self.machine.flops
        if what in ("direct", "direct heat"):  # the factor passes twice, for all right-hand sides of the heat problem at once
            passes = 1.0 if what == "direct" else 1.0 / 8.0
            return times * (4 * rows * band / self.machine.flops + passes * 2 * rows * band * DOUBLE / self.machine.core_bandwidth)
        if what == "islands":
            return times * self.part_elements * ISLAND_SECONDS
        if what == "layer elements":
            return times * elements * (LOAD_SECONDS if phase == "primal" else DERIVATIVE_SECONDS)
        return times * elements * LAYER_SECONDS

    def optimizer(self, iteration):
        """Passes over the gradients of this rank's variables, a symmetric product each, and the rows' model."""
        variables, rows = self.part_elements / self.cores, iteration.rows
        step = (variables * (rows + 1) * DOUBLE / self.bandwidth + variables * ((rows + 1)**2 + 4 * rows) / self.machine.flops
                + ROW_MODEL_STEPS * rows**3 / 3 / self.machine.flops)
        return (iteration.newton_steps + 2) * step

    def parts(self, tally, phase):
        """Seconds of computing on all ranks, computing on one or the same on all, messages, and collectives."""
        hierarchy = self.hierarchy(phase)
        halos = sum(times * self.message(hierarchy.levels[level].own_neighbors, hierarchy.levels[level].own_halo_nodes * size)
                    for (p, level, size), times in tally.halos.items() if p == phase)
        neighbors = math.prod(1 + min(p - 1, 2) for p in hierarchy.grid) - 1
        halos += sum(times * self.message(neighbors, hierarchy.own_exchange_nodes() * size) for (p, size), times in tally.exchanges.items()
                     if p == phase)
        collectives = sum(times * self.collective(kind, comm, size) for (p, kind, comm, size), times in tally.collectives.items()
                          if p == phase)
        serial = sum(self.serial(phase, what, times) for (p, what), times in tally.serial.items() if p == phase)
        return {"compute": self.compute(tally.work[phase]), "serial": serial, "messages": halos, "collectives": collectives}

    def seconds(self, tallies, iteration):
        """By phase: that of the slowest group, and its parts."""
        result = {}
        for phase in PHASES:
            of_groups = [self.parts(tally, phase) for tally in tallies]
            if phase == "optimizer":
                of_groups[0]["compute"] += self.optimizer(iteration)
            result[phase] = max(of_groups, key=lambda parts: sum(parts.values()))
        return result


def memory_bytes(elastic, groups, layers, part_elements):
    """Of all ranks: the program's own estimate (run_cost), and the levels that every rank holds whole."""
    unknowns, nodes = 3 * elastic.levels[0].nodes, math.prod(n + 1 for n in elastic.box)
    whole = sum(level.own_nodes for level in elastic.levels if not level.distributed) if elastic.ranks > 1 else 0.0
    return (unknowns * 2500.0 * groups + nodes * (900.0 * groups + 24.0 * layers) + part_elements * layers * 16.0 * (groups + 3)
            + elastic.ranks * groups * (8e7 + whole * 24 * 9 * SINGLE))
