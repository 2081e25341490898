# SPDX-License-Identifier: MIT
"""The pictures of the part in an overview: layers with what cannot be built, and distorted shapes."""

import numpy as np

from fabseq_tools.geometry.grid import in_space, nodes_of, origin_of
from fabseq_tools.geometry.node_sets import measured_nodes
from fabseq_tools.plot import render_part
from fabseq_tools.plot.camera import View
from fabseq_tools.run.command_line import RunError, warn
from fabseq_tools.run.verdict_words import FAULTS

DRAWN_DISPLACEMENT = 0.12  # of the box's longest edge: how far the largest displacement is drawn, at most
MOST_DOTS = 24
PIXELS = 1400, 1400
MOST_PINS = 9  # numbers of places in a picture


class Layers:
    """Pictures of layers, all with the same view: `images`, and for each the `pins`: column, row, colour and
    number of its largest places. `faults`: which kinds are there, as in the field `fault`.

    `groups`: prefixes in result.h5; `places`: those of each group, as in summary.json."""

    def __init__(self, run, groups, places):
        self.part = part_of(run)
        frame = self.part.nodes[np.unique(self.part.faces)]
        stored = [run.fields.get(group + "fault") for group in groups]
        self.faults = sorted({int(kind) for fault in stored if fault is not None for kind in np.unique(fault) if kind})
        images, (top, left) = crop_together([self.draw(run.fields[group + "layer"], fault, frame)
                                             for group, fault in zip(groups, stored)])
        self.images = images
        self.aspect = images[0].shape[0] / images[0].shape[1]
        view = View(self.part, frame, PIXELS)
        self.pins = [[(column - left, row - top, *named) for column, row, *named in pins_of(run, view, found)]
                     for found in places]

    def draw(self, layer, fault, frame):
        colours = (render_part.layer_colours(self.part, layer, int(layer.max())) if fault is None
                   else render_part.fault_colours(self.part, layer, fault))
        return render_part.render(self.part, frame=frame, face_colours=colours, pixels=PIXELS)


class Shapes:
    """Pictures of distorted shapes, all with the same view and colours: `images`, and `largest_each`: the
    largest displacement of each, inside the part, too."""

    def __init__(self, run, displacements):
        self.part = part_of(run)
        displacements = [render_part.node_vectors(self.part, values) for values in displacements]
        shown = np.unique(self.part.faces)
        lengths = [np.linalg.norm(displacement, axis=1) for displacement in displacements]
        self.largest_each = [length[nodes_of(run.fields["density"] > 0)].max() for length in lengths]
        self.largest = max(self.largest_each)
        self.exaggeration = plain_number(DRAWN_DISPLACEMENT * max(self.part.size) / (self.largest or 1.0))
        moved = [(self.part.nodes + self.exaggeration * u)[shown] for u in displacements]
        self.frame = np.vstack([self.part.nodes[shown], *moved])
        self.measured = spread(self.part.nodes, marked_nodes(run), MOST_DOTS)
        self.images, _ = crop_together(list(map(self.draw, displacements, lengths)))
        self.aspect = self.images[0].shape[0] / self.images[0].shape[1]

    def draw(self, displacement, length):
        colours = render_part.scalar_colours(length, self.largest, render_part.DISPLACEMENT_COLOURS)
        return render_part.render(self.part, frame=self.frame, node_colours=colours, ghost=True, pixels=PIXELS,
                                  offset=self.exaggeration * displacement, marked=self.measured)


def part_of(run):
    return render_part.VoxelPart(run.fields["density"], run.config["domain"]["size"], run.config.get("build_plate", "z-"))


def pins_of(run, view, places):
    """Column, row, colour and number of the middle of each of the largest places."""
    colours, origin = {name: colour for name, _, colour in FAULTS}, origin_of(run.config)
    for number, place in enumerate(places[:MOST_PINS], start=1):
        centre = np.array(place["centre"][:len(origin)]) - origin
        column, row = view.places(in_space(centre[None])[0])
        yield column, row, colours[place["kind"]], number


def marked_nodes(run):
    """The measured nodes; none, with a warning, if the result lacks them."""
    try:
        return measured_nodes(run)
    except RunError as error:
        warn("overview", f"{error}; until then no dots show where distortion is measured")
        return np.array([], dtype=int)


def plain_number(value):
    """The largest 1, 2, 3 or 5 times a power of ten up to `value`."""
    power = 10.0 ** np.floor(np.log10(value))
    return max(step for step in (1.0, 2.0, 3.0, 5.0) if step * power <= value * (1 + 1e-9)) * power


def spread(points, chosen, most):
    """At most `most` of the nodes `chosen`, far from each other."""
    if len(chosen) <= most:
        return chosen
    picked = [0]
    distance = np.full(len(chosen), np.inf)
    while len(picked) < most:
        distance = np.minimum(distance, np.linalg.norm(points[chosen] - points[chosen[picked[-1]]], axis=1))
        picked.append(int(distance.argmax()))
    return chosen[picked]


def crop_together(images, margin=12):
    """The images without the white rim that all of them have, and how much of it was above and on the
    left."""
    rows, columns = np.nonzero(np.any([np.any(image < 250, axis=2) for image in images], axis=0))
    top, left = max(rows.min() - margin, 0), max(columns.min() - margin, 0)
    return [image[top:rows.max() + margin, left:columns.max() + margin] for image in images], (top, left)
