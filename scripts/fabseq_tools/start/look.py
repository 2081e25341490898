# SPDX-License-Identifier: MIT
"""What the program says of a part with elements of one size (-task check)."""

import dataclasses
import math
import os
import re

from fabseq_tools.run.check_words import percent
from fabseq_tools.run.command_line import RunError, reason_of, run_command, write_json

FIRST_LOOK = 3_000       # elements of the first grid
USUAL_LAYERS = 16
MOST_LOOKS = 8           # for one choice
MOST = 0.6               # of the part: a piece off the plate for which the plate is moved up
BEYOND_ANY_PART = 1e12   # an element of this edge is filled by no mesh
NUMBERS = r"\[(.*?)\]"   # of a point
IN_THE_AIR = re.compile(rf"no element of the part has a face on the build plate .*; nearest: \d+ elements? in {NUMBERS}")
OUTSIDE = re.compile(r"^/domain: (\S+) % of the mesh's volume lies outside the box")


@dataclasses.dataclass
class Found:
    """What the program says of the part with elements of one size. `wall`: elements across the thinnest; 5 if
    there are more, and then `wall_at` is no place."""

    edge: float
    elements: int
    every: float          # elements with those of pieces that are left out
    volume: float
    wall: float
    wall_at: str
    geodesic: float
    contact: int
    memory: float
    seconds: float
    warnings: list
    standing: int         # pieces on the plate
    hanging: int          # pieces off it, which are left out
    share_hanging: float  # of the elements of all
    largest_hanging: float  # the same of the largest piece off the plate
    lowest: float         # height at which that piece begins
    floor: float          # height at which the part begins, above the mesh's lowest point: what lies below is cut off
    share_below: float    # of the mesh's volume; 0 for less than 1 %

    def lost(self):
        """As a share."""
        return self.share_hanging + self.share_below

    def most_hangs(self):
        return self.largest_hanging > MOST


class Look:
    """Asks the program. `size`: edge lengths of the mesh's box. `floor`: height at which the part begins, at
    least."""

    def __init__(self, arguments, folder, progress):
        self.arguments, self.folder, self.progress = arguments, folder, progress
        self.layers, self.floor = USUAL_LAYERS, 0.0
        self.low, self.high = self.box_of_mesh()
        self.size = [b - a for a, b in zip(self.low, self.high)]

    def check(self, content):
        """What it prints, and its warnings. Raises RunError with its own line."""
        path = os.path.join(self.folder, "look.json")
        write_json(path, content)
        try:
            done = run_command([self.arguments.program, "-config", path, "-task", "check"])
        except RunError as error:
            raise RunError(reason_of(error)) from error
        return done.stdout, [line.removeprefix("warning: ") for line in done.stderr.splitlines() if line.startswith("warning: ")]

    def why_floor(self, found):
        what = ("The pieces below, on the plate, are the smaller ones: they are" if self.floor else
                "Below, no element is half full: what lies there (a point, an edge, a thin leg, a loose piece) is")
        share = percent(found.share_below) if found.share_below else "less than 1 %"
        return (f"The part begins {found.floor:.4g} {self.arguments.unit} above the mesh's lowest point (domain.origin). {what} "
                f"cut off, {share} of the volume")

    def mesh(self):
        scale = {"scale": self.arguments.scale} if self.arguments.scale != 1.0 else {}
        turns = [[axis, degrees] for axis, degrees in zip("xyz", self.arguments.rotate) if degrees]
        return {"file": os.path.abspath(self.arguments.part), **scale, **({"rotate": turns} if turns else {})}

    def domain(self, edge, floor=0.0):
        """The element, or with a floor the box that stands on it, in whole elements of about that edge."""
        if not floor:
            return {"element": edge, "unit": self.arguments.unit}
        low = [*self.low[:2], floor]
        size = [rounded_off(b - a) for a, b in zip(low, self.high)]
        return {"origin": low, "size": size, "elements": [max(1, round(length / edge)) for length in size],
                "unit": self.arguments.unit}

    def coarse(self, edge, floor=0.0):
        """A config that the program takes however thin walls are."""
        return {"domain": self.domain(edge, floor), "part": {"mesh": {**self.mesh(), "least_elements": 0}, "keep": "connected"},
                "sequence": {"type": "heat"}, "layers": {"count": self.layers}, "node_sets": {"all": {"all": True}},
                "objective": [{"type": "distortion", "measure": "shape", "nodes": "all"}]}

    def box_of_mesh(self):
        """Its two corners."""
        try:
            printed, _ = self.check(self.coarse(BEYOND_ANY_PART))
        except RunError as error:
            printed = str(error)
        found = re.search(rf"the mesh, which lies between {NUMBERS} and {NUMBERS}", printed)
        if not found:
            raise RunError(printed)
        return [point(end) for end in found.groups()]

    def at(self, edge):
        """Where no element lies on the plate, as the part runs out to a point or an edge there, it begins
        with the lowest element."""
        self.progress.say(f"the part with elements of {edge:.3g} {self.arguments.unit}")
        floor = self.floor
        for _ in range(MOST_LOOKS):
            try:
                return found_in(edge, floor, *self.check(self.coarse(edge, floor)))
            except RunError as error:
                in_the_air = IN_THE_AIR.search(str(error))
                lowest = point(in_the_air[1])[2] if in_the_air else 0.0
                if lowest <= floor:
                    raise
                floor, refused = lowest, error
        raise refused

    def counted(self, found):
        """Elements that a run would have, once the most of the part does not hang."""
        return found.every if found.most_hangs() and self.arguments.keep is None else found.elements

    def first(self):
        """The part with some thousand elements: more where it fills little of its box, or is thin."""
        edge = (math.prod(max(e, max(self.size) / 50) for e in self.size) / FIRST_LOOK) ** (1 / 3)
        for _ in range(MOST_LOOKS):
            try:
                found = self.at(edge)
                if self.counted(found) >= FIRST_LOOK / 10:
                    return found
                reason = None
            except RunError as error:
                reason = error
            edge *= 0.6
        if reason:
            raise reason
        return found


