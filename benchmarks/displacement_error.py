# SPDX-License-Identifier: MIT
"""True errors of the displacement, and the tolerance that gives a reference method the lanes' error.

The relative residual at which a solver stops is measured by its own preconditioner, so that the same
tolerance means different errors with different solvers. Compared are displacements after the last layer, of
`-task simulate`, with those of a tight solve: |u - u_exact| / |u_exact| over all nodes.
"""

import math
import os

import numpy as np

import program_run
from program_run import LANES, RunError, method_options

TIGHT = 1e-11
# Two errors this close to each other count as equal: one CG iteration more or less is about that.
CLOSE = 1.5
TRIES = 4
# Below this, differences may be the exact solve's own error.
SMALLEST = 1e-9


class DisplacementErrors:
    """`exact`: the method of the tight solve."""

    def __init__(self, options, directory, exact):
        self.options, self.directory, self.exact = options, directory, exact
        self.found = {}  # by method and tolerance
        self.expected = self.displacement(exact, TIGHT)

    def displacement(self, method, tolerance):
        output = os.path.join(self.directory, "simulate")
        layers = ["-layers", self.options.error_layers] if self.options.error_layers else []
        arguments = ["-task", "simulate", *layers, *method_options(method, tolerance)]
        path = os.path.join(output, "result.h5")
        try:
            program_run.run(self.options, self.options.ranks, output, arguments)
        except RunError:  # of the release, which comes last, at a tight tolerance; the displacement is there by then
            if not os.path.exists(path):
                raise
        result = program_run.read_fields(path)["displacement"]
        os.remove(path)
        return result

    def error(self, method, tolerance):
        key = method, tolerance
        if key not in self.found:
            difference = self.displacement(method, tolerance) - self.expected
            self.found[key] = float(np.linalg.norm(difference) / np.linalg.norm(self.expected))
            print(f"error {self.found[key]:.2e} of {method} at tolerance {tolerance:.2e}", flush=True)
        return self.found[key]

    def matching_tolerance(self, method, tolerance):
        """Tolerance at which a reference method is closest to the lanes' error at `tolerance`."""
        wanted = max(self.error(LANES, tolerance), SMALLEST)
        distance = {}
        trial = tolerance
        for _ in range(TRIES):
            ratio = max(self.error(method, trial), SMALLEST) / wanted
            distance[trial] = abs(math.log(ratio))
            if distance[trial] <= math.log(CLOSE):
                break
            trial = float(f"{min(trial / ratio, 0.5):.2g}")
            if trial in distance:
                break
        return min(distance, key=distance.get)

    def record(self):
        return {"exact": self.exact, "tolerance_of_exact": TIGHT,
                "errors": [{"method": m, "tolerance": t, "error": e} for (m, t), e in self.found.items()]}
