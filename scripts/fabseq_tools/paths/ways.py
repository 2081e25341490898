# SPDX-License-Identifier: MIT
"""The rapid ways of the torch between passes, and how deep they run into what stands by then."""

import dataclasses

import numpy as np
from scipy.ndimage import distance_transform_edt
from scipy.spatial import KDTree

from fabseq_tools.geometry.grid import element_centres, element_edges, origin_of, plate_height
from fabseq_tools.run.progress import SILENT

STEP = 0.25  # between the places at which a way is looked at, in elements


@dataclasses.dataclass
class Way:
    """From pass `number` (from 1) to the next one. `points` (n, 3): from the retracted end to the retracted
    start. `straight`: how deep the straight way runs into what stands, `depth`: how deep this one does, which
    is raised where the straight one crosses something; `at`: where the latter is deepest."""

    number: int
    points: np.ndarray
    straight: float
    depth: float
    at: np.ndarray

    @property
    def raised(self):
        return len(self.points) > 2


class Standing:
    """What stands while a part is built: its elements, those of the substrate, and the plate, which count as
    built after pass `number`. An element of the pass's own layer stands once the waypoint next to it is
    done."""

    def __init__(self, part, passes):
        self.part, self.passes = part, passes
        self.edges, self.origin = np.array(element_edges(part.config)), origin_of(part.config)
        self.up = part.up
        centres = np.argwhere(part.judged.layer > 0)
        self.cells = tuple(centres.T)
        places = element_centres(part.config, centres)
        self.done = np.zeros(part.judged.layer.shape, int)  # number of the pass after which an element stands
        self.heights = places @ self.up
        layers = part.judged.layer[self.cells]
        last = 0
        for layer in np.unique(layers):
            own = layers == layer
            numbers = [number for number, one in enumerate(passes, start=1) if one.layer == layer]
            if numbers:
                points = np.concatenate([passes[number - 1].points for number in numbers])
                which = np.repeat(numbers, [len(passes[number - 1].points) for number in numbers])
                self.done[tuple(cells[own] for cells in self.cells)] = which[KDTree(points).query(places[own])[1]]
                last = numbers[-1]
            else:  # a layer without passes stands with those before it
                self.done[tuple(cells[own] for cells in self.cells)] = last
        self.plate = plate_height(part.config)

    def after(self, number):
        """[z][y][x]: what stands once a pass is done."""
        built = (self.part.judged.layer > 0) & (self.done <= number)
        return built if self.part.judged.substrate is None else built | self.part.judged.substrate

    def top(self, number):
        """How high that reaches along the plate's normal."""
        standing = np.argwhere(self.after(number))
        if len(standing) == 0:
            return self.plate
        return (element_centres(self.part.config, standing) @ self.up).max() + 0.5 * np.abs(self.edges @ self.up)

    def depth(self, number, points):
        """How deep a way of straight lines runs into that at most, and where; 0 where it does not."""
        places = np.concatenate([self.between(a, b) for a, b in zip(points[:-1], points[1:])])
        cells = np.floor((places - self.origin) / self.edges).astype(int)[:, ::-1]
        shape = np.array(self.part.judged.layer.shape)
        inside = np.all((cells >= 0) & (cells < shape), axis=1)
        standing = self.after(number)
        hit = inside.copy()
        hit[inside] = standing[tuple(cells[inside].T)]
        below = np.maximum(self.plate - places @ self.up, 0.0) if self.part.judged.substrate is None else np.zeros(len(places))
        deep = np.where(below > 1e-6 * self.edges.min(), below, 0.0)
        if hit.any():
            within = distance_transform_edt(np.pad(standing, 1), sampling=self.edges[::-1])[1:-1, 1:-1, 1:-1]
            deep[hit] = np.maximum(deep[hit], within[tuple(cells[hit].T)] - 0.5 * self.edges.min())
        worst = int(np.argmax(deep))
        return float(deep[worst]), places[worst]

    def between(self, a, b):
        count = int(np.ceil(np.linalg.norm(b - a) / (STEP * self.edges.min()))) + 1
        return a + np.linspace(0.0, 1.0, count)[:, None] * (b - a)


def rapid_ways(part, passes, retract, progress=SILENT):
    """The way after each pass but the last: to `retract` beyond its end along the axis, straight to as far
    from the next start, and down; where that would cross what stands, it is raised along the plate's normal
    to `retract` above all of that. Where a result does not tell its elements' layers, ways are straight."""
    standing, ways = None if part.judged.layer is None else Standing(part, passes), []
    for number, (one, other) in progress.steps(list(enumerate(zip(passes[:-1], passes[1:]), start=1)), "way after pass"):
        ends = np.array([one.points[-1] + retract * one.axes[-1], other.points[0] + retract * other.axes[0]])
        straight, at = standing.depth(number, ends) if standing else (0.0, ends[0])
        way = Way(number, ends, straight, straight, at)
        if straight > 0:
            level = standing.top(number) + retract
            lifts = ends + np.maximum(level - ends @ part.up, 0.0)[:, None] * part.up
            raised = np.array([ends[0], *lifts, ends[1]])
            depth, at = standing.depth(number, raised)
            if depth < straight:
                way = Way(number, raised, straight, depth, at)
        ways.append(way)
    return ways
