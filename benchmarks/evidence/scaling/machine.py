# SPDX-License-Identifier: MIT
"""Seconds of what counts.py counts, on a stated machine."""

import math
from dataclasses import dataclass

import numpy as np

from .costs import DOUBLE, SINGLE

PHASES = ["heat", "layers", "primal", "adjoint", "responses", "optimizer"]
KINDS = ["compute", "serial", "messages", "collectives"]


@dataclass(frozen=True)
class Machine:
    """Network: round figures of a cluster. Core: measured (docs/performance.md) unless stated otherwise."""
    cores_per_node: int = 64
    latency: float = 1.5e-6          # of a message
    overhead: float = 0.4e-6         # a further message that one rank sends at the same time; assumed
    network: float = 12e9            # bytes/s of a node
    core_bandwidth: float = 37.5e9   # triad of one core alone
    node_bandwidth: float = 330e9    # of all cores together; assumed: 16 channels of DDR4-3200, 80 % of their peak
    cache: float = 512e6             # last-level, of a node; assumed
    flops: float = 50e9              # of a core: fitted to 0.08 s per layer of the V-shape; its multiply-adds alone reach 132e9
    memory: float = 512e9            # of a node; assumed

    def bandwidth(self, cores, working_set):
        """Of a core, if so many are used, each with a working set that stays in the cache or does not."""
        on_node = min(cores, self.cores_per_node)
        main = min(self.core_bandwidth, self.node_bandwidth / on_node)
        cached = min(1.0, self.cache / (on_node * working_set))
        return 1.0 / (cached / self.core_bandwidth + (1.0 - cached) / main)


# Seconds on one core, measured on the V-shape (docs/performance.md): per element of the part and layer.
ELEMENT_SECONDS = {"primal": 2.4e-8, "adjoint": 3.5e-8, "layers": 2e-8}
# Per element of the part and lane: finding islands.
ISLAND_SECONDS = 2.6e-8
# Interior-point steps of the optimizer's small model, which every rank solves.
ROW_MODEL_STEPS = 15
# Share of a rank's surface that lies on the surface of its node: 4 x 4 x 4 ranks.
OFF_NODE = 0.25


class Clock:
    """Times of one split."""

    def __init__(self, machine, plan, elastic, heat, groups):
        self.machine, self.elastic, self.heat, self.groups = machine, elastic, heat, groups
        self.iteration, self.part_elements = plan.iteration, plan.part_elements
        self.ranks, self.cores = elastic.ranks, elastic.ranks * groups
        # Vectors, coefficients and scaling of a solve with 8 lanes: double, single, coarse levels.
        level = elastic.levels[0]
        working = 24 * level.own_nodes * (5 * DOUBLE + 7 * SINGLE) + 8 * level.own_elements * (DOUBLE + SINGLE)
        working += sum(24 * coarse.own_nodes * 9 * SINGLE for coarse in elastic.levels[1:])
        self.bandwidth = machine.bandwidth(self.cores, working)

    def message(self, traffic):
        """Messages of the busiest rank, all at once."""
        if not traffic.messages:
            return 0.0
        size = traffic.own_bytes
        seconds = (self.machine.latency + self.machine.overhead * max(0, traffic.own_messages - 1)
                   + 2 * size / self.bandwidth)
        if self.ranks > self.machine.cores_per_node:
            seconds += OFF_NODE * size * self.machine.cores_per_node / self.machine.network
        return seconds

    def collective(self, system, kind, comm, size):
        """`comm` may be a level's number: of the ranks that hold it."""
        if isinstance(comm, int):
            ranks, comm = system.levels[comm].ranks, "domain"
        else:
            ranks = {"domain": self.ranks, "across": self.groups, "world": self.cores}[comm]
        seconds = 2 * math.ceil(math.log2(ranks)) * self.machine.latency
        if kind in ("gather", "allgather"):
            size *= ranks
        seconds += 2 * size / self.bandwidth
        if (self.ranks if comm == "domain" else self.cores) > self.machine.cores_per_node:
            seconds += 2 * size / self.machine.network * (min(self.ranks, self.machine.cores_per_node) if comm == "across" else 1)
        return seconds

    def serial(self, system, phase, what):
        rows, band, machine = system.rows(), system.bandwidth(), self.machine
        if what == "factor":
            return rows * band**2 / machine.flops
        if what in ("direct", "direct heat"):  # the factor passes twice, for all right-hand sides of the heat problem at once
            passes = 1.0 if what == "direct" else 1.0 / 8.0
            return 4 * rows * band / machine.flops + passes * 2 * rows * band * SINGLE / machine.core_bandwidth
        if what == "islands":
            return self.part_elements / self.ranks * ISLAND_SECONDS
        return self.part_elements / self.ranks * ELEMENT_SECONDS[phase]

    def optimizer(self):
        """Passes over the gradients of this rank's variables, a symmetric product each; the rows' model."""
        variables, rows = self.part_elements / self.cores, self.iteration.rows
        step = (variables * (rows + 1) * DOUBLE / self.bandwidth
                + (variables * ((rows + 1)**2 + 4 * rows) + ROW_MODEL_STEPS * rows**3 / 3) / self.machine.flops)
        return (self.iteration.newton_steps + 2) * step

    def parts(self, tally, phase):
        """Seconds of computing on all ranks (memory and arithmetic at the same time: the slower of the two),
        computing on one or the same on all, messages, and collectives."""
        system = self.heat if phase == "heat" else self.elastic

        def total(counter, seconds):
            return sum(times * seconds(*key[1:]) for key, times in counter.items() if key[0] == phase)

        def messages(*what):
            return sum(times * self.message(getattr(system, key[1])(*key[2:]))
                       for key, times in tally.traffic.items() if key[:1 + len(what)] == (phase, *what))

        compute = max(tally.work[phase] / np.array([self.machine.flops, self.bandwidth]))
        return {"compute": compute + (self.optimizer() if phase == "optimizer" else 0.0),
                "serial": total(tally.serial, lambda what: self.serial(system, phase, what)),
                "messages": messages("halo") + (messages("exchange", "nodes") + messages("exchange", "elements"))
                + messages("gather") + messages("deal"),
                "collectives": total(tally.collectives, lambda *what: self.collective(system, *what))}

    def seconds(self, tallies):
        """By phase: that of the slowest group, and its parts."""
        return {phase: max((self.parts(tally, phase) for tally in tallies), key=lambda parts: sum(parts.values()))
                for phase in PHASES}


def memory_bytes(elastic, groups, layers, part_elements):
    """Of all ranks: the program's own estimate (run_cost), and the last level, whole on every rank."""
    unknowns, nodes = 3 * elastic.levels[0].nodes, math.prod(n + 1 for n in elastic.box)
    whole = elastic.levels[-1].nodes if elastic.ranks > 1 else 0.0
    return (unknowns * (2500.0 * groups + 8.0 * layers) + nodes * 900.0 * groups
            + part_elements * layers * (16.0 * groups + 24.0)
            + elastic.ranks * groups * (8e7 + whole * 24 * 9 * SINGLE))
