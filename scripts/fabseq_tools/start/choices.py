# SPDX-License-Identifier: MIT
"""What a config for a mesh needs, chosen from what the program says of the part (-task check)."""

import dataclasses
import math
import os
import re

from fabseq_tools.run.command_line import RunError, reason_of, run_command, write_json
from fabseq_tools.start.config_text import plain
from fabseq_tools.start.entries import entries_of
from fabseq_tools.start.materials import material_of

MOST_ELEMENTS, FIRST_LOOK = 50_000, 3_000  # of the part: by default, and of the first grid
ACROSS_WALL, ACROSS_LAYER, LEAST_ACROSS_LAYER = 3, 4, 2.5  # elements (docs/how-to/choose-what-to-optimize.md)
NEAR_BOUND = 0.8         # from this share of a bound on, elements are small enough
CLOSE = 1.06             # between two edges that are tried
EXCESS = 1.05            # of the layers over the geodesic height
USUAL_LAYERS, MOST_LAYERS = 16, 10_000
MOST_LOOKS = 8           # for one choice
BEYOND_ANY_PART = 1e12   # an element of this edge is filled by no mesh
PROGRAM_ALONE = 0.06     # GB of a run without elements
MOST_HANGING = 0.05      # of the elements, off the plate: what is left out unless told otherwise


@dataclasses.dataclass
class Found:
    """What the program says of the part with elements of one size. `wall`: elements across the thinnest; 5 if
    there are more, and then `wall_at` is no place."""

    edge: float
    elements: int
    volume: float
    wall: float
    wall_at: str
    geodesic: float
    contact: int
    memory: float
    seconds: float
    warnings: list
    standing: int        # pieces on the plate
    hanging: int         # pieces off it, which are left out
    share_hanging: float  # of the elements of all


class Look:
    """Asks the program. `size`: edge lengths of the mesh's box."""

    def __init__(self, arguments, folder, progress):
        self.arguments, self.folder, self.progress = arguments, folder, progress
        self.layers = USUAL_LAYERS
        self.size = self.size_of_mesh()

    def check(self, content):
        """What it prints, and its warnings. Raises RunError with its own line."""
        path = os.path.join(self.folder, "look.json")
        write_json(path, content)
        try:
            done = run_command([self.arguments.program, "-config", path, "-task", "check"])
        except RunError as error:
            raise RunError(reason_of(error)) from error
        return done.stdout, [line.removeprefix("warning: ") for line in done.stderr.splitlines() if line.startswith("warning: ")]

    def mesh(self):
        scale = {"scale": self.arguments.scale} if self.arguments.scale != 1.0 else {}
        return {"file": os.path.abspath(self.arguments.part), **scale}

    def coarse(self, edge):
        """A config that the program takes however thin walls are."""
        return {"domain": {"element": edge, "unit": self.arguments.unit},
                "part": {"mesh": {**self.mesh(), "least_elements": 0}, "keep": "connected"},
                "sequence": {"type": "heat"}, "layers": {"count": self.layers}, "node_sets": {"all": {"all": True}},
                "objective": [{"type": "distortion", "nodes": "all"}]}

    def size_of_mesh(self):
        try:
            printed, _ = self.check(self.coarse(BEYOND_ANY_PART))
        except RunError as error:
            printed = str(error)
        found = re.search(r"the mesh, which lies between \[(.*?)\] and \[(.*?)\]", printed)
        if not found:
            raise RunError(printed)
        low, high = ([float(x) for x in end.split(",")] for end in found.groups())
        return [b - a for a, b in zip(low, high)]

    def at(self, edge):
        self.progress.say(f"the part with elements of {edge:.3g} {self.arguments.unit}")
        return found_in(edge, *self.check(self.coarse(edge)))

    def first(self):
        """The part with some thousand elements: more where it fills little of its box, or is thin."""
        edge = (math.prod(max(e, max(self.size) / 50) for e in self.size) / FIRST_LOOK) ** (1 / 3)
        for _ in range(MOST_LOOKS):
            try:
                found = self.at(edge)
                if found.elements >= FIRST_LOOK / 10:
                    return found
                reason = None
            except RunError as error:
                reason = error
            edge *= 0.6
        if reason:
            raise reason
        return found


def layers_for(found, target):
    count = max(1, math.ceil(EXCESS * found.geodesic / target))
    if count > MOST_LAYERS:
        raise RunError(f"layers of {target:g} make {count:,} of the geodesic height {found.geodesic:g}; allowed: {MOST_LAYERS:,} "
                       "at most; one thick layer may stand for several")
    return count


