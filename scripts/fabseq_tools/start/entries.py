# SPDX-License-Identifier: MIT
"""The keys of a config for a mesh, each with the reason for its value."""

import dataclasses
import os

from fabseq_tools.run.check_words import ANY_TILT, percent
from fabseq_tools.start.config_text import Entry

NARROW = 0.3  # of the part's volume over its geodesic height: a plate contact below is little
THICKNESS = [0.6, 1.6]  # local, relative to the target: optimized parts keep it (benchmarks/evidence/results/machine.md)


@dataclasses.dataclass
class Layers:
    """Thickness of a simulated layer and the reason for it; number of layers, and of beads in each."""

    target: float
    why: str
    count: int
    passes: int

    def bead(self):
        """The thickness of a real layer."""
        return float(f"{self.target / self.passes:.12g}")

    def entry(self):
        return {"count": self.count} | ({"passes": self.passes} if self.passes > 1 else {})

    def passes_words(self):
        if self.passes == 1:
            return ""
        return (f" Each stands for {self.passes} beads (passes), each {self.bead():g} high: all thicknesses here are those of "
                "beads.")


def entries_of(arguments, look, element, material, layers):
    unit, found = arguments.unit, element.found
    mesh = look.mesh() | ({} if element.least_elements is None else {"least_elements": element.least_elements})
    wall = "The program refuses fewer than 3 elements across a wall."
    if element.least_elements is not None:
        wall = f"The wall at {found.wall_at} has {found.wall:g}, so least_elements lets it pass."
    part = {"mesh": mesh}
    if found.hanging:
        part["keep"] = "connected"
        wall += (f" keep leaves out {found.hanging} piece{'s' * (found.hanging > 1)} off the plate, "
                 f"{percent(found.share_hanging)} of the volume; --keep all refuses them.")
    interval = max(1, min(15, arguments.iterations * 2 // 9))
    name = os.path.splitext(os.path.basename(arguments.part))[0]
    return [
        Entry("name", name, "Output goes to output/NAME."),
        Entry("domain", look.domain(found.edge, found.floor), domain_words(look, element)),
        Entry("part", part, wall),
        Entry("node_sets", {"skin": {"all": True, "surface": True}}, "What a scan sees."),
        material,
        sequence(arguments, layers.count * layers.target, found),
        Entry("layers", layers.entry(),
              f"Geodesic height {found.geodesic:g} {unit} over the thickness, and 5 % more.{layers.passes_words()}"),
        Entry("projection", {"interval": interval},
              "Iterations between two sharpnesses: a third of the run or more is left for the last one."),
        Entry("objective", objective(arguments, found), "What is made small. The first term is printed."),
        Entry("constraints", constraints(arguments, layers),
              "What holds: the machine's limits, so that the result can be built. The verdict of the run says whether it can."),
        *tools(arguments),
        Entry("baseline", {"direction": "best"},
              "The result is compared with upright planar layers, and with planar ones in the best of several directions within "
              "the tilt limit: a machine that tilts builds them without any optimized sequence."),
        Entry("optimizer", {"max_iterations": arguments.iterations,
                            "binary_iterations": min(40, max(1, arguments.iterations // 3)), "repair_iterations": 10},
              "60 show what can be gained, 120 are usually enough. The last ones are judged by binary layers. Where these still "
              "fail a check, a few more repair them, and at last their layers are mended."),
        Entry("solver", {"tolerance": "auto"},
              "Solves go as close as the design's steps are small, from 1e-2 to 1e-6, and to 1e-6 in all that is reported. That "
              "takes less time than 1e-6 throughout, and designs end as well."),
    ]


def domain_words(look, element):
    if not element.found.floor:
        return f"Edge of an element: {element.why[0]}."
    return f"{look.why_floor(element.found)}. Edge of an element, {element.found.edge:g} {element.unit}: {element.why[0]}."


def sequence(arguments, length, found):
    if arguments.sequence == "guided":
        return Entry("sequence", {"type": "guided", "filter_radius": 0},
                     "Build directions are the design, and lean by no more than tool.max_tilt. They are not smoothed, so that "
                     "layers from both sides can close a roof. Layers of type heat meet the part's sides at right angles, so a "
                     "limb that leaves sideways would need 90 degrees.")
    return Entry("sequence", {"type": "heat", "characteristic_length": float(f"{length:.6g}")},
                 f"Number of layers times their thickness.{narrow_foot(found)}")


def objective(arguments, found):
    shape = {"type": "distortion", "measure": "shape", "nodes": "skin"}
    result = [Entry("", shape | {"after_release": True}, "The shape of the skin once the plate has let go, after the best fit.")]
    if found.standing > 1:  # the program has no release for them (docs/formulation.md 4.3)
        result = [Entry("", shape, f"The shape of the skin on the plate, after the best fit: {found.standing} pieces stand "
                        "there, and each goes its own way once the plate has let go. A config for each alone has after_release.")]
    if arguments.sequence == "heat":  # guided layers start evenly: their first value, which scales the term, is nearly 0
        result.append(Entry("", {"type": "layer_uniformity", "weight": 0.05}, "Even layers; more weight makes them evener."))
    return result


def narrow_foot(found):
    """A remark where the part stands on little."""
    if found.contact * found.edge**2 * found.geodesic >= NARROW * found.volume:
        return ""
    return " The part stands on little: should its first layers stay too thin, double this."


def tools(arguments):
    """The entries on the machine: its file, and a block tool with what the command line says otherwise."""
    if not arguments.machine:
        return [Entry("tool", tool_of(arguments),
                      "The machine: put in your own, or name its file (machine). thickness is the range of local thickness that "
                      f"can be deposited, relative to the layers'. {tilt_words(arguments)} profile adds the torch, whose reach "
                      "is then checked; the constraint tool_clearance keeps it free.")]
    machine = arguments.machine
    result = [Entry("machine", machine.file, f"{machine.words()}. Keys of the config replace what follows from it.")]
    tool = {"bead_width": arguments.bead_width} if arguments.bead_width else {}
    if arguments.max_tilt != machine.max_tilt:
        tool["max_tilt"] = arguments.max_tilt
    return [*result, Entry("tool", tool, "As asked for, in place of the machine's.")] if tool else result


def tool_of(arguments):
    tool = {"thickness": THICKNESS}
    if arguments.bead_width:
        tool["bead_width"] = arguments.bead_width
    if arguments.max_tilt < ANY_TILT:
        tool |= {"axis": "normal", "max_tilt": arguments.max_tilt}
    return tool


def tilt_words(arguments):
    if arguments.max_tilt >= ANY_TILT:
        return "Without max_tilt it tilts as far as it likes."
    usual = "the default of --max-tilt, whose 180 is no limit" if arguments.usual_tilt else "as asked for (--max-tilt)"
    return f"max_tilt is the largest angle, in degrees, between torch and plate's normal: {usual}."


def constraints(arguments, layers):
    one = "layer" if layers.passes == 1 else "bead"
    result = [Entry("", {"type": "layer_thickness", "target": layers.bead(), "least_volume": 0.05},
                    f"Every {one} this thick on average, within 10 %: {layers.why}."),
              Entry("", {"type": "last_layer"}, "The part ends with a whole layer."),
              Entry("", {"type": "local_thickness"},
                    "Place by place within tool.thickness. Without a limit this and what follows adapt to the exact checks until "
                    "no element fails. Where layers meet behind a hole no sequence may keep it: a limit, such as 0.02, is the "
                    "share of the part that may be outside, smoothly counted, and lets the distortion gain a little.")]
    machine = arguments.machine
    if arguments.max_tilt < ANY_TILT and (not machine or machine.tilts):
        result.append(Entry("", {"type": "tilt"}, "No tilt beyond tool.max_tilt."))
    if machine and machine.has_torch:
        result.append(Entry("", {"type": "tool_clearance"}, "The torch keeps its clearance from what stands."))
    result.append(Entry("", {"type": "supported"}, "No element begins in the air."))
    return result
