# SPDX-License-Identifier: MIT
"""What a config for a mesh needs, chosen from what the program says of the part (-task check)."""

import math

from fabseq_tools.run.check_words import percent
from fabseq_tools.run.command_line import RunError
from fabseq_tools.start.config_text import plain
from fabseq_tools.start.entries import entries_of
from fabseq_tools.start.holes import stock_of
from fabseq_tools.start.look import MOST_LOOKS, OUTSIDE, found_in
from fabseq_tools.start.materials import material_of

MOST_ELEMENTS = 50_000   # of the part: by default
ACROSS_WALL, ACROSS_LAYER, LEAST_ACROSS_LAYER = 3, 4, 2.5  # elements (docs/how-to/choose-what-to-optimize.md)
NEAR_BOUND = 0.8         # from this share of a bound on, elements are small enough
CLOSE = 1.06             # between two edges that are tried
EXCESS = 1.05            # of the layers over the geodesic height
MOST_LAYERS = 10_000
PROGRAM_ALONE = 0.06     # GB of a run without elements
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

    def __init__(self, arguments, look, target):
        self.arguments, self.look, self.unit, self.target = arguments, look, arguments.unit, target
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
        self.least_edge = self.edge_of_bound(first)
        wanted = target / ACROSS_LAYER if target else max(self.least_edge, (first.volume / MOST_ELEMENTS) ** (1 / 3))
        self.why = [f"a quarter of a layer of {target:g} {self.unit}" if target else self.bound()]
        self.found = self.within_bound(wanted)
        self.join()

    def bound(self):
        if self.arguments.memory:
            return f"at most {self.arguments.memory:g} GB (--memory)"
        return f"at most {self.arguments.elements or MOST_ELEMENTS:,.0f} elements (--elements)"

    def fits(self, found):
        if self.arguments.memory:
            return self.memory(found) <= self.arguments.memory
        return self.look.counted(found) <= (self.arguments.elements or MOST_ELEMENTS)

    def memory(self, found):
        return found.memory * self.look.counted(found) / found.elements

    def usage(self, found):
        """Of the bound, as a share."""
        if self.arguments.memory:
            return max(self.memory(found) - PROGRAM_ALONE, 0.01) / max(self.arguments.memory - PROGRAM_ALONE, 0.01)
        return self.look.counted(found) / (self.arguments.elements or MOST_ELEMENTS)

    def edge_of_bound(self, found):
        """The smallest edge within the bound, about."""
        return found.edge * self.usage(found) ** (1 / 3)

    def within_bound(self, wanted):
        """With elements of the wanted size, or with the smallest that the bound allows."""
        if wanted < self.least_edge:
            self.why = [f"{self.why[0]} would be {wanted:.3g} {self.unit}, but {self.bound()}"]
        best, edge = None, max(wanted, self.least_edge)
        for _ in range(MOST_LOOKS):
            found = self.look.at(rounded(edge))
            if self.fits(found):
                best, self.least_edge = found, min(self.least_edge, self.edge_of_bound(found))
                if edge <= wanted or self.usage(found) > NEAR_BOUND:
                    return found
                edge = max(wanted, self.least_edge)
            elif best and best.edge < CLOSE * edge:
                return best
            else:
                edge = math.sqrt(edge * best.edge) if best else edge * max(CLOSE, self.usage(found) ** (1 / 3))
        if best:
            return best
        raise RunError(f"{self.bound()}: found {found.elements:,} elements and {found.memory:g} GB still with elements of "
                       f"{found.edge:g} {self.unit}; allowed: a larger bound")

    def join(self):
        """Smaller elements where those of the first size leave out pieces that they join, or legs too thin to
        be filled."""
        best, edge = self.found, self.found.edge
        while best.lost() > FEW_LOST and rounded(FINER * edge) >= self.least_edge:
            edge = rounded(FINER * edge)
            found = self.look.at(edge)
            if not self.fits(found):
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
            if not found or not self.fits(found):
                break
            self.found = found
        if self.found.wall < ACROSS_WALL:
            self.accept_wall(self.found if self.found.wall > given.wall else given)
        elif self.found is not given:
            self.why = [f"{ACROSS_WALL} or more across the thinnest wall{f', which is at {given.wall_at}' * bool(given.wall_at)}"]

    def accept_wall(self, found):
        self.found, self.least_elements = found, math.floor(10.0 * found.wall - 0.5) / 10.0  # it is printed with two digits
        self.warnings.append(f"{found.wall:g} element{'s' * (found.wall != 1)} across the wall at {found.wall_at}, advised are "
                             f"{ACROSS_WALL}: {self.bound()}, which leaves no smaller elements. If the part runs out to an edge "
                             "there, nothing is lost; else bending there is a rough guess")


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


def choose(arguments, look):
    """The entries of the config, what there is to tell of it, and warnings."""
    material, material_warnings = material_of(arguments)
    target = arguments.thickness or arguments.bead_height or (arguments.machine and arguments.machine.target)
    element = Element(arguments, look, target)
    found, warnings = element.found, material_warnings + element.warnings
    if target:
        why_target = ("as asked for (--thickness)" if arguments.thickness else
                      "the bead's height (--bead-height)" if arguments.bead_height else "the height of the machine's bead")
    else:
        target, why_target = rounded(ACROSS_LAYER * found.edge), "four elements; --thickness is what you deposit"
    if target / found.edge < LEAST_ACROSS_LAYER:
        warnings.append(f"a layer of {target:g} {arguments.unit} has {target / found.edge:.2g} elements, needs "
                        f"{LEAST_ACROSS_LAYER:g}, better {ACROSS_LAYER}: allow more elements (--elements, --memory), or thicker "
                        f"layers, of {LEAST_ACROSS_LAYER * found.edge:.3g} {arguments.unit} or more; one thick layer may stand "
                        "for several")
    refuse_hanging(arguments, found)
    if found.floor:
        warnings.append(look.why_floor(found))
    if found.standing > 1:
        warnings.append(f"{found.standing} pieces stand on the plate: they have no release, so what is made small is the shape "
                        "on the plate")
    count = layers_for(found, target)
    entries = entries_of(arguments, look, element, material, target, why_target, count)
    printed, said = look.check(plain(entries))
    stock, remarks, uncarried = stock_of(arguments, printed)
    if stock:  # the part is another one, and may be less high along itself
        printed, _ = look.check(plain(entries) | plain([stock]))
        count = layers_for(found_in(found.edge, found.floor, printed, []), target)
        entries = entries_of(arguments, look, element, material, target, why_target, count)
        entries.insert(3, stock)  # behind the part
        printed, said = look.check(plain(entries))
    last = found_in(found.edge, found.floor, printed, said)
    if arguments.memory and last.memory > arguments.memory:
        warnings.append(f"a run takes {last.memory:g} GB, more than --memory {arguments.memory:g}")
    entries[1].remark += (f" {last.elements:,} elements, {last.memory:g} GB on one rank, about {last.seconds:g} s an iteration.")
    return entries, remarks, warnings + uncarried + [line for text in last.warnings for line in warnings_of(text, found)]
