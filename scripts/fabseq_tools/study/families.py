# SPDX-License-Identifier: MIT
"""Settings of a config's part in layers of several kinds, all within one machine's limits."""

import dataclasses
import math

import numpy as np

from fabseq_tools.geometry.grid import node_positions, nodes_of
from fabseq_tools.run.machine import NOT_TURNED, torch_tilts
from fabseq_tools.run.read_run import passes_entry, passes_of
from fabseq_tools.study.rounds import with_constraint

ANY_TILT, ALL_AROUND = 180.0, 90.0  # degrees: without a limit, and the least that bounds no direction
USUAL_TILT = 60.0                   # largest of a scan, without a limit
ONLY_CURVED = {"deposition_speed", "last_layer", "layer_thickness", "local_thickness", "minimum_layer_volume",
               "tool_clearance", "layer_uniformity"}
ONLY_MULTI_PLANAR = {"subpart_volume", "segmentation_alignment"}
STEPS = ("optimizer.move_limit", "optimizer.final_move_limit")
FIRST_LEAN, LAST_LEAN = math.radians(3.0), math.radians(30.0)  # of sub-parts at the start


@dataclasses.dataclass
class Family:
    """A kind of layers: how its row is named, where its run goes, and what the run is asked for."""

    label: str
    name: str
    settings: dict
    task: str = "optimize"

    def run(self):
        """What Rounds.run() takes."""
        return self.name, self.settings, self.task


