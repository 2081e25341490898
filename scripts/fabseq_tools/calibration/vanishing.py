# SPDX-License-Identifier: MIT
"""The temperature at which the inherent strain vanishes, from parts that were built with different pauses.

As long as the strain of every layer is positive, it is linear in x = 1/(vanishing - reference)
(docs/formulation.md 14.2), and so is the displacement: simulations with the constant strain, x = 0, and with
the largest x, where the hottest layer's strain is 0, give it for all others.
"""

import dataclasses

import numpy as np
from scipy.optimize import minimize_scalar

from fabseq_tools.calibration.strain_factors import Fit, fit_factors
from fabseq_tools.run.command_line import RunError

CONSTANT = 1e30       # vanishing of a strain that is constant, degrees C
BEGINNINGS = 11       # shares at each of which the search may begin
AT_THE_END = 0.999    # share from which on the fit asks for more than the largest x
LOWER_BY = 0.1        # what vanishing must take off the rms of the differences to be told from scatter
CHANCE = 4.0          # and how many mean squares of the differences: two standard deviations
NOTHING = 1e-3        # of the rms of the values, without rigid motions: what no measurement shows
LEAST_CHANGE = 0.01   # of the displacement that x changes and no factor does


@dataclasses.dataclass
class Vanishing:
    """What was found. `temperature`: the best `vanishing` in degrees C, CONSTANT where the strain should stay
    constant. `fit`: of this strain; `constant`: of the constant one. `verdict`: in words."""

    temperature: float
    fit: Fit
    constant: Fit
    verdict: str


class VanishingSearch:
    """Simulates the parts, and finds the best `vanishing`. Raises RunError where the parts cannot tell."""

    def __init__(self, parts, factors, rigid):
        self.measurements, self.rigid = [part.measurement for part in parts], rigid
        self.constant = [part.simulate_all(factors, CONSTANT) for part in parts]
        self.reference = parts[0].config["thermal"]["reference"]
        self.hottest = max(max(part.interpass) for part in parts)
        if self.hottest <= self.reference:
            raise RunError(f"no layer begins hotter than thermal.reference, {self.reference:g}: found {self.hottest:g} at most, "
                           "so that nothing tells where the strain vanishes; allowed: parts with shorter pauses")
        hot = [part.simulate_all(factors, self.hottest) for part in parts]
        self.change = [end - start for start, end in zip(self.constant, hot)]

    def fit(self, share):
        """The best factors with this share of the largest x; a strain that grows with the temperature has a
        negative one."""
        fields = [start + share * change for start, change in zip(self.constant, self.change)]
        return fit_factors(self.measurements, fields, self.rigid)

    def own_factors(self, number):
        """Those of one part for itself, with the constant strain, or None where it does not tell them."""
        try:
            return fit_factors(self.measurements[number:number + 1], self.constant[number:number + 1], self.rigid).factors
        except RunError:
            return None

    def find(self):
        constant = self.fit(0.0)
        self.refuse_parts_alike(constant)
        share, fit = self.best_share()
        if not is_better(fit, constant):
            return Vanishing(CONSTANT, constant, constant, "the constant strain is as good, and is kept")
        if share < 0.0:
            return Vanishing(CONSTANT, constant, constant,
                             "no vanishing fits, since the hotter layers have the larger strain; the constant strain is kept")
        if share > AT_THE_END:
            return Vanishing(CONSTANT, constant, constant,
                             f"no vanishing fits: it would be below the hottest interpass temperature, {self.hottest:.4g}; "
                             "the constant strain is kept")
        return Vanishing(self.reference + (self.hottest - self.reference) / share, fit, constant,
                         "the strain that vanishes is better than the constant one")

    def best_share(self):
        """The best share between -1 and 1, and its fit. There may be a minimum on either side of 0."""
        shares = np.linspace(-1.0, 1.0, 2 * BEGINNINGS - 1)
        errors = [squares(self.fit(share)) for share in shares]
        best = int(np.argmin(errors))
        bounds = shares[max(best - 1, 0)], shares[min(best + 1, len(shares) - 1)]
        found = minimize_scalar(lambda share: squares(self.fit(share)), bounds=bounds, method="bounded",
                                options={"xatol": 1e-7})
        share = float(found.x if found.fun < errors[best] else shares[best])
        return share, self.fit(share)

    def refuse_parts_alike(self, constant):
        """Raises a RunError if factors do to the measured values what the temperature does."""
        changes = change_of(constant, self.measurements, self.change, self.rigid)
        columns = constant.forms.reshape(-1, constant.forms.shape[2]).T
        roots = np.sqrt(constant.factors)
        change = roots @ (roots @ changes)
        rest = change - columns @ np.linalg.lstsq(columns, change, rcond=1e-9)[0]
        if np.linalg.norm(rest) < LEAST_CHANGE * np.linalg.norm(roots @ (roots @ constant.forms)):
            raise RunError("the parts are too much alike: no measured value tells a small strain from hot layers; allowed: parts "
                           "whose interpass temperatures differ by 200 K or more")


def change_of(constant, measurements, fields, rigid):
    """[a][b][value] of other fields, with the places of the points that the fit has found."""
    displacements = [e.displacement(constant.factors) for e in constant.equations]
    equations = [m.equations(f, rigid, u) for m, f, u in zip(measurements, fields, displacements)]
    return np.concatenate([e.without_motion(e.forms) for e in equations], axis=2)


def squares(fit):
    return float(np.sum(fit.rest**2))


def is_better(fit, constant):
    """Whether the fit with one number more comes closer than scatter explains: by a tenth of the rms, by two
    standard deviations, and by more than nothing."""
    saved, left = squares(constant) - squares(fit), squares(fit)
    free = max(len(fit.values) - fit.unknowns - 1, 1)
    return bool(saved > max((1.0 - LOWER_BY)**-2 - 1.0, CHANCE / free) * left
                and saved > NOTHING**2 * np.sum(constant.strained**2))
