# SPDX-License-Identifier: MIT
"""The elements of a simulation, which part and substrate consist of, and fields between their nodes."""

import itertools

import numpy as np

from fabseq_tools.geometry.grid import origin_of
from fabseq_tools.geometry.nearest_surface import voxel_surface
from fabseq_tools.run.command_line import RunError

ON_FACE = 1e-6  # of an element's edge: how close to a face a point is on it


class VoxelModel:
    """`solid` [z][y][x]: whether an element belongs to the part or the substrate."""

    def __init__(self, config, fields):
        self.solid = (fields["density"] > 0) | (fields.get("substrate", 0) > 0)
        self.counts, self.dimension = np.array(self.solid.shape[::-1]), self.solid.ndim
        self.size, self.origin = np.array(config["domain"]["size"]), origin_of(config)
        self.longest_edge = float(np.max(self.size / self.counts))
        self.surface = voxel_surface(self.solid, self.size, self.origin)

    def elements_at(self, points):
        """For each point the index, x first, of an element that holds it, or -1; a face belongs to both
        sides."""
        position, found = (points - self.origin) / self.size * self.counts, np.full(points.shape, -1)
        for shift in itertools.product((0.0, -ON_FACE, ON_FACE), repeat=self.dimension):
            index = np.clip(np.floor(position + shift), 0, self.counts - 1).astype(int)
            holds = np.all(np.abs(position - index - 0.5) <= 0.5 + ON_FACE, axis=1) & self.solid[tuple(index.T[::-1])]
            found = np.where((holds & (found[:, 0] < 0))[:, None], index, found)
        return found

    def moved_in(self, points):
        """The points, those outside moved to the nearest place of the model, and how far each was moved."""
        outside = self.elements_at(points)[:, 0] < 0
        moved, distances = points.copy(), np.zeros(len(points))
        moved[outside], _, distances[outside] = self.surface.nearest(points[outside])
        return moved, distances

    def interpolate(self, fields, points):
        """Values of fields [...][z][y][x][axis] of nodes at points of the model: [...][point][axis]."""
        elements = self.elements_at(points)
        if np.any(elements < 0):
            raise RunError(f"{points[elements[:, 0] < 0][0].tolist()} lies neither in the part nor in the substrate")
        local = np.clip((points - self.origin) / self.size * self.counts - elements, 0.0, 1.0)
        values = 0.0
        for corner in itertools.product((0, 1), repeat=self.dimension):
            weights = np.prod(np.where(corner, local, 1.0 - local), axis=1)
            values = values + weights[:, None] * fields[(..., *(elements + corner).T[::-1], slice(None))]
        return values
