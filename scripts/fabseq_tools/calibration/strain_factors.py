# SPDX-License-Identifier: MIT
"""Factors of the inherent strain that come closest to what was measured, of one part or of several together
(docs/formulation.md 4.5)."""

import numpy as np

from fabseq_tools.geometry.rigid_motions import rigid_motions
from fabseq_tools.run.command_line import RunError

UNDETERMINED = 1e-6  # of the largest singular value
SETTLED = 1e-6       # change of the factors with which the search for the places of a scan's points ends
MOST_SEARCHES = 12   # for these; with noise, points at edges go to and fro for ever


def solve_factors(forms, measured):
    """Factors that come closest to the measured values, and whether these determine each of them. `forms`:
    [a][b][value]."""
    roots = np.ones(len(forms))
    for _ in range(200):
        rest = measured - roots @ (roots @ forms)
        step = np.linalg.lstsq(2.0 * (roots @ forms).T, rest, rcond=UNDETERMINED)[0]
        while np.linalg.norm(measured - (roots + step) @ ((roots + step) @ forms)) > np.linalg.norm(rest):
            step *= 0.5
        roots = roots + step
        if np.abs(step).max() < 1e-13:
            break
    sizes = np.linalg.norm(np.einsum("aav->av", forms), axis=1)
    determined = sizes > UNDETERMINED * max(sizes.max(), np.linalg.norm(measured))
    if determined.any() and np.linalg.cond(forms.sum(0)[determined]) > 1.0 / UNDETERMINED:
        raise RunError("the points cannot tell the factors of the axes apart: measure more of them, or --isotropic")
    return np.where(determined, np.abs(roots), 1.0)**2, determined


class Equations:
    """What `values`, displacements of points of one part along directions (n, axis), say about the factors;
    with `rigid` beside a motion of the part. `fields`: [a][b], of u(s) = sum_ab sqrt(s_a s_b) fields_ab."""

    def __init__(self, model, fields, points, directions, values, rigid):
        self.displacements = model.interpolate(fields, model.moved_in(points)[0])
        self.points, self.directions = points, directions
        self.forms, self.values = np.einsum("abnx,nx->abn", self.displacements, directions), values
        self.motions = rigid_motions(points - points.mean(0)) if rigid else np.zeros((0, *points.shape))
        self.along = np.einsum("mnx,nx->nm", self.motions, directions)
        left, sizes, _ = np.linalg.svd(self.along, full_matrices=False)
        self.basis = left[:, sizes > 1e-9 * sizes[0]] if rigid else left
        if len(values) <= self.basis.shape[1]:
            raise RunError(f"{len(values)} measured values determine nothing beside a rigid motion")

    def without_motion(self, numbers):
        """What no rigid motion explains of [...][value]."""
        return numbers - numbers @ self.basis @ self.basis.T

    def motion(self, factors):
        """The size of each rigid motion."""
        roots = np.sqrt(factors)
        return self.motion_beside(roots @ (roots @ self.forms))

    def motion_beside(self, simulated):
        """The same for simulated values."""
        return np.linalg.lstsq(self.along, self.values - simulated, rcond=1e-9)[0]

    def moved(self, simulated, displacements):
        """Simulated displacements of the points, whose values are `simulated`, with the rigid motion."""
        return displacements + np.einsum("m,mnx->nx", self.motion_beside(simulated), self.motions)

    def rest(self, factors):
        """What factors and motion leave of the values."""
        roots = np.sqrt(factors)
        return self.values - roots @ (roots @ self.forms) - self.along @ self.motion(factors)

    def displacement(self, factors):
        """Of the points, with the rigid motion."""
        roots = np.sqrt(factors)
        return self.moved(roots @ (roots @ self.forms), np.einsum("a,b,abnx->nx", roots, roots, self.displacements))


class Fit:
    """The factors with which the equations of all parts together are met best. `forms` [a][b][value],
    `strained` [value]: what no rigid motion explains of the simulations and of the values. `rests`: what is
    left, by part. `unknowns`: how many numbers were fitted. `given`: the factors, where they are not looked
    for."""

    def __init__(self, equations, given=None):
        self.equations = equations
        self.forms = np.concatenate([e.without_motion(e.forms) for e in equations], axis=2)
        self.strained = np.concatenate([e.without_motion(e.values) for e in equations])
        self.factors, self.determined = (solve_factors(self.forms, self.strained) if given is None
                                         else (given, np.ones(len(given), bool)))
        self.rests = [e.rest(self.factors) for e in equations]
        self.rest, self.values = np.concatenate(self.rests), np.concatenate([e.values for e in equations])
        self.unknowns = int(self.determined.sum()) + sum(e.basis.shape[1] for e in equations)

    def left(self):
        """The rms of what is left over that of what was measured, both without rigid motions."""
        sizes = [np.linalg.norm(values) for values in (self.rest, self.strained)]
        return float(sizes[0] / sizes[1]) if sizes[1] > 0.0 else float(sizes[0] > 0.0)


def fit_factors(measurements, fields, rigid, given=None):
    """The Fit of some parts, by their measurements and by `fields`, [part][a][b]. The places of a scan's
    points depend on the factors and on the rigid motion, so that search and fit take turns. `given`: as of
    Fit."""
    displacements, factors = [None] * len(measurements), np.inf
    for _ in range(MOST_SEARCHES):
        fit = Fit([measurement.equations(its_fields, rigid, displacement)
                   for measurement, its_fields, displacement in zip(measurements, fields, displacements)], given)
        is_settled = given is None and np.abs(fit.factors - factors).max() < SETTLED
        if is_settled or not any(m.moves for m in measurements):
            break
        displacements, factors = [e.displacement(fit.factors) for e in fit.equations], fit.factors
    return fit
