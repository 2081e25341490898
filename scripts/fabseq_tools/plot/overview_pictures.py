# SPDX-License-Identifier: MIT
"""The pictures of the part in an overview: layers and distorted shapes, all with the same view and
colours."""

import numpy as np

from fabseq_tools.geometry.grid import nodes_of
from fabseq_tools.geometry.node_sets import measured_nodes
from fabseq_tools.plot import render_part
from fabseq_tools.run.check_words import failing_words
from fabseq_tools.run.command_line import RunError, warn

DRAWN_DISPLACEMENT = 0.12  # of the box's longest edge: how far the largest displacement is drawn, at most
MOST_DOTS = 24
FAILING = (226, 40, 40)  # bytes: what the machine cannot build
CHEQUERED = (60, 60, 60)  # bytes: of every other element whose thickness is out of range


class Pictures:
    """`images`: one for each of `layers` (fields of the elements), then one for each of `displacements` (of
    the nodes). `failing`: for each of `layers` which elements cannot be built, marked in its picture;
    `out_of_range`: which are too thick or too thin, chequered.
    `largest_each`: the largest of each of the displacements, inside the part, too."""

    def __init__(self, run, layers, displacements, failing, out_of_range):
        config = run.config
        self.part = render_part.VoxelPart(run.fields["density"], config["domain"]["size"], config.get("build_plate", "z-"))
        self.displacements = [render_part.node_vectors(self.part, values) for values in displacements]
        shown = np.unique(self.part.faces)
        self.lengths = [np.linalg.norm(displacement, axis=1) for displacement in self.displacements]
        self.largest_each = [length[nodes_of(run.fields["density"] > 0)].max() for length in self.lengths]
        self.largest = max(self.largest_each)
        self.exaggeration = plain_number(DRAWN_DISPLACEMENT * max(self.part.size) / (self.largest or 1.0))
        self.frame = np.vstack([self.part.nodes[shown]] + [(self.part.nodes + self.exaggeration * u)[shown]
                               for u in self.displacements])
        self.measured = spread(self.part.nodes, marked_nodes(run), MOST_DOTS)
        self.layers, self.marks = len(layers), any(elements.any() for elements in failing)
        self.failing_words = failing_words(run)
        self.chequers = any(elements.any() for elements in out_of_range)
        self.images = crop_together([*map(self.layered, layers, failing, out_of_range),
                                     *map(self.distorted, self.displacements, self.lengths)])
        self.aspect = self.images[0].shape[0] / self.images[0].shape[1]

    def layered(self, layer, failing, out_of_range):
        colours = render_part.layer_colours(self.part, layer, int(layer.max()))
        every_other = np.indices(out_of_range.shape).sum(axis=0) % 2 == 0
        colours[(out_of_range & every_other).ravel()[self.part.face_element]] = CHEQUERED
        colours[failing.ravel()[self.part.face_element]] = FAILING
        return render_part.render(self.part, frame=self.frame, face_colours=colours)

    def distorted(self, displacement, length):
        colours = render_part.scalar_colours(length, self.largest, render_part.DISPLACEMENT_COLOURS)
        return render_part.render(self.part, frame=self.frame, node_colours=colours, ghost=True,
                                  offset=self.exaggeration * displacement, marked=self.measured)


def marked_nodes(run):
    """The measured nodes; none, with a warning, of a result of an older program."""
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
    """The images without the white rim that all of them have."""
    rows, columns = np.nonzero(np.any([np.any(image < 250, axis=2) for image in images], axis=0))
    top, left = max(rows.min() - margin, 0), max(columns.min() - margin, 0)
    return [image[top:rows.max() + margin, left:columns.max() + margin] for image in images]
