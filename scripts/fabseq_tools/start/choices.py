# SPDX-License-Identifier: MIT
"""What a config for a mesh needs, chosen from what the program says of the part (-task check)."""

import math

from fabseq_tools.run.check_words import percent
from fabseq_tools.run.command_line import RunError
from fabseq_tools.start.beads import Beads
from fabseq_tools.start.bound import MOST_ELEMENTS, Bound
from fabseq_tools.start.config_text import plain
from fabseq_tools.start.entries import Layers, entries_of
from fabseq_tools.start.holes import stock_of
from fabseq_tools.start.look import MOST_LOOKS, OUTSIDE, found_in
from fabseq_tools.start.materials import material_of

ACROSS_WALL, ACROSS_LAYER, LEAST_ACROSS_LAYER = 3, 4, 2.5  # elements (docs/how-to/choose-what-to-optimize.md)
NEAR_BOUND = 0.8         # from this share of a bound on, elements are small enough
ACROSS_BEADS = LEAST_ACROSS_LAYER  # where layers are thick so that a run takes minutes
CLOSE = 1.06             # between two edges that are tried
EXCESS = 1.05            # of the layers over the geodesic height
MOST_LAYERS = 10_000
FEW_LOST = 0.01          # of the part: more of it is worth smaller elements
FINER = 0.75             # times the edge, where smaller elements may hold more of it


def layers_for(found, target):
    count = max(1, math.ceil(EXCESS * found.geodesic / target))
    if count > MOST_LAYERS:
        raise RunError(f"layers of {target:g} make {count:,} of the geodesic height {found.geodesic:g}; allowed: {MOST_LAYERS:,} "
                       "at most; one thick layer may stand for several")
    return count


def rounded(value):
    """To three digits, downwards."""
    step = 10.0 ** (math.floor(math.log10(value)) - 2)
    return float(f"{math.floor(value / step + 1e-9) * step:.3g}")


class Element:
    """The element's edge as `found.edge`, why, and how many elements a wall may have at least."""

    def __init__(self, arguments, look, target, across=ACROSS_LAYER):
        self.arguments, self.look, self.unit = arguments, look, arguments.unit
        self.target, self.across = target, across
        self.bound = Bound(arguments, look)
        self.warnings, self.least_elements = [], None
        self.start()
        if self.found.most_hangs() and arguments.keep is None:
            look.floor = self.found.lowest
            self.start()
        self.refine()

    def start(self):
        """With elements of the wanted size, or with smaller ones that hold the part together."""
        first, target = self.look.first(), self.target
        if target:
            self.look.layers = layers_for(first, target)
        self.least_edge = self.bound.edge_of(first)
        wanted = target / self.across if target else max(self.least_edge, (first.volume / MOST_ELEMENTS) ** (1 / 3))
        part = "a quarter of a" if self.across == ACROSS_LAYER else f"{self.across:g} in a"
        self.why = [f"{part} layer of {target:g} {self.unit}" if target else self.bound.words()]
        self.found = self.within_bound(wanted)
        self.join()

    def within_bound(self, wanted):
        """With elements of the wanted size, or with the smallest that the bound allows."""
        if wanted < self.least_edge:
            self.why = [f"{self.why[0]} would be {wanted:.3g} {self.unit}, but {self.bound.words()}"]
        best, edge = None, max(wanted, self.least_edge)
        for _ in range(MOST_LOOKS):
            found = self.look.at(rounded(edge))
            if self.bound.fits(found):
                best, self.least_edge = found, min(self.least_edge, self.bound.edge_of(found))
                if edge <= wanted or self.bound.usage(found) > NEAR_BOUND:
                    return found
                edge = max(wanted, self.least_edge)
            elif best and best.edge < CLOSE * edge:
                return best
            else:
                edge = math.sqrt(edge * best.edge) if best else edge * max(CLOSE, self.bound.usage(found) ** (1 / 3))
        if best:
            return best
        raise RunError(f"{self.bound.words()}: found {found.elements:,} elements and {found.memory:g} GB still with elements of "
                       f"{found.edge:g} {self.unit}; allowed: a larger bound")

    def join(self):
        """Smaller elements where those of the first size leave out pieces that they join, or legs too thin to
        be filled."""
        best, edge = self.found, self.found.edge
        while best.lost() > FEW_LOST and rounded(FINER * edge) >= self.least_edge:
            edge = rounded(FINER * edge)
            found = self.look.at(edge)
            if not self.bound.fits(found):
                break
            if found.lost() < 0.5 * best.lost():
                best = found
        if best is not self.found:
            self.why = [f"with larger ones {percent(self.found.lost())} of the part would be left out"]
            self.found = best

    def refine(self):
        """Smaller elements until three lie across the thinnest wall. Where the part runs out to an edge, they
        find ever thinner places, and the first size stays."""
        given = self.found
        for _ in range(MOST_LOOKS):
            if self.found.wall >= ACROSS_WALL:
                break
            finer = rounded(self.found.edge * max(self.found.wall, 1.0) / ACROSS_WALL)
            found = self.look.at(finer) if finer >= self.least_edge else None
            if not found or not self.bound.fits(found):
                break
            self.found = found
        if self.found.wall < ACROSS_WALL:
            self.accept_wall(self.found if self.found.wall > given.wall else given)
        elif self.found is not given:
            self.why = [f"{ACROSS_WALL} or more across the thinnest wall{f', which is at {given.wall_at}' * bool(given.wall_at)}"]

    def accept_wall(self, found):
        self.found, self.least_elements = found, math.floor(10.0 * found.wall - 0.5) / 10.0  # it is printed with two digits
        self.warnings.append(f"{found.wall:g} element{'s' * (found.wall != 1)} across the wall at {found.wall_at}, advised are "
                             f"{ACROSS_WALL}: {self.bound.words()}, which leaves no smaller elements. If the part runs out to an "
                             "edge there, nothing is lost; else bending there is a rough guess")


