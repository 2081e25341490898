# SPDX-License-Identifier: MIT
"""The layers of a finished run as bodies in tetrahedra, cut off at the part's surface."""

import dataclasses
import itertools
import os

import h5py
import numpy as np
from scipy.spatial import KDTree

from fabseq_tools.geometry.grid import element_edges, nodes_of, origin_of, origin_of_slabs, up_of
from fabseq_tools.geometry.judged import Judged
from fabseq_tools.geometry.nodal_time import layer_times, nodal_time, times_of_nodes
from fabseq_tools.geometry.part_body import at_points, body_of, continued
from fabseq_tools.geometry.slopes import node_slopes
from fabseq_tools.geometry.slivers import join_slivers, join_thin_ends
from fabseq_tools.geometry.tetrahedra import Tetrahedra
from fabseq_tools.run.command_line import RunError
from fabseq_tools.run.progress import SILENT
from fabseq_tools.run.read_run import Run, check_grid, passes_of, slab_thickness

GROUPS = {"optimized": "", "planar": "planar/", "start": "start/"}
BLOCKS = {"optimized": ("optimized", "simulated"), "planar": ("baseline",), "start": ("start",)}
BEADS = "beads"  # folder of a run, with its real layers
SNAPPED = 1e-3  # of a layer: points of the body so near to an interface lie on it


@dataclasses.dataclass
class Layer:
    """Layer `number` lies where `values` of the body's points are between `lower` and `upper`, which are
    times, or for multi-planar layers heights along `direction`."""

    number: int
    lower: float
    upper: float
    direction: np.ndarray | None = None
    subpart: int | None = None

    def values(self, body):
        return body.fields["time"] if self.direction is None else body.fields["place"] @ self.direction

    def slope(self, body, points):
        return body.fields["slope"][points] if self.direction is None else np.tile(self.direction, (len(points), 1))


def run_of_layers(directory, of):
    """A run, and the folder with its layers: real ones, where its simulated layers stand for several."""
    run = Run(directory, with_fields=False, simulations=True)
    passes, folder = passes_of(run.config), os.path.join(directory, BEADS)
    if passes == 1:
        return run, directory
    if of == "optimized" and os.path.isfile(os.path.join(folder, "result.h5")):
        return Run(folder, with_fields=False, simulations=True), folder
    raise RunError(f"{directory}: each of the layers stands for {passes} beads, and the run has cut "
                   f"{'none' if of == 'optimized' else 'only the optimized ones'} into them; allowed: a run of -task simulate "
                   "with this sequence, which cuts its layers")