class Families:
    """`config`: of the part; `target`: thickness of a layer; `own`: more settings of optimized layers of a
    kind, by its name."""

    def __init__(self, config, target, own=None):
        self.config, self.target, self.own = config, target, own or {}
        tool, plate = config.get("tool", {}), config.get("build_plate")
        self.dimension = len(config["domain"].get("size", [0.0] * 3))  # a mesh has three
        self.up = np.zeros(self.dimension)
        plate = plate or "xyz"[self.dimension - 1] + "-"
        self.up["xyz".index(plate[0])] = -1.0 if plate[1] == "+" else 1.0
        self.max_tilt, self.torch = tool.get("max_tilt", ANY_TILT), bool(tool.get("profile"))
        self.tilts = torch_tilts(tool)

    def limits(self):
        """The config's constraints, and those of the machine that it lacks."""
        found = [one for one in self.config["constraints"] if self.tilts or one["type"] != NOT_TURNED]
        if self.max_tilt < ANY_TILT and self.tilts:
            found = with_constraint(found, NOT_TURNED)
        for name in ["local_thickness", *["tool_clearance"] * self.torch, "supported"]:
            found = with_constraint(found, name)
        return found

    def terms(self, curved, left_out=()):
        """Objective and constraints that layers of a kind have."""
        other = (ONLY_MULTI_PLANAR if curved else ONLY_CURVED) | set(left_out)
        return {key: [term for term in terms if term["type"] not in other]
                for key, terms in (("objective", self.config["objective"]), ("constraints", self.limits()))}

    def sequence(self, kind):
        """The config's own where it is of that kind."""
        own = self.config["sequence"]
        return own if own.get("type", "heat") == kind else {"type": kind}

    def curved_layers(self):
        own = self.config["layers"]
        return own if own.get("type", "curved") == "curved" else {"count": "auto"} | passes_entry(self.config)

    def planar(self, label, name, direction, height):
        """Planar layers of the target thickness across a direction, along which the part is that high."""
        sequence = {"type": "planar", "direction": [round(float(x), 6) for x in direction]}
        settings = {"sequence": sequence, "layers": {"count": max(1, round(height / self.target))} | passes_entry(self.config)}
        return Family(label, name, settings | self.terms(curved=True), "simulate")

    def one_layer(self):
        """The part itself, for its size along any direction."""
        return Family("part", "part", self.planar("", "", self.up, self.target).settings, "simulate")

    def start(self):
        """The design that heat layers begin with."""
        return dataclasses.replace(self.heat(), label="start", name="start", task="simulate")

    def heat(self):
        return Family("heat", "heat", self.curved("heat"))

    def guided(self):
        """Without uniformity of the layers, which is 0 at its start and so cannot be scaled by it."""
        return Family("guided", "guided", self.curved("guided", ["layer_uniformity"]))

    def curved(self, kind, left_out=()):
        settings = {"sequence": self.sequence(kind), "layers": self.curved_layers()}
        return settings | self.steps(kind) | self.terms(True, left_out) | self.own.get(kind, {})

    def steps(self, kind):
        """A config's own steps are relative to the range of its variables, and another kind has others."""
        return {} if self.config["sequence"].get("type", "heat") == kind else dict.fromkeys(STEPS, "auto")

    def multi_planar(self, subparts, lean):
        """Sub-parts that start with ever more tilt towards `lean`, a direction."""
        layers = {"type": "multi_planar", "subparts": subparts, "thickness": self.target / passes_of(self.config),
                  **passes_entry(self.config), "angles": [self.angles(self.tilted(lean, tilt)) for tilt in self.leans(subparts)],
                  "angle_bounds": self.angle_bounds()}
        settings = {"sequence": self.sequence("heat"), "layers": layers}
        return Family(f"multi-planar, {subparts} sub-parts", f"multi_planar_{subparts}", settings | self.terms(curved=False))

    def leans(self, subparts):
        """Upright in three dimensions, the second angle would have no effect."""
        last = min(LAST_LEAN, 0.5 * math.radians(self.max_tilt))
        return np.linspace(min(FIRST_LEAN, last), last, subparts)

    def tilted(self, direction, tilt):
        """The direction that leans from the plate's normal by `tilt` (radians), to the side of another."""
        aside = direction - (direction @ self.up) * self.up
        length = np.linalg.norm(aside)
        aside = aside / length if length > 0.0 else np.roll(np.abs(self.up), 1)
        return math.cos(tilt) * self.up + math.sin(tilt) * aside

    def angles(self, direction):
        """As layers.angles has them; that in the xy plane within half a turn of the plate's normal."""
        middle = math.atan2(self.up[1], self.up[0])
        turn = middle + math.remainder(math.atan2(direction[1], direction[0]) - middle, 2.0 * math.pi)
        return [turn] if self.dimension == 2 else [math.asin(max(-1.0, min(1.0, direction[2]))), turn]

    def angle_bounds(self):
        """A pair for each angle: the least box of angles around all directions within the tilt."""
        tilt = math.radians(min(self.max_tilt, ALL_AROUND))
        around = [[angle - tilt, angle + tilt] for angle in self.angles(self.up)]
        if self.dimension == 2:
            return around
        elevation = [max(-0.5 * math.pi, around[0][0]), min(0.5 * math.pi, around[0][1])]
        return [elevation, [-math.pi, math.pi] if self.up[2] else around[1]]

    def directions(self, step, azimuths):
        """(tilt in degrees, direction) of a scan within the tilt limit."""
        most = self.max_tilt if self.max_tilt < ALL_AROUND else USUAL_TILT
        sides = np.delete(np.eye(self.dimension), int(np.argmax(np.abs(self.up))), axis=0)
        turns = [0.0, math.pi] if self.dimension == 2 else [2 * math.pi * k / azimuths for k in range(azimuths)]
        for count in range(1, int(most / step + 1e-9) + 1):
            for turn in turns:
                aside = math.cos(turn) * sides[0] + (math.sin(turn) * sides[1] if self.dimension == 3 else 0.0)
                yield count * step, self.tilted(aside, math.radians(count * step))


def heights_of(run):
    """The function from a direction to the part's size along it."""
    domain = run.config["domain"]
    places = node_positions(domain["size"], domain["elements"])[nodes_of(run.fields["density"] > 0)]
    return lambda direction: float(np.ptp(places @ direction))
