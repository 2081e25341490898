# SPDX-License-Identifier: MIT
"""A user's config for the same part in another orientation: all that does not follow from the orientation
stays."""

import copy
import os
import re

from fabseq_tools.orientation.turned_shapes import CannotTurn
from fabseq_tools.run.command_line import RunError, run_program, write_json

STANDING = "substrate", "stock", "clamps"  # sections with a shape that stands where the part stood
SURFACE = "compared_surface"      # node set of the objective of an orientation that has lost its own
NO_NODE = "no node that touches the part"
LEAST_LEFT = 0.5   # of its nodes: a set with fewer lies between planes of the turned grid
WITH_LAYERS = ("sequence", "characteristic_length"), ("projection", "beta"), ("projection", "max")


def with_absolute_files(config, folder):
    """A copy of a config that may lie anywhere: its file names are relative to `folder`."""
    config = copy.deepcopy(config)
    named = [(section, "file") for section in (config["part"]["mesh"], config.get("material", {}), config["sequence"])]
    named += [(node_set.get("near", {}), "mesh") for node_set in config.get("node_sets", {}).values()]
    named.append((config, "machine"))
    for section, key in named:
        if key in section and (key != "machine" or os.path.isfile(os.path.join(folder, section[key]))):
            section[key] = os.path.join(folder, section[key])
    return config


def box_of_mesh(domain):
    """The domain of a mesh that is turned: a box that was given becomes the edges of its elements."""
    domain = dict(domain)
    size, elements, _ = (domain.pop(key, []) for key in ("size", "elements", "origin"))
    if "element" not in domain:
        domain["element"] = [length / count for length, count in zip(size, elements)]
    return domain