class LayeredPart:
    """Where simulated layers stand for several real ones, it has the real ones.

    `body`: Tetrahedra whose labels are numbers of layers, from 1, in the config's coordinates; `layers`:
    those that hold an element, by number; `source`: what the body is cut off at; `origin`: where times come
    from; `judged`: what the run's check says; `joined`: volume of the slivers of each layer that became part
    of another; `up`: unit normal of the plate."""

    def __init__(self, directory, of="optimized", finer=None, progress=SILENT):
        self.progress = progress
        run, folder = run_of_layers(directory, of)
        if folder != directory:  # its grid is fine
            directory, finer = folder, finer or 1
        self.config, self.name = run.config, run.name
        if len(self.config["domain"]["size"]) == 2:
            raise RunError(f"{directory}: is a run in two dimensions; allowed: a run in three")
        blocks = [run.summary[name] for name in BLOCKS[of] if name in run.summary]
        if not blocks or of != "optimized" and "simulated" in run.summary:
            raise RunError(f"{directory}: has no {of} sequence; allowed here: "
                           + ", ".join(name for name in BLOCKS if any(block in run.summary for block in BLOCKS[name])))
        multi_planar = of == "optimized" and self.config["layers"].get("type") == "multi_planar"
        path = os.path.join(directory, "result.h5")
        try:
            with h5py.File(path, "r") as file:
                check_grid(path, file, self.config)
                self.judged = Judged(run, file, GROUPS[of], of)
                self.read(file, GROUPS[of], finer)
                self.label(self.planes(file, blocks[0]["layers"]) if multi_planar else
                           [Layer(number, lower, upper) for number, (lower, upper) in
                            enumerate(itertools.pairwise(layer_times(file, len(blocks[0]["layers"]), GROUPS[of])), start=1)])
        except (OSError, KeyError) as error:
            raise RunError(f"{path} cannot be read: {error}") from error

    def read(self, file, group, finer):
        self.progress.say("reading the part")
        density = file[group + "density"][()] if group + "density" in file else file["density"][()]
        time, self.origin = nodal_time(file, self.config, group)
        slopes = node_slopes(time, element_edges(self.config)[::-1])
        slope = np.stack([times_of_nodes(component, density > 0) for component in slopes[::-1]], axis=-1)
        self.body, self.source = body_of(self.config, density, {"time": time, "slope": slope}, finer)
        self.body.fields["place"] = self.body.points - origin_of_slabs(self.config)
        edges = element_edges(self.config)
        self.node_axes = [low + edge * np.arange(n + 1)
                          for low, edge, n in zip(origin_of(self.config), edges, density.shape[::-1])]
        self.node_time = continued(time, nodes_of(density > 0).reshape(time.shape))
        self.up = up_of(self.config)
        self.elements_volume = density.sum() * np.prod(element_edges(self.config))

    def planes(self, file, table):
        """Multi-planar layers, by sub-part and slab."""
        if "angles" not in file or any("slab" not in row for row in table):
            raise RunError("result.h5 and summary.json do not tell directions and slabs of the multi-planar layers")
        elevation, azimuth = np.moveaxis(file["angles"][()], -1, 0)
        across = np.cos(elevation)
        directions = np.stack([across * np.cos(azimuth), across * np.sin(azimuth), np.sin(elevation)], axis=1)
        width = slab_thickness(self.config)
        return [Layer(number, (row["slab"] - 1) * width, row["slab"] * width, directions[row["subpart"] - 1], row["subpart"])
                for number, row in enumerate(table, start=1)]

    def label(self, layers):
        """Cuts the body between the layers."""
        body = self.body
        groups = [list(rows) for _, rows in itertools.groupby(layers, key=lambda layer: layer.subpart)]
        body.label[:] = layers[0].number
        if len(groups) > 1:
            stamps = self.config["layers"]["timestamps"]
            stamps = np.arange(1, len(groups)) / len(groups) if stamps == "auto" else stamps
            for stamp, rows in zip(stamps, groups[1:]):
                self.cut(rows[0], body.fields["time"] - stamp, SNAPPED / len(layers), body.label > 0)
        for rows in groups:
            self.divide(rows)
        self.times = np.array([0.0, *(layer.upper - layer.lower for layer in layers)])
        self.joined = join_slivers(body, self.judged)
        self.layers = {layer.number: layer for layer in layers if (body.label == layer.number).any()}

    def divide(self, rows):
        """Cuts what belongs to the first of some layers between all of them, in halves, so that each
        tetrahedron is looked at a few times only."""
        body = self.body
        own = body.label == rows[0].number
        done, waiting = [(body.corners[~own], body.label[~own])], [(body.corners[own], 0, len(rows))]
        while waiting:
            corners, first, end = waiting.pop()
            if end - first == 1 or not len(corners):
                done.append((corners, np.full(len(corners), rows[first].number)))
                continue
            middle = (first + end) // 2
            self.progress.say(f"cutting layers {first + 1} to {end} of {len(rows)}")
            values = rows[middle].values(body) - rows[middle - 1].upper
            values[np.abs(values) < SNAPPED * (rows[middle].upper - rows[middle].lower)] = 0.0
            half = Tetrahedra(body.points, body.fields, corners)
            values, _ = half.cut(values)
            body.points, body.fields = half.points, half.fields
            beyond = half.side(values)
            waiting += [(half.corners[beyond], middle, end), (half.corners[~beyond], first, middle)]
        body.corners, body.label = (np.concatenate(arrays) for arrays in zip(*done))

    def cut(self, layer, values, snapped, chosen):
        """Gives what lies where values of the points are positive to a layer."""
        before = self.body.label.copy()
        numbers = np.unique(before[chosen])
        values[np.abs(values) < snapped] = 0.0
        values, _ = self.body.cut(values, chosen)
        beyond = self.body.side(values) & np.isin(self.body.label, numbers)
        self.body.label[beyond] = layer.number

    def thickness(self, layer, points):
        """Local thickness of a layer and its build direction at points of the body. The first and the last
        layer reach to what is beyond the time of all. The thickness stays between those that the check has
        for the layer's elements."""
        slope = layer.slope(self.body, points)
        values = layer.values(self.body)[points]
        beyond = np.zeros(len(points))
        if layer.direction is None:
            later, earlier = np.maximum(values - layer.upper, 0.0), np.maximum(-values, 0.0)
            beyond = later * (layer.upper == 1.0) + earlier * (layer.lower == 0.0)
        length = np.linalg.norm(slope, axis=1)
        safe = np.where(length > 0, length, 1.0)
        thickness = np.where(length > 0, (layer.upper - layer.lower + beyond) / safe, np.nan)
        judged = self.judged.range(layer.number)
        return thickness if judged is None else np.clip(thickness, *judged), slope / safe[:, None]

    def levels(self, layer, points):
        """Where points lie in a layer: 0 at its lower side, 1 at its upper."""
        if layer.direction is None:
            values = at_points(self.node_time, self.node_axes, points)
        else:
            values = (points - origin_of_slabs(self.config)) @ layer.direction
        return (values - layer.lower) / (layer.upper - layer.lower)

    def judged_beads(self, layer, points):
        """Returns the axes and heights of a layer's beads at points. In planar layers all beads have the
        planes' normal and distance. In others the check has found axes and heights in the elements around;
        without a check the method returns None."""
        if layer.direction is not None:
            return np.tile(layer.direction, (len(points), 1)), np.full(len(points), layer.upper - layer.lower)
        if self.judged.range(layer.number) is None:
            return None
        slopes = self.judged.slopes(points, self.times)
        padded = np.concatenate([slopes[:1], slopes, slopes[-1:]])
        slopes = (padded[:-2] + 2.0 * padded[1:-1] + padded[2:]) / 4.0
        length = np.linalg.norm(slopes, axis=1)
        near = self.body.fields["slope"][KDTree(self.body.points).query(points)[1]] if (length < 1e-300).any() else slopes
        axes = np.where(length[:, None] > 1e-300, slopes, near)
        heights = np.clip(self.times[layer.number] / np.maximum(length, 1e-300), *self.judged.range())
        return axes / np.linalg.norm(axes, axis=1)[:, None], heights

    def join_thin_ends(self):
        for number, volume in join_thin_ends(self.body, self.judged, self.layers).items():
            self.joined[number] = self.joined.get(number, 0.0) + volume

    def joined_rows(self, scale):
        """Of the slivers that became part of other layers, for records; `scale`: of lengths."""
        return [{"layer": int(number), "volume": volume * scale**3} for number, volume in sorted(self.joined.items())]


def joined_words(record):
    """Lines of text on them."""
    if not record["joined"]:
        return []
    named = ", ".join(f"{row['layer']} ({row['volume']:.4g})" for row in record["joined"])
    total = sum(row["volume"] for row in record["joined"])
    return [f"slivers that no element of their layer stands for are part of a neighbour; by layer, with their volume: {named}; "
            f"{100 * total / record['volume']:.2g} % of the part"]
