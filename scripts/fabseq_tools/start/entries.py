# SPDX-License-Identifier: MIT
"""The keys of a config for a mesh, each with the reason for its value."""

import os

from fabseq_tools.start.config_text import Entry

NARROW = 0.3  # of the part's volume over its geodesic height: a plate contact below is little


def entries_of(arguments, look, element, material, target, why_target, count):
    unit, found = arguments.unit, element.found
    mesh = look.mesh() | ({} if element.least_elements is None else {"least_elements": element.least_elements})
    wall = "The program refuses fewer than 3 elements across a wall."
    if element.least_elements is not None:
        wall = f"The wall at {found.wall_at} has {found.wall:g}, so least_elements lets it pass."
    interval = max(1, min(15, arguments.iterations * 2 // 9))
    name = os.path.splitext(os.path.basename(arguments.part))[0]
    entries = [
        Entry("name", name, "Output goes to output/NAME."),
        Entry("domain", {"element": found.edge, "unit": unit}, f"Edge of an element: {element.why[0]}."),
        Entry("part", {"mesh": mesh}, wall),
        Entry("node_sets", {"skin": {"all": True, "surface": True}}, "What a scan sees."),
        material,
        Entry("sequence", {"type": "heat", "characteristic_length": float(f"{count * target:.6g}")},
              f"Number of layers times their thickness.{narrow_foot(found)}"),
        Entry("layers", {"count": count}, f"Geodesic height {found.geodesic:g} {unit} over the thickness, and 5 % more."),
        Entry("projection", {"interval": interval},
              "Iterations between two sharpnesses: a third of the run or more is left for the last one."),
        Entry("objective", [
            Entry("", {"type": "distortion", "measure": "shape", "nodes": "skin", "after_release": True},
                  "The shape of the skin once the plate has let go, after the best fit."),
            Entry("", {"type": "layer_uniformity", "weight": 0.05}, "Even layers; more weight makes them evener.")],
            "What is made small. The first term is printed."),
        Entry("constraints", constraints(arguments, target, why_target), "What holds."),
    ]
    tool = tool_of(arguments)
    if tool:
        entries.append(Entry("tool", tool, "The machine; tool.profile adds the torch, whose reach is then checked."))
    entries.append(Entry("optimizer", {"max_iterations": arguments.iterations,
                                       "binary_iterations": min(40, max(1, arguments.iterations // 3))},
                         "60 show what can be gained, 120 are usually enough. The last ones are judged by binary layers."))
    return entries


def narrow_foot(found):
    """A remark where the part stands on little."""
    if found.contact * found.edge**2 * found.geodesic >= NARROW * found.volume:
        return ""
    return " The part stands on little: should its first layers stay too thin, double this."


def tool_of(arguments):
    tool = {}
    if arguments.bead_width:
        tool["bead_width"] = arguments.bead_width
    if arguments.max_tilt:
        tool |= {"axis": "normal", "max_tilt": arguments.max_tilt}
    return tool


def constraints(arguments, target, why_target):
    result = [Entry("", {"type": "layer_thickness", "target": target, "least_volume": 0.05},
                    f"Every layer this thick on average, within 10 %: {why_target}."),
              Entry("", {"type": "last_layer"}, "The part ends with a whole layer."),
              Entry("", {"type": "local_thickness", "limit": 0.03},
                    "Place by place between 0.5 and 1.5 times the thickness, but for a share of the part.")]
    if arguments.max_tilt:
        result.append(Entry("", {"type": "tilt", "limit": 0.003}, "No tilt beyond tool.max_tilt, but for a share of the part."))
    return result
