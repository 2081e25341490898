# SPDX-License-Identifier: MIT
"""What the process simulation solves for one layer of a result (docs/formulation.md 4): which elements there
are, how stiff they are, how they shrink, and which nodes are held. Layers are binary, as in result.h5."""

import os

import h5py
import numpy as np

from fabseq_tools.geometry.grid import node_positions, nodes_of, origin_of
from fabseq_tools.geometry.node_sets import contains
from fabseq_tools.run.command_line import RunError
from fabseq_tools.run.read_run import Run

PLATE_FACES = {"x": 0, "y": 1, "z": 2}
VOIGT = {3: ((0, 0), (1, 1), (0, 1)), 6: ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))}


class LayerModel:
    """The elements and nodes of a run, in the config's coordinates. Elements are [z][y][x], nodes are
    numbered x fastest. Raises RunError where the directory holds no result, or not what its strain needs."""

    def __init__(self, directory):
        self.config = Run(directory, with_fields=False, simulations=True).config
        self.path = os.path.join(directory, "result.h5")
        self.material, self.process = self.config["material"], self.config["process"]
        self.size, self.counts = self.config["domain"]["size"], self.config["domain"]["elements"]
        self.dimension = len(self.size)
        fields = self.read("density", "layer", "substrate", "build_direction")
        if fields["density"] is None or fields["layer"] is None:
            raise RunError(f"{self.path}: lacks the datasets density and layer")
        self.layer, self.direction = fields["layer"].astype(int), fields["build_direction"]
        substrate = fields["substrate"]
        self.substrate = np.zeros(self.layer.shape, bool) if substrate is None else substrate > 0
        self.density = np.where(self.substrate, 1.0, fields["density"])
        self.there = (self.density > 0) | (self.process["void"] == "quiet")
        self.layers = self.layer.max()
        self.positions = node_positions(self.size, self.counts) + origin_of(self.config)

    def read(self, *names):
        """Datasets of result.h5 by name; None for those that are missing."""
        try:
            with h5py.File(self.path, "r") as file:
                return {name: file[name][()] if name in file else None for name in names}
        except OSError as error:
            raise RunError(f"{self.path} cannot be read: {error}") from error

    def stiffness(self, last):
        """Young's modulus of each element once the layers up to `last` are built."""
        built = np.where(self.substrate | (self.layer > 0) & (self.layer <= last), self.density, 0.0)
        least = self.process["min_stiffness"]
        return self.material["young"] * (least + (1 - least) * built**self.process["stiffness_penalty"])

    def strain(self, first, last):
        """Free strain of each element, a tensor [..., axis, axis], in the step that deposits these layers.
        The load is that of a fully dense element times a power of the density, so that a grey element, which
        is softer, has another strain."""
        fresh = np.where((self.layer >= first) & (self.layer <= last), self.density, 0.0)
        factor = self.material["young"] * fresh**self.process["strain_penalty"] / self.stiffness(last)
        return factor[..., None, None] * self.inherent_strain()

    def inherent_strain(self):
        """The tensor that all elements share, or one per element where it turns with the layers."""
        given = self.material["inherent_strain"]
        if isinstance(given, dict):
            if self.direction is None:
                raise RunError(f"{self.path}: lacks the dataset build_direction, with which the strain turns; simulate again")
            across = self.direction[..., :, None] * self.direction[..., None, :]
            strain = given["tangential"] * (np.eye(self.dimension) - across) + given["normal"] * across
        else:
            strain = np.zeros((self.dimension, self.dimension))
            for (a, b), value in zip(VOIGT[len(given)], given):
                strain[a, b] = strain[b, a] = value if a == b else 0.5 * value  # Voigt has twice the shear
        scale = np.sqrt(self.material.get("strain_scale", [1] * self.dimension))
        return strain * scale[:, None] * scale[None, :]

    def corners(self):
        """Numbers of the corner nodes of the elements that are there, (element, 2^dimension), x fastest."""
        numbers = np.arange(len(self.positions)).reshape([n + 1 for n in self.layer.shape])
        return np.stack([numbers[tuple(slice(c, c + n) for c, n in zip(corner, self.layer.shape))][self.there]
                         for corner in np.ndindex(*(2,) * self.dimension)], axis=1)

    def held(self):
        """Numbers of the nodes that plate or clamps hold."""
        nodes = nodes_of(self.there)
        face = self.config.get("build_plate") or ("y-", "z-")[self.dimension - 2]
        height = self.positions[:, PLATE_FACES[face[0]]] * (1 if face[1] == "-" else -1)
        slack = 1e-6 * min(length / n for length, n in zip(self.size, self.counts))
        if self.config.get("clamps"):
            try:
                held = contains(self.config["clamps"], self.positions, slack)
            except NotImplementedError as error:
                raise RunError(f"{self.path}: clamps in a {error} cannot be exported; allowed: boxes, half spaces, spheres, "
                               "cylinders, and their unions, intersections and differences") from error
        elif self.substrate.any():
            held = nodes_of(self.substrate) & (height <= height[nodes_of(self.substrate)].min() + slack)
        else:
            held = height <= height.min() + slack
        return np.flatnonzero(held & nodes)

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
