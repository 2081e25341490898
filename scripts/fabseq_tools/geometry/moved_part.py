# SPDX-License-Identifier: MIT
"""A part of a finished run whose geometry is moved: its surface as triangles, the grid that all rounds of a
compensation share, and the pseudo-time that moves with the part."""

import os

import h5py
import numpy as np
from scipy.ndimage import distance_transform_edt

from fabseq_tools.geometry.grid import element_edges, node_positions, nodes_of, origin_of, origin_of_slabs
from fabseq_tools.geometry.part_body import at_points, body_of, continued, drawn_surface
from fabseq_tools.geometry.surface_files import finer
from fabseq_tools.geometry.vtk_data import poly_data
from fabseq_tools.run.command_line import RunError
from fabseq_tools.run.read_run import Run

GRADIENT = "time_gradient"  # dataset
ON_PLATE = 1e-3   # of an element's edge: points so near to the plate stand on it
ROOM = 1.5        # of the largest displacement, around the part as drawn
SETTLED = 1e-6    # of an element's edge, of a place that is looked for in the drawing
MOST_STEPS = 50   # to find it


class MovedPart:
    """`drawn` and `moved` (n, 3): points as drawn and where they are built, in the config's coordinates. The
    first ones are the corners of `triangles` (m, 3), the others the nodes of the part's elements. Raises
    RunError for runs that cannot be simulated from a pseudo-time."""

    def __init__(self, directory, factor):
        run = Run(directory, simulations=True)
        self.config, self.fields, self.name, self.unit = run.config, run.fields, run.name, run.unit
        self.refuse(directory)
        self.settle_layers(run.layer_count())
        self.edges = np.array(element_edges(self.config))
        density = self.fields["density"]
        points, self.triangles, self.source = surface_of_part(self.config, density, self.edges.min())
        self.corner_count = len(points)
        self.enlarge(self.room(factor))
        self.drawn = np.concatenate([points, self.node_positions()[self.nodes]])
        self.moved = self.drawn.copy()
        self.standing = self.stand(self.drawn)
        self.weights = areas_of_corners(points, self.triangles)

    def refuse(self, directory):
        path = os.path.join(directory, "result.h5")
        if len(self.config["domain"]["size"]) == 2:
            raise RunError(f"{directory}: is a run in two dimensions; allowed: a run in three")
        missing = [name for name in ("density", "time", "displacement") if name not in self.fields]
        if missing:
            raise RunError(f"{path}: lacks the datasets {', '.join(missing)}")
        if isinstance(self.config["material"]["inherent_strain"], dict):
            raise RunError(f"{directory}: /material/inherent_strain turns with the layers, for which a pseudo-time that was "
                           "moved does not suffice; allowed: a list of numbers")

    def settle_layers(self, count):
        """Says of the layers what follows from the box, and from constraints, of which no round knows. Planes
        of sub-parts stay where they are; the times between these move with the part, as others do."""
        layers = self.config["layers"]
        if layers.get("type") == "multi_planar":
            own = {"origin": origin_of_slabs(self.config).tolist()}
        else:
            own = {"count": count}
        self.config["layers"] = layers | own

    def node_shape(self):
        return np.add(self.fields["density"].shape, 1)

    def room(self, factor):
        """Elements that a moved part may need more, at both ends of each axis; none below the plate."""
        built = nodes_of(self.fields["density"] > 0).reshape(self.node_shape())
        largest = sum(np.abs(self.fields[name][built]).max(axis=0) for name in ("displacement", "release_displacement")
                      if name in self.fields)
        room = np.repeat(np.maximum(1, np.ceil(ROOM * factor * largest / self.edges)).astype(int)[:, None], 2, axis=1)
        plate = self.config.get("build_plate", "z-")
        self.axis, self.up = "xyz".index(plate[0]), 1 if plate[1] == "-" else -1
        room[self.axis, 0 if self.up > 0 else 1] = 0
        return room

    def enlarge(self, room):
        """Gives the box as many elements more at both ends of each axis. A substrate ends where it did."""
        domain, origin = dict(self.config["domain"]), origin_of(self.config)
        if "substrate" in self.config:
            box = {"box": {"min": origin.tolist(), "max": (origin + domain["size"]).tolist()}}
            self.config["substrate"] = {"intersection": [self.config["substrate"], box]}
        for name in set(self.fields) & {"density", "time", "substrate", GRADIENT}:
            axes = np.pad(room[::-1], ((0, self.fields[name].ndim - 3), (0, 0)))
            self.fields[name] = np.pad(self.fields[name], axes)
        domain["elements"] = (np.array(domain["elements"]) + room.sum(axis=1)).tolist()
        domain["size"] = (np.array(domain["size"]) + room.sum(axis=1) * self.edges).tolist()
        domain["origin"] = (origin - room[:, 0] * self.edges).tolist()
        self.config["domain"] = domain
        self.nodes = np.flatnonzero(nodes_of(self.fields["density"] > 0))
        self.node_axes, self.centre_axes = self.axes(1)

    def axes(self, finer):
        """Coordinates x, y, z of nodes and centres of a grid whose elements have an edge so many times
        smaller."""
        domain = self.config["domain"]
        nodes = [low + edge / finer * np.arange(finer * n + 1)
                 for low, edge, n in zip(domain["origin"], self.edges, domain["elements"])]
        return nodes, [0.5 * (ends[1:] + ends[:-1]) for ends in nodes]

    def node_positions(self):
        return node_positions(self.config["domain"]["size"], self.config["domain"]["elements"]) + origin_of(self.config)

    def stand(self, points):
        """Which points stand on the plate or the substrate: these keep their height."""
        axis, edge = self.axis, self.edges[self.axis]
        floor = self.node_axes[axis][0 if self.up > 0 else -1]
        if "substrate" not in self.fields:
            return self.up * (points[:, axis] - floor) < ON_PLATE * edge
        below = points - 0.5 * self.up * edge * np.eye(3)[axis]
        return at_nearest(self.fields["substrate"] > 0, self.centre_axes, below)

    def displacement_at(self, fields, released):
        """Displacement of a simulation of the moved part at `moved`, from nodes of its part alone."""
        field = fields["displacement"] + (fields["release_displacement"] if released else 0.0)
        known = nodes_of(fields["density"] > 0).reshape(field.shape[:-1])
        finer = fields["density"].shape[0] // self.fields["density"].shape[0]
        return at_points(continued(field, known), self.axes(finer)[0], self.moved)

    def move(self, by):
        """Moves the points; those that stand on something along it alone."""
        by = by.copy()
        by[self.standing, self.axis] = 0.0
        self.moved = self.moved + by
        outside = [np.any((places < axis[0]) | (places > axis[-1])) and number != self.axis
                   for number, (axis, places) in enumerate(zip(self.node_axes, self.corners().T))]
        if any(outside):
            raise RunError("the moved part leaves the grid, so what remains does not fall; try a smaller --factor")

    def places(self, finer=1):
        """Where the elements' centres [z][y][x], of those of a finer grid, too, lie in the drawing."""
        known = np.zeros(self.node_shape(), bool)
        known.flat[self.nodes] = True
        shift = np.zeros((*known.shape, 3))
        shift[known] = (self.moved - self.drawn)[self.corner_count:]
        shift = continued(shift, known)
        centre_axes = self.axes(finer)[1]
        centres = np.stack([grid.ravel() for grid in np.meshgrid(*centre_axes[::-1], indexing="ij")[::-1]], axis=1)
        places = centres
        for _ in range(MOST_STEPS):
            before, places = places, centres - at_points(shift, self.node_axes, places)
            if np.abs(places - before).max() < SETTLED * self.edges.min():
                break
        return places.reshape([*(len(axis) for axis in centre_axes[::-1]), 3])

    def time(self, places):
        """Pseudo-time at places in the drawing, continued beyond the part."""
        built, time = self.fields["density"] > 0, self.fields["time"]
        axes = [np.concatenate([axis[:1] - edge, axis, axis[-1:] + edge]) for axis, edge in zip(self.centre_axes, self.edges)]
        result = at_points(continued(np.pad(time, 1), np.pad(built, 1)), axes, places.reshape(-1, 3))
        return np.clip(result, time[built].min(), time[built].max()).reshape(places.shape[:-1])

    def gradient(self, places):
        """Its gradient, by which layers are checked: that of the nearest element of the part. A move of a
        small share of an element turns it by next to nothing."""
        missing = self.fields["density"] <= 0
        nearest = distance_transform_edt(missing, self.edges[::-1], return_distances=False, return_indices=True)
        field = self.fields[GRADIENT][tuple(nearest)]
        return at_nearest(field, self.centre_axes, places.reshape(-1, 3)).reshape(places.shape)

    def write_sequence(self, path, finer=1):
        places = self.places(finer)
        with h5py.File(path, "w") as file:
            file["time"] = self.time(places)
            if GRADIENT in self.fields:
                file[GRADIENT] = self.gradient(places)
            for name in set(self.fields) & {"time_points", "angles"}:
                file[name] = self.fields[name]

    def corners(self):
        """The moved corners of the triangles."""
        return self.moved[:self.corner_count]


def surface_of_part(config, density, longest):
    """Points and triangles whose edges are no longer than `longest`, and where they come from: the part's
    mesh, or else a smoothed boundary of its elements."""
    surface = drawn_surface(config)
    if surface:
        return *finer(surface.data, longest), "mesh"
    body, source = body_of(config, density, {})
    return *finer(poly_data(body.points, body.triangles()[0]), longest), source


def areas_of_corners(points, triangles):
    """Share of the surface that belongs to each of the points."""
    a, b, c = np.moveaxis(points[triangles], 1, 0)
    areas = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    shares = np.bincount(triangles.ravel(), np.repeat(areas, 3), len(points))
    return shares / shares.sum()


def at_nearest(field, axes, points):
    """Values of elements [z][y][x] that hold the points."""
    return field[tuple(np.clip(np.round((places - axis[0]) / (axis[1] - axis[0])).astype(int), 0, len(axis) - 1)
                       for axis, places in zip(axes, points.T))[::-1]]