def refuse_hanging(arguments, found):
    """Raises RunError for pieces off the plate that shall not be left out."""
    if found.hanging and arguments.keep == "all":
        one = found.hanging == 1
        share = percent(found.share_hanging)
        raise RunError(f"{arguments.part}: {found.hanging} piece{'s' * (not one)} of the part, {share} of its volume, "
                       f"{'stands' if one else 'stand'} neither on the plate nor on the rest, with elements of "
                       f"{found.edge:g} {arguments.unit}; allowed: --keep connected, which leaves {'it' if one else 'them'} out, "
                       "smaller elements (--elements), or another mesh")


def warnings_of(text, found):
    """What is worth saying of a warning of the program."""
    if text.startswith("/layers: layers of ") or OUTSIDE.match(text):  # this tool has said so
        return []
    if text.startswith("/part: ") and text.endswith("; dropped"):
        more = "; smaller elements (--elements), --rotate or another mesh may keep more" if found.share_hanging > FEW_LOST else ""
        return [f"{text} (part.keep): {percent(found.share_hanging)} of the volume{more}"]
    return [text]


def sized(arguments, look):
    """The element, the thickness of a layer and why, and the beads of layers, if they are given."""
    if arguments.bead_height:
        def element_for(target):
            across = ACROSS_LAYER if target == arguments.bead_height else ACROSS_BEADS
            return Element(arguments, look, target, across)

        beads, why = Beads(arguments, look, element_for, ACROSS_BEADS), arguments.why_bead
        if beads.passes > 1:
            why = f"{why}, times the {beads.passes} beads that a simulated layer stands for"
        return beads.element, beads.target(), why, beads
    element = Element(arguments, look, arguments.thickness)
    if arguments.thickness:
        return element, arguments.thickness, "as asked for (--thickness)", None
    return element, rounded(ACROSS_LAYER * element.found.edge), "four elements; --thickness is what you deposit", None


def choose(arguments, look):
    """The entries of the config, what there is to tell of it, warnings, and the part as the program sees it
    then."""
    material, material_warnings = material_of(arguments)
    element, target, why_target, beads = sized(arguments, look)
    found, warnings = element.found, material_warnings + element.warnings
    if target / found.edge < LEAST_ACROSS_LAYER:
        warnings.append(f"a layer of {target:g} {arguments.unit} has {target / found.edge:.2g} elements, needs "
                        f"{LEAST_ACROSS_LAYER:g}, better {ACROSS_LAYER}: allow more elements (--elements, --memory), or thicker "
                        f"layers, of {LEAST_ACROSS_LAYER * found.edge:.3g} {arguments.unit} or more; one thick layer may stand "
                        "for several (--bead-height)")
    refuse_hanging(arguments, found)
    if found.floor:
        warnings.append(look.why_floor(found))
    if found.standing > 1:
        warnings.append(f"{found.standing} pieces stand on the plate: they have no release, so what is made small is the shape "
                        "on the plate")
    count, passes = layers_for(found, target), beads.passes if beads else 1
    entries = entries_of(arguments, look, element, material, Layers(target, why_target, count, passes))
    printed, said = look.check(plain(entries))
    stock, remarks, uncarried = stock_of(arguments, printed)
    if stock:  # the part is another one, and may be less high along itself
        printed, _ = look.check(plain(entries) | plain([stock]))
        count = layers_for(found_in(found.edge, found.floor, printed, []), target)
        entries = entries_of(arguments, look, element, material, Layers(target, why_target, count, passes))
        entries.insert(3, stock)  # behind the part
        printed, said = look.check(plain(entries))
    last = found_in(found.edge, found.floor, printed, said)
    if arguments.memory and last.memory > arguments.memory:
        warnings.append(f"a run takes {last.memory:g} GB, more than --memory {arguments.memory:g}")
    entries[1].remark += (f" {last.elements:,} elements, {last.memory:g} GB on one rank, about {last.seconds:g} s an iteration.")
    if beads:
        remarks = [beads.words(count, last), *remarks]
    warnings += uncarried + [line for text in last.warnings for line in warnings_of(text, found)]
    return entries, remarks, warnings, last
