# SPDX-License-Identifier: MIT
"""Whether one factor on a material that flows can be meant."""

import numpy as np

from fabseq_tools.calibration.fit_checks import FitChecks, largest_number
from fabseq_tools.calibration.flow_factor import MOST_SIMULATIONS, RANGE, factored_keys, factored_material

AT_THE_END = 0.01  # of the factor


def name_of(part, kind):
    """What the factor is of, in words."""
    return "factor on " + " and ".join(f"material.{key}" for key in factored_keys(part, kind))


class FlowChecks(FitChecks):
    """Of a FlowFactor, or, `enlarged`, of its first displacements as many times larger as fits best. Other
    readings of the measurement are looked for with such displacements, too."""

    of_others = "these would be {} of the simulated ones"

    def __init__(self, search, arguments, enlarged=False):
        self.search, self.name = search, name_of(search.parts[0], search.kind)
        fit = search.enlarged() if enlarged else search.best.fit
        scale, determined = ((fit.factors, fit.determined) if enlarged
                             else (np.array([search.best.factor]), np.array([search.determined])))
        super().__init__(search.parts, fit, scale, determined, arguments)

    def place_of(self, axes):
        return "displacement, over the simulated one"

    def words_outside(self):
        factor = self.scale[0]
        if self.determined[0] and not RANGE[0] * (1.0 + AT_THE_END) < factor < RANGE[1] * (1.0 - AT_THE_END):
            return f"{self.name}: found {factor:.4g}, an end of what is tried, {RANGE[0]:g} to {RANGE[1]:g}"
        return ""

    def warnings(self):
        result = super().warnings()
        if not self.search.settled:
            result.append(f"{self.name}: not settled after {MOST_SIMULATIONS} simulations; the best of these is taken")
        return result

    def largest_strain(self):
        if self.search.kind == "yield":
            return "", 0.0
        found = [factored_material(part, self.search.kind, self.scale[0]) for part in self.parts]
        return "strain with this factor", max(
            largest_number(of["elongations"]) if "elongations" in of
            else largest_number(of["strain_scale"]) * largest_number(part.material.get("inherent_strain", 0.0))
            for part, of in zip(self.parts, found))

    def enlargements(self):
        return self.search.enlarged().factors
