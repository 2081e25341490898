# SPDX-License-Identifier: MIT
"""How many beads a simulated layer stands for, so that a run takes minutes."""

import math

from fabseq_tools.start.bound import Bound

MINUTES = 30         # of a run on one rank: by default
LEAST_LAYERS = 8     # thicker ones, of which there are fewer, show little of a sequence
JUDGED = 1.3         # times the iterations' time: binary layers, baselines and reports, too
ORDER = 4            # minutes go with elements and layers, the fourth power of a layer's thickness
MOST_TRIES = 6


def minutes_of(arguments, found):
    """Of a run on one rank, about."""
    return JUDGED * arguments.iterations * found.seconds / 60


class Beads:
    """The number of beads in a layer, `passes`, and the element of such layers. `element_for(target)`: makes
    an element for layers of that thickness; `across`: elements that a layer has to have."""

    def __init__(self, arguments, look, element_for, across):
        self.arguments, self.height, self.across = arguments, arguments.bead_height, across
        first = look.first()
        self.most = max(1, math.floor(first.geodesic / (LEAST_LAYERS * self.height)))
        self.passes, tried, fitting = self.guess(first, Bound(arguments, look).edge_of(first), look.layers), {}, []
        while self.passes not in tried and len(tried) < MOST_TRIES:
            tried[self.passes] = element_for(self.target())
            excess = self.excess(tried[self.passes].found)
            if excess <= 1.0 or self.passes == self.most:
                fitting.append(self.passes)
                self.passes = max(1, min(self.passes - 1, math.ceil(self.passes * excess)))
            else:
                self.passes = min(self.most, max(self.passes + 1, math.floor(self.passes * excess)))
        self.passes = min(fitting, default=max(tried))
        self.element = tried[self.passes]

    def excess(self, found):
        """By how much thicker layers have to be: about, and 1 or less where they need not."""
        too_long = (minutes_of(self.arguments, found) / self.arguments.minutes) ** (1 / ORDER)
        return max(too_long, self.across * found.edge / self.target())

    def guess(self, first, least_edge, layers):
        """The fewest beads with which a run takes minutes, by one with large elements and so many layers, and
        whose elements the bound allows."""
        edge = self.height / self.across  # of layers of one bead
        minutes = minutes_of(self.arguments, first) * (first.edge / edge) ** 3 * (first.geodesic / self.height / layers)
        fewest = max((minutes / self.arguments.minutes) ** (1 / ORDER), least_edge / edge)
        return min(self.most, max(1, math.ceil(fewest)))

    def target(self):
        """The thickness of a layer."""
        return self.passes * self.height

    def words(self, layers, found):
        """What was chosen, in a line. `layers`: how many simulated ones there are; `found`: of the config."""
        unit, width = self.arguments.unit, self.arguments.bead_width
        beads = f"beads {self.height:g} {unit} high" + (f" and {width:g} {unit} wide" if width else "")
        layer = "each is a simulated layer"
        if self.passes > 1:
            layer = f"a simulated layer of {self.target():g} {unit} stands for {self.passes}"
        minutes = minutes_of(self.arguments, found)
        taken = f"about {minutes:.2g} min" if minutes >= 1 else "less than a minute"
        return (f"{beads}: {layer}; {layers} layers, elements of {found.edge:g} {unit}, {taken} for "
                f"{self.arguments.iterations} iterations on one rank (--minutes)")