def point(text):
    return [float(x) for x in text.split(",")]


def rounded_off(value):
    return float(f"{value:.9g}")


def found_in(edge, floor, printed, warnings):
    def one(pattern):
        found = re.search(pattern, printed, re.MULTILINE)
        if not found:
            raise RunError(f"the program's -task check says nothing of {pattern}: is it of another version?")
        return found

    pieces = re.findall(rf"^  (\d+) elements? in {NUMBERS}.*, (on|not on) the plate$", printed, re.MULTILINE)  # the ten largest
    dropped = re.search(r"^/part: (\d+) pieces? (?:is|are) not connected", "\n".join(warnings), re.MULTILINE)
    hanging = int(dropped[1]) if dropped else 0
    off_plate = [(int(count), point(low)[2]) for count, low, where in pieces if where == "not on"]
    largest, lowest = max(off_plate, default=(0, 0.0))
    part, mesh = one(r"^part: (\d+) elements.* volume (\S+)"), one(r"^mesh: .* volume (\S+); its elements have (\S+) times")
    wall = one(r"^thinnest wall: (\S+) elements?(?: at (\S+))?")
    estimate = one(r"^estimate .*memory (\S+) GB, (\S+) s an iteration")
    kept = int(part[1])
    every = kept + sum(count for count, _ in off_plate)
    if hanging > len(off_plate):
        every = max(every, kept * float(mesh[1]) * float(mesh[2]) / float(part[2]))  # its elements: before pieces are left out
    outside = [0.01 * float(found[1]) for found in map(OUTSIDE.match, warnings) if found]
    return Found(edge, kept, every, float(part[2]), float(wall[1]), wall[2] or "", float(one(r"geodesic (\S+)$")[1]),
                 int(one(r"^plate contact: (\d+)")[1]), float(estimate[1]), float(estimate[2]), warnings,
                 int(one(r"^pieces: (\d+)")[1]) - hanging, hanging, 1.0 - kept / every, largest / every, lowest, floor,
                 sum(outside))
