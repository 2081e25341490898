# SPDX-License-Identifier: MIT
"""What the program decides on any number of ranks: process grid, multigrid levels, who shares nodes, dealing
of layers and rows to groups. It is the program's own code that answers (plan.cc)."""

import json
import math
from dataclasses import dataclass
from types import SimpleNamespace

import program_run


@dataclass
class Problem:
    """Elasticity: a lane has an operator of its own; heat: all lanes of a block share one."""
    components: int
    own_operators: bool
    steps: list          # of conjugate gradients on levels 1, 2, ...; the last goes on
    patient_steps: list
    patience: int
    flops: dict          # of a product, per element and lane, by width

    def operators(self, width):
        return width if self.own_operators else 1

    def scaling(self):
        """Entries of a node's inverse block."""
        return self.components * (self.components + 1) // 2

    def steps_on(self, level, patient):
        steps = self.patient_steps if patient else self.steps
        return steps[min(level, len(steps)) - 1]


class System:
    """A problem's levels, as plan.cc has them. PETSc's process grid exchanges nodes of the whole box."""

    def __init__(self, problem, levels, grid):
        self.problem, self.levels, self.grid = problem, levels, grid
        self.ranks, self.box = math.prod(grid), levels[0].box

    def sides(self):
        """Sides of a rank in the middle, along each axis, that it shares."""
        return [min(p - 1, 2) for p in self.grid]

    def exchange_messages(self):
        return math.prod(3 * p - 2 for p in self.grid) - self.ranks

    def exchange_nodes(self):
        """Of all ranks, to the ghosted boxes or back."""
        return math.prod(n + 1 + 2 * (p - 1) for n, p in zip(self.box, self.grid)) - math.prod(n + 1 for n in self.box)

    def ring_elements(self):
        """Of all ranks, to the elements around their own."""
        return math.prod(n + 2 * (p - 1) for n, p in zip(self.box, self.grid)) - math.prod(self.box)

    def own_neighbors(self):
        return math.prod(1 + s for s in self.sides()) - 1

    def own_exchange_nodes(self):
        own = [n / p for n, p in zip(self.box, self.grid)]
        return math.prod(n + s for n, s in zip(own, self.sides())) - math.prod(own)

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
        answer = json.loads(program_run.run_command([program], input=json.dumps(question)).stdout)
        self.part_elements, self.least_elements = answer["part_elements"], answer["agglomeration_limit"]
        self.relative_cost = {int(width): cost for width, cost in answer["relative_cost"].items()}
        self.problems = {name: Problem(**problem) for name, problem in answer["problems"].items()}
        self.found = dict(zip(ranks, answer["systems"]))
        self.deals = {(tuple(work), count): blocks for (work, count), blocks in zip(deals, answer["deals"])}

    def systems(self, ranks, staged=False):
        """Of elasticity and heat; None if the box cannot be dealt out to so many ranks. `staged`: coarse
        levels on ever fewer ranks instead of whole on all of them, which the program does not do."""
        found = self.found[ranks]
        if found is None:
            return None
        levels = {name: [SimpleNamespace(**level) for level in found[name]] for name in self.problems}
        if staged:
            levels = {name: self.spread(of_system, ranks) for name, of_system in levels.items()}
        return [System(self.problems[name], levels[name], found["grid"]) for name in ("elasticity", "heat")]

    def spread(self, levels, ranks):
        """Levels held by only so many ranks that each has enough to do; the others wait."""
        result = []
        for level in levels:
            share = min(ranks, level.elements / self.least_elements)
            if not level.distributed and share > 1:
                edge = (level.elements / share)**(1.0 / 3.0)
                level = SimpleNamespace(**vars(level) | {
                    "distributed": True, "own_elements": level.elements / share, "own_nodes": level.nodes / share,
                    "own_neighbors": 26, "own_halo_nodes": (edge + 3)**3 - (edge + 1)**3})
            result.append(level)
        return result + levels[-1:] if result[-1].distributed else result
