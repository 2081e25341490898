#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Another optimizer: SciPy's SLSQP lets a wall that leans over its foot distort less, with layers of even
thickness. On several ranks each one runs SciPy with the whole design, and fabseq shares the work:

    export PYTHONPATH=build/release/python
    python3 docs/example/scipy_optimizer.py
    mpirun -np 2 python3 docs/example/scipy_optimizer.py
"""

import fabseq
import numpy as np
from scipy.optimize import minimize

TARGET, TOLERANCE = 0.3125, 0.15
CONFIG = {
    "name": "leaning_wall",
    "domain": {"size": [2.0, 2.0], "elements": [16, 16]},
    "part": {"difference": [{"union": [{"box": {"min": [0, 0], "max": [2, 0.6]}}, {"box": {"min": [1.2, 0], "max": [2, 2]}}]},
                            {"half_space": {"point": [1, 0], "normal": [-1, 1]}}]},
    "node_sets": {"tip": {"box": {"min": [1.7, 2], "max": [2, 2]}}},
    "sequence": {"type": "heat", "characteristic_length": 2.5},
    "layers": {"count": 8},
    "objective": [{"type": "distortion", "nodes": "tip"}],
    "constraints": [{"type": "layer_thickness", "target": TARGET, "tolerance": TOLERANCE}],
}


class Scaled:
    """The problem as SciPy wants it, in the logarithms of all variables, with the distortion relative to that
    of the start."""

    def __init__(self, problem):
        self.problem, self.last, self.calls = problem, None, 0
        self.start = np.log(problem.gather(problem.design))
        self.bounds = np.log([problem.gather(bound) for bound in problem.bounds]).T
        self.scale = self.at(self.start)[0]["objective_0"]

    def at(self, logarithms):
        """Values, and gradients by the logarithms; evaluated once for each design."""
        if self.last is None or not np.array_equal(logarithms, self.last):
            self.last, self.calls = logarithms.copy(), self.calls + 1
            design = np.exp(logarithms)
            self.values = self.problem.evaluate(self.problem.share(design))
            self.gradients = {name: design * self.problem.gather(gradient)
                              for name, gradient in self.problem.gradients().items()}
        return self.values, self.gradients

    def objective(self, logarithms):
        values, gradients = self.at(logarithms)
        return values["objective_0"] / self.scale, gradients["objective_0"] / self.scale

    def thickness(self, logarithms):
        """Of each layer, relative to the target."""
        return np.array([value for name, value in self.at(logarithms)[0].items() if name.startswith("constraint_0")])

    def thickness_slopes(self, logarithms):
        return np.array([slope for name, slope in self.at(logarithms)[1].items() if name.startswith("constraint_0")])


def main():
    problem = Scaled(fabseq.Problem(CONFIG))
    limits = [{"type": "ineq", "fun": lambda x, s=sign: TOLERANCE - s * (problem.thickness(x) - 1),
               "jac": lambda x, s=sign: -s * problem.thickness_slopes(x)} for sign in (1, -1)]
    found = minimize(problem.objective, problem.start, jac=True, bounds=problem.bounds, constraints=limits, method="SLSQP",
                     options={"maxiter": 40})
    worst = max(problem.thickness(found.x), key=lambda value: abs(value - 1))
    if problem.problem.rank == 0:
        print(f"{len(found.x)} variables, {problem.calls} designs: {found.message}")
        print(f"root of the distortion: {problem.scale**0.5:.4g} to {(problem.scale * found.fun)**0.5:.4g}; "
              f"worst thickness: {worst:.3f} of the target")


if __name__ == "__main__":
    main()
