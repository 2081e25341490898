# SPDX-License-Identifier: MIT
"""What the process simulation solves for one layer of a result (docs/formulation.md 4): which elements there
are, how stiff they are, how they shrink, and which nodes are held. The program says so in the group `model`
of result.h5 (docs/developer/files.md). Layers are binary, as in result.h5."""

import os

import h5py
import numpy as np

from fabseq_tools.geometry.grid import node_positions, origin_of
from fabseq_tools.run.command_line import RunError
from fabseq_tools.run.read_run import Run, lacking

VOIGT = {3: ((0, 0), (1, 1), (0, 1)), 6: ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))}


class LayerModel:
    """The elements and nodes of a run, in the config's coordinates. Elements are [z][y][x], nodes are
    numbered x fastest; `supports`: those that are held; `there`: which elements there are; `solid`: those of
    part and substrate. Raises RunError where the directory holds no whole result."""

    def __init__(self, directory):
        self.config = Run(directory, with_fields=False, simulations=True).config
        self.path = os.path.join(directory, "result.h5")
        self.material = self.config["material"]
        self.size, self.counts = self.config["domain"]["size"], self.config["domain"]["elements"]
        self.dimension = len(self.size)
        self.layer = self.needed("layer").astype(int)
        self.layers = self.layer.max()
        substrate = self.read("substrate")
        self.solid = (self.layer > 0) | (False if substrate is None else substrate > 0)
        self.supports = self.needed("model/supports")
        self.finished, self.unbuilt = self.needed("model/stiffness"), self.needed("model/unbuilt_stiffness")
        self.there = self.finished > 0
        self.strain_factor, self.inherent_strain = self.needed("model/strain_factor"), tensor(self.needed("model/strain"))
        self.positions = node_positions(self.size, self.counts) + origin_of(self.config)

    def read(self, name):
        """A dataset of result.h5; None if it is missing."""
        try:
            with h5py.File(self.path, "r") as file:
                return file[name][()] if name in file else None
        except OSError as error:
            raise RunError(f"{self.path} cannot be read: {error}") from error

    def needed(self, name, remedy=None):
        """The same; raises RunError with the remedy, by default to repeat the run."""
        values = self.read(name)
        if values is None:
            raise RunError(f"{self.path}: lacks the dataset {name}; {remedy}") if remedy else lacking(name, self.path)
        return values

    def stiffness(self, last):
        """Young's modulus of each element once the layers up to `last` are built."""
        return self.material["young"] * np.where(self.layer <= last, self.finished, self.unbuilt)

    def strain(self, first, last):
        """Free strain of each element, a tensor [..., axis, axis], in the step that deposits these layers."""
        factor = np.where((self.layer >= first) & (self.layer <= last), self.strain_factor, 0.0)
        return factor[..., None, None] * self.inherent_strain

    def corners(self):
        """Numbers of the corner nodes of the elements that are there, (element, 2^dimension), x fastest."""
        numbers = np.arange(len(self.positions)).reshape([n + 1 for n in self.layer.shape])
        return np.stack([numbers[tuple(slice(c, c + n) for c, n in zip(corner, self.layer.shape))][self.there]
                         for corner in np.ndindex(*(2,) * self.dimension)], axis=1)

    def way_back(self):
        """(turn, factor, shift) of the way from the config's coordinates to the part's own, which are those
        of the mesh file: point x lies at factor · turn · (x − shift) there. Displacements take the first
        two."""
        placement = self.config.get("run", {}).get("mesh_placement")
        if placement is None:
            return np.eye(self.dimension), 1.0, np.zeros(self.dimension)
        matrix = np.array(placement)
        scale = np.cbrt(np.linalg.det(matrix[:, :3]))
        return matrix[:, :3].T / scale, 1.0 / scale, matrix[:, 3]

    def drawn_positions(self):
        """Positions of all nodes in the part's own coordinates."""
        turn, factor, shift = self.way_back()
        return factor * (self.positions - shift) @ turn.T


def tensor(strain):
    """Symmetric tensors [..., axis, axis] of strains in the order of Voigt, with twice the shear."""
    pairs = VOIGT[strain.shape[-1]]
    dimension = max(pairs)[0] + 1
    result = np.zeros((*strain.shape[:-1], dimension, dimension))
    for component, (a, b) in enumerate(pairs):
        result[..., a, b] = result[..., b, a] = strain[..., component] * (1.0 if a == b else 0.5)
    return result