class TurnedConfig:
    """`content`: the config. `notes`: what it has lost or what was changed so that the program takes it, a
    line each."""

    def __init__(self, config, turn, motion):
        """`config`: with absolute file names; `turn`: pairs of axis and degrees after its own, which make the
        `motion` of the part."""
        self.content, self.notes, self.motion = copy.deepcopy(config), [], motion
        self.content.pop("run", None)
        mesh = self.content["part"]["mesh"]
        mesh["rotate"] = mesh.get("rotate", []) + turn
        if motion.is_identity():
            return
        if "element" not in self.content["domain"]:
            self.notes.append("domain: the box follows from the turned mesh, with elements of the same size")
            self.content["domain"] = box_of_mesh(self.content["domain"])
        self.turn_node_sets()
        self.turn_flatness()
        self.drop_what_stood()
        if isinstance(self.content["layers"].get("angles"), list):
            self.notes.append("layers.angles: kept, they are directions of the box and not of the part")

    def turn_node_sets(self):
        for name, given in list(self.content.get("node_sets", {}).items()):
            try:
                self.content["node_sets"][name] = self.motion.shape(given)
            except CannotTurn as reason:
                self.leave_out(name, reason)

    def turn_flatness(self):
        """Of flatness terms the axis."""
        lost = []
        for kind, term in self.terms():
            try:
                if "axis" in term:
                    term["axis"] = self.motion.axis(term["axis"])
            except CannotTurn as reason:
                lost.append(term)
                self.notes.append(f"{kind}: flatness of {term['nodes']} is left out: {reason}")
        self.drop_terms(lambda term: any(term is one for one in lost))

    def drop_what_stood(self):
        """Sections that say where something stands or starts in the place of the part before the turn."""
        for key in STANDING:
            if self.content.pop(key, None) is not None:
                self.notes.append(f"{key} is left out, the part stands on the build plate: its shape is that of the place "
                                  "before the turn")
        sequence = self.content["sequence"]
        if sequence["type"] == "file":
            self.content["sequence"] = {"type": "planar"}
            self.notes.append("sequence: planar in place of the file, whose pseudo-time is that of the elements before the turn")
        elif isinstance(sequence.get("start"), dict):
            del sequence["start"]
            self.notes.append("sequence.start: the plate in place of the shape, which is that of the place before the turn")

    def leave_out(self, name, reason):
        """Leaves out a node set and the terms that name it."""
        del self.content["node_sets"][name]
        named = [kind for kind, term in self.terms() if name in (term.get("nodes"), term.get("to"))]
        with_terms = f", with {len(named)} of {' and '.join(dict.fromkeys(named))} that name it" if named else ""
        self.notes.append(f"node set {name} is left out{with_terms}: {reason}")
        self.drop_terms(lambda term: name in (term.get("nodes"), term.get("to")))

    def terms(self):
        return [(kind, term) for kind in ("objective", "constraints") for term in self.content.get(kind, [])]

    def drop_terms(self, chosen):
        """An objective that loses its last distortion gets that of the comparison."""
        had_distortion = self.has_distortion()
        for kind in ("objective", "constraints"):
            if kind in self.content:
                self.content[kind] = [term for term in self.content[kind] if not chosen(term)]
        if had_distortion and not self.has_distortion():
            self.content["node_sets"][SURFACE] = {"all": True, "surface": True}
            self.content["objective"].insert(0, {"type": "distortion", "measure": "shape", "nodes": SURFACE})
            self.notes.append("objective: the shape of the whole surface, as in the comparison, since no distortion is left")

    def has_distortion(self):
        return any(term.get("type") == "distortion" for term in self.content.get("objective", []))

    def follow(self, layers, planar, before):
        """Numbers that go with the number of layers. `layers`: that of the turned part, None for multi-planar
        layers; `planar`: of its baseline; `before()`: of the part as given, None where nobody knows."""
        if self.motion.is_identity():
            return
        changes = [self.change("layers", "count", layers), self.change("baseline", "layers", planar)]
        given = {place: self.number(*place) for place in WITH_LAYERS if layers and self.number(*place) is not None}
        count = before() if given else None
        for place, value in given.items():
            changes.append(self.change(*place, float(f"{value * layers / count:.6g}") if count else "auto"))
        if any(changes):
            self.notes.append("with the number of layers: " + ", ".join(filter(None, changes)))

    def number(self, section, key):
        """What a config says, where that is a number."""
        value = self.content.get(section, {}).get(key)
        return value if isinstance(value, (int, float)) else None

    def change(self, section, key, value):
        """Puts a value in the place of a number, and returns what that changes, in words."""
        given = self.number(section, key)
        if given is None or given == value:
            return None
        self.content[section][key] = value
        return f"{section}.{key} {given:g} to {value if value == 'auto' else format(value, 'g')}"

    def settle(self, arguments, path, edge, before):
        """Writes the config, as the program takes it. Planes of the part need not be planes of the turned
        grid: a node set with few of the nodes that it had `before`, by name, gets those within half the
        longest edge of an element, too; one that the program refuses then is left out."""
        within, widened = 0.5 * edge, {}
        while True:
            write_json(path, self.content)
            name, count, reason = self.fault(arguments, path, before, widened)
            if name is None:
                self.notes += [f"the program refuses it: {reason}"] if reason else []
                return
            if name not in widened and (reason is None or NO_NODE in reason):
                given = self.content["node_sets"][name]
                given["within"] = max(within, given.get("within", 0.0))
                known = f", {before[name]} before the turn" if name in before else ""
                widened[name] = (f"node set {name}: nodes within {within:g} of it count, since {count} of the turned grid lie "
                                 f"on it{known}")
                self.notes.append(widened[name])
            else:
                self.notes = [note for note in self.notes if note != widened.get(name)]
                self.leave_out(name, reason)

    def fault(self, arguments, path, before, widened):
        """A node set that has too few nodes or is refused, how many it has, and the program's reason, if it
        refuses the config; None in place of what there is not."""
        sets = sorted(self.content.get("node_sets", {}), key=len, reverse=True)  # names may begin with others
        try:
            counts = counts_of(run_program(arguments, path, "check"))
        except RunError as error:
            return next((name for name in sets if str(error).startswith(f"/node_sets/{name}")), None), 0, str(error)
        few = (name for name in sets if name not in widened and counts.get(name, 0) < LEAST_LEFT * before.get(name, 0))
        name = next(few, None)
        return name, counts.get(name, 0), None


def counts_of(printed):
    """Nodes of the sets by name, as -task check says them."""
    return {name: int(count) for name, count in re.findall(r"^node set (.+): (\d+) nodes$", printed, re.MULTILINE)}
