# SPDX-License-Identifier: MIT
"""One factor on what a material that flows is made of (process.model elastoplastic), from measured parts.

The displacement is not linear in such a factor. The parts are simulated with a few factors; between these the
displacement of each point is interpolated, and where it comes closest to the measurement is the next factor
to simulate. Of the simulated factors the one that leaves least is taken.
"""

import dataclasses

import numpy as np
from scipy.optimize import minimize_scalar

from fabseq_tools.calibration.strain_factors import MOST_SEARCHES, SETTLED, Fit, fit_factors

KINDS = "elongation", "yield"
RANGE = 0.05, 5.0        # of the factors that are tried
STEP = 1.5               # how many times beyond the factors simulated so far the next may be
CLOSE = 2e-4             # of a factor: nearer ones are not told apart
LEAST_GAIN = 1e-5        # of what is left: what another simulation must promise to take off
FIRST_STEP = 0.05        # of the factor, at least
YIELD_STEP = 0.8         # the second factor on the yield stress
MOST_SIMULATIONS = 12
MOST_INTERPOLATED = 3    # factors
LEAST_CHANGE = 1e-3      # of the displacement, for a change of the factor's logarithm by 1
STARTS = 61              # factors at which the interpolated differences are looked at first
AS_SIMULATED = np.ones(1)


def factored_keys(part, kind):
    """The keys of the section material that the factor is of. Hardening follows the yield stress, as it does
    with the temperature."""
    if kind == "yield":
        return "yield_stress", "hardening"
    return ("elongations",) if part.is_heated else ("strain_scale",)


def factored_material(part, kind, factor):
    """The values of these keys, `factor` times those of the part's config."""
    return {key: (factor * np.array(part.material[key])).tolist() for key in factored_keys(part, kind)}


@dataclasses.dataclass
class Simulated:
    """The parts with one factor. `found`: displacements of the nodes, by part and by whether they are after
    the release; `fields`: those that were measured, by part; `fit`: what they leave."""

    factor: float
    found: list
    fields: list
    fit: Fit

    def error(self):
        return float(np.linalg.norm(self.fit.rest))


class FlowFactor:
    """Simulates the parts with some factors, and finds the best. `simulated`: one for each, the first with
    the factor 1; `best`: that which leaves least; `determined`: whether the points say anything about the
    factor, which else stays 1; `settled`: whether the search has ended by itself."""

    def __init__(self, parts, kind, arguments):
        self.parts, self.kind, self.released, self.rigid = parts, kind, arguments.released, arguments.rigid
        self.measurements = [part.measurement for part in parts]
        self.simulated, self.determined, self.settled = [], True, False
        self.simulate(1.0)

    @property
    def best(self):
        return min(self.simulated, key=Simulated.error)

    def enlarged(self):
        """The Fit of the first displacements times a number of their own."""
        return fit_factors(self.measurements, [field[None, None] for field in self.simulated[0].fields], self.rigid)

    def find(self):
        """Simulates until the best factor is known."""
        if not self.enlarged().determined[0]:
            self.determined, self.settled = False, True
            return
        self.simulate(self.second_factor())
        first, second = self.simulated
        change, size = second.fit.forms - first.fit.forms, np.linalg.norm(first.fit.forms)
        if np.linalg.norm(change) <= LEAST_CHANGE * abs(np.log(second.factor)) * size:
            self.simulated, self.determined, self.settled = [first], False, True
            return
        while not self.settled and len(self.simulated) < MOST_SIMULATIONS:
            factor, error = self.next_factor()
            self.settled = (error > (1.0 - LEAST_GAIN) * self.best.error()
                            or any(abs(factor / one.factor - 1.0) < CLOSE for one in self.simulated))
            if not self.settled:
                self.simulate(factor)

    def simulate(self, factor):
        found = [part.simulate_material(f"simulation_{self.kind}_{factor:.6g}", f"{self.kind} times {factor:.6g}",
                                        factored_material(part, self.kind, factor)) for part in self.parts]
        fields = [of[self.released] for of in found]
        fit = fit_factors(self.measurements, [field[None, None] for field in fields], self.rigid, AS_SIMULATED)
        self.simulated.append(Simulated(factor, found, fields, fit))
        for part, of in zip(self.parts, self.best.found):
            part.fields = {released: field[None, None] for released, field in of.items()}

    def second_factor(self):
        """As if the displacement grew with the elongation; a given one for the yield stress."""
        if self.kind == "yield":
            return YIELD_STEP
        factor = float(np.clip(self.enlarged().factors[0], 1.0 / STEP, STEP))
        return factor if abs(factor - 1.0) > FIRST_STEP else 1.0 + np.copysign(FIRST_STEP, factor - 1.0)

    def next_factor(self):
        """Where the interpolated displacements come closest to the measured ones, and what they leave."""
        best = self.best
        near = sorted(self.simulated, key=lambda one: abs(np.log(one.factor / best.factor)))[:MOST_INTERPOLATED]
        known = [one.factor for one in near]
        fields = [np.stack([one.fields[part] for one in near])[None] for part in range(len(self.parts))]
        displacements = [e.displacement(AS_SIMULATED) for e in best.fit.equations]
        factor = best.factor
        for _ in range(MOST_SEARCHES):
            equations = [m.equations(field, self.rigid, u) for m, field, u in zip(self.measurements, fields, displacements)]
            forms = np.concatenate([e.without_motion(e.forms[0]) for e in equations], axis=1)
            strained = np.concatenate([e.without_motion(e.values) for e in equations])
            last, (factor, error) = factor, self.closest(lambda f, s=strained, u=forms: np.linalg.norm(s - weights(known, f) @ u))
            if abs(factor - last) < SETTLED or not any(m.moves for m in self.measurements):
                break
            shares = weights(known, factor)
            displacements = [e.moved(shares @ e.forms[0], np.tensordot(shares, e.displacements[0], 1)) for e in equations]
        return factor, error

    def closest(self, error):
        """The factor of the least error, in reach of those simulated so far, and that error."""
        factors = [one.factor for one in self.simulated]
        tried = np.geomspace(max(RANGE[0], min(factors) / STEP), min(RANGE[1], max(factors) * STEP), STARTS)
        errors = [error(factor) for factor in tried]
        best = int(np.argmin(errors))
        bounds = tried[max(best - 1, 0)], tried[min(best + 1, STARTS - 1)]
        found = minimize_scalar(error, bounds=bounds, method="bounded", options={"xatol": 1e-7})
        return (float(found.x), found.fun) if found.fun < errors[best] else (float(tried[best]), errors[best])


def weights(known, factor):
    """Those of displacements with known factors in the polynomial through them, of the factor's logarithm."""
    known, at = np.log(known), np.log(factor)
    return np.array([np.prod([(at - other) / (one - other) for other in known if other != one]) for one in known])
