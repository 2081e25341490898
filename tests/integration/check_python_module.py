# SPDX-License-Identifier: MIT
"""What python_test.py runs on one rank and on several: python3 check_python_module.py CONFIG.json

Writes as JSON, in report_RANK.json, the values at a design near the start, of each one the derivative along a
direction by the gradient and by differences of fourth order, and how many variables there are."""

import json
import sys

import fabseq
import numpy as np

STEP = 1e-4  # of the range of each variable
AWAY = 0.05  # the design from the start, of the range


class Line:
    """Designs along a line, each variable on its own scale: `place` from 0 to 1 between its bounds."""

    def __init__(self, problem):
        lower, upper = (problem.gather(bound) for bound in problem.bounds)
        self.problem, self.logarithmic = problem, problem.gather(problem.logarithmic) > 0
        self.lower, self.upper = self.scaled(lower), self.scaled(upper)
        start = (self.scaled(problem.gather(problem.design)) - self.lower) / (self.upper - self.lower)
        noise = np.random.default_rng(1).uniform(-1, 1, (2, len(start)))  # of the whole: one on any ranks
        self.place, self.direction = 0.1 + 0.8 * start + AWAY * noise[0], noise[1]

    def scaled(self, design):
        return np.where(self.logarithmic, np.log(np.where(self.logarithmic, design, 1.0)), design)

    def design(self, step):
        scaled = self.lower + (self.place + step * self.direction) * (self.upper - self.lower)
        return np.where(self.logarithmic, np.exp(scaled), scaled)

    def values(self, step):
        found = self.problem.evaluate(self.problem.share(self.design(step)))
        return np.array(list(found.values()))

    def differences(self):
        near, far = (self.values(step) - self.values(-step) for step in (STEP, 2 * STEP))
        return (8 * near - far) / (12 * STEP)

    def adjoints(self):
        """At the design of the last evaluate(), which must be that of step 0."""
        slope = np.where(self.logarithmic, self.design(0.0), 1.0) * (self.upper - self.lower) * self.direction
        return [float(self.problem.gather(gradient) @ slope) for gradient in self.problem.gradients().values()]


def main():
    problem = fabseq.Problem(sys.argv[1])
    line = Line(problem)
    differences = line.differences()
    values = problem.evaluate(problem.share(line.design(0.0)))
    report = {"values": values, "adjoints": dict(zip(values, line.adjoints(), strict=True)),
              "differences": dict(zip(values, map(float, differences), strict=True)),
              "share": len(problem.design), "whole": len(line.place)}
    with open(f"report_{problem.rank}.json", "w", encoding="utf-8") as file:
        json.dump(report, file)
    problem.close()


if __name__ == "__main__":
    main()