def found_in(edge, printed, warnings):
    def one(pattern):
        found = re.search(pattern, printed, re.MULTILINE)
        if not found:
            raise RunError(f"the program's -task check says nothing of {pattern}: is it of another version?")
        return found

    pieces = re.findall(r"^  (\d+) elements in .*, (on|not on) the plate$", printed, re.MULTILINE)  # the ten largest
    dropped = re.search(r"^/part: (\d+) pieces? (?:is|are) not connected", "\n".join(warnings), re.MULTILINE)
    hanging = int(dropped[1]) if dropped else 0
    off_plate = [int(count) for count, where in pieces if where == "not on"]
    lost = sum(off_plate) + (hanging - len(off_plate)) * int(pieces[-1][0])
    part, wall = one(r"^part: (\d+) elements.* volume (\S+)"), one(r"^thinnest wall: (\S+) elements(?: at (\S+))?")
    estimate = one(r"^estimate .*memory (\S+) GB, (\S+) s an iteration")
    return Found(edge, int(part[1]), float(part[2]), float(wall[1]), wall[2] or "", float(one(r"geodesic (\S+)$")[1]),
                 int(one(r"^plate contact: (\d+)")[1]), float(estimate[1]), float(estimate[2]), warnings,
                 int(one(r"^pieces: (\d+)")[1]) - hanging, hanging, lost / (lost + int(part[1])))


def rounded(value):
    """To three digits, downwards."""
    step = 10.0 ** (math.floor(math.log10(value)) - 2)
    return float(f"{math.floor(value / step + 1e-9) * step:.3g}")


class Element:
    """The element's edge as `found.edge`, why, and how many elements a wall may have at least."""

    def __init__(self, arguments, look, target):
        self.arguments, self.look, self.unit = arguments, look, arguments.unit
        first = look.first()
        if target:
            look.layers = layers_for(first, target)
        self.least_edge = self.edge_of_bound(first)
        wanted = target / ACROSS_LAYER if target else max(self.least_edge, (first.volume / MOST_ELEMENTS) ** (1 / 3))
        self.why = [f"a quarter of a layer of {target:g} {self.unit}" if target else self.bound()]
        self.warnings, self.least_elements = [], None
        self.found = self.within_bound(wanted)
        self.refine()

    def bound(self):
        if self.arguments.memory:
            return f"at most {self.arguments.memory:g} GB (--memory)"
        return f"at most {self.arguments.elements or MOST_ELEMENTS:,.0f} elements (--elements)"

    def fits(self, found):
        if self.arguments.memory:
            return found.memory <= self.arguments.memory
        return found.elements <= (self.arguments.elements or MOST_ELEMENTS)

    def usage(self, found):
        """Of the bound, as a share."""
        if self.arguments.memory:
            return max(found.memory - PROGRAM_ALONE, 0.01) / max(self.arguments.memory - PROGRAM_ALONE, 0.01)
        return found.elements / (self.arguments.elements or MOST_ELEMENTS)

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


def require_on_plate(arguments, found):
    """Raises RunError for pieces off the plate that shall not be left out, or, unless asked for, are too much
    of the part for that."""
    if not found.hanging or arguments.keep == "connected":
        return
    if arguments.keep == "all" or found.share_hanging > MOST_HANGING:
        what = f"{found.hanging} piece{'s' * (found.hanging > 1)} of the part"
        raise RunError(f"{arguments.part}: {what}, {100 * found.share_hanging:.2g} % of it, "
                       f"{'stands' if found.hanging == 1 else 'stand'} neither on the plate nor on the rest, with elements of "
                       f"{found.edge:g} {arguments.unit}; allowed: --keep connected, which leaves out "
                       f"{'it' if found.hanging == 1 else 'them'}, smaller elements (--elements), or another mesh")


def choose(arguments, look):
    """The entries of the config, and warnings."""
    material, material_warnings = material_of(arguments)
    target = arguments.thickness or arguments.bead_height
    element = Element(arguments, look, target)
    found, warnings = element.found, material_warnings + element.warnings
    if target:
        why_target = "as asked for (--thickness)" if arguments.thickness else "the bead's height (--bead-height)"
    else:
        target, why_target = rounded(ACROSS_LAYER * found.edge), "four elements; --thickness is what you deposit"
    if target / found.edge < LEAST_ACROSS_LAYER:
        warnings.append(f"a layer of {target:g} {arguments.unit} has {target / found.edge:.2g} elements, needs "
                        f"{LEAST_ACROSS_LAYER:g}, better {ACROSS_LAYER}: allow more elements (--elements, --memory), or thicker "
                        f"layers, of {LEAST_ACROSS_LAYER * found.edge:.3g} {arguments.unit} or more; one thick layer may stand "
                        "for several")
    require_on_plate(arguments, found)
    if found.standing > 1:
        warnings.append(f"{found.standing} pieces stand on the plate: they have no release, so what is made small is the shape "
                        "on the plate")
    count = layers_for(found, target)
    entries = entries_of(arguments, look, element, material, target, why_target, count)
    content = plain(entries)
    last = found_in(found.edge, *look.check(content))
    if arguments.memory and last.memory > arguments.memory:
        warnings.append(f"a run takes {last.memory:g} GB, more than --memory {arguments.memory:g}")
    entries[1].remark += (f" {last.elements:,} elements, {last.memory:g} GB on one rank, about {last.seconds:g} s an iteration.")
    return entries, warnings + [text for text in last.warnings if not text.startswith("/layers: layers of ")]  # said above
