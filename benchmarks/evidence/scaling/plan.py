# SPDX-License-Identifier: MIT
"""What the program decides on any number of ranks: process grid, multigrid levels, who shares nodes, dealing
of layers and rows to groups. It is the program's own code that answers (plan.cc)."""

import json
import math
from collections import Counter
from dataclasses import dataclass
from types import SimpleNamespace
from typing import NamedTuple

from ... import program_run


@dataclass
class Problem:
    """Elasticity: a lane has an operator of its own; heat: all lanes of a block share one."""
    components: int
    own_operators: bool
    steps: list          # of conjugate gradients on levels 1, 2, ...; the last goes on
    patient_steps: list
    patient_end: int     # on the level before the last, from the third on
    patience: int
    flops: dict          # of a product, per element and lane, by width

    def operators(self, width):
        return width if self.own_operators else 1

    def scaling(self):
        """Entries of a node's inverse block."""
        return self.components * (self.components + 1) // 2

    def steps_on(self, level, levels, patient):
        if patient and level >= 3 and level + 2 == levels:
            return self.patient_end
        steps = self.patient_steps if patient else self.steps
        return steps[min(level, len(steps)) - 1]


def level_of(answer):
    """A level's counts by their names."""
    return SimpleNamespace(**{name: SimpleNamespace(**value) if isinstance(value, dict) else value
                              for name, value in answer.items()})


class Traffic(NamedTuple):
    """What the ranks of a group send at once: in all, and what the rank sends or gets that has most of it."""
    messages: float
    bytes: float
    own_messages: float
    own_bytes: float


class System:
    """A problem's levels, as plan.cc has them. What the kinds of traffic are is said in counts.py; `size` is
    bytes per node or element."""

    def __init__(self, problem, levels, grid):
        self.problem, self.levels, self.grid = problem, levels, grid
        self.ranks, self.box = math.prod(grid), levels[0].box

    def halo(self, level, size):
        counts = self.levels[level]
        return Traffic(counts.halo_messages, counts.halo_nodes * size,
                       counts.own_neighbors, counts.own_halo_nodes * size)

    def exchange(self, kind, size):
        """Of "nodes" or "elements"."""
        extents = [n + (kind == "nodes") for n in self.box]
        entries = math.prod(n + 2 * (p - 1) for n, p in zip(extents, self.grid)) - math.prod(extents)
        own = [n / p for n, p in zip(self.box, self.grid)]
        sides = [min(p - 1, 2) for p in self.grid]  # of a rank in the middle, along each axis, that it shares
        own_entries = math.prod(n + s for n, s in zip(own, sides)) - math.prod(own)
        return Traffic(math.prod(3 * p - 2 for p in self.grid) - self.ranks, entries * size,
                       math.prod(1 + s for s in sides) - 1, own_entries * size)

    def gather(self, level, kind, size):
        counts = getattr(self.levels[level], "gathered_" + kind)
        return Traffic(counts.messages, counts.entries * size, counts.own_messages, counts.own_entries * size)

    def deal(self, owners, size):
        """`owners` of the lanes; `size`: bytes per node and lane."""
        lanes, holders = Counter(owners), self.levels[-1].holders
        sent = [(owner, holder, nodes * count * size) for owner, count in lanes.items()
                for holder, nodes in holders if holder != owner]
        busiest = [[size for message in sent if message[end] == rank for size in message[2:]]
                   for end in (0, 1) for rank in {message[end] for message in sent}]
        return Traffic(len(sent), sum(size for _, _, size in sent),
                       max(map(len, busiest), default=0), max(map(sum, busiest), default=0))

    def own_box_nodes(self):
        return math.prod(n + 1 for n in self.box) / self.ranks

    def rows(self):
        return self.levels[-1].nodes * self.problem.components

    def bandwidth(self):
        """Of the last level's matrix, along its shortest axis first."""
        last = self.levels[-1]
        section = math.prod(n + 1 for n in sorted(last.box)[:2]) * min(1.0, last.elements / math.prod(last.box))**(2.0 / 3.0)
        return self.problem.components * (section + math.sqrt(section) + 2)


class Plan:
    """Answers for a part: a "config", or "box" and "fill". `iteration`: what is dealt out to groups."""

    def __init__(self, program, part, ranks, groups, iteration):
        self.iteration = iteration
        deals = [(work, count) for work in iteration.deals() for count in groups]
        question = {**part, "ranks": ranks, "deals": [{"work": work, "groups": count} for work, count in deals]}
        answer = json.loads(program_run.run_command([program], given=json.dumps(question)).stdout)
        self.part_elements = answer["part_elements"]
        self.relative_cost = {int(width): cost for width, cost in answer["relative_cost"].items()}
        self.problems = {name: Problem(**problem) for name, problem in answer["problems"].items()}
        self.found = dict(zip(ranks, answer["systems"]))
        self.deals = {(tuple(work), count): blocks for (work, count), blocks in zip(deals, answer["deals"])}

    def systems(self, ranks):
        """Of elasticity and heat; None if the box cannot be dealt out to so many ranks."""
        found = self.found[ranks]
        if found is None:
            return None
        return [System(self.problems[name], [level_of(level) for level in found[name]], found["grid"])
                for name in ("elasticity", "heat")]
