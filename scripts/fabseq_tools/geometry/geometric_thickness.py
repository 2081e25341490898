# SPDX-License-Identifier: MIT
"""Measures how thick the layers of a result are, between their boundaries.

    fabseq-tools thickness RUN_DIR [--target LENGTH] [--points 1000] [--seed 1]

RUN_DIR is the output directory of an optimization or a simulation. The boundaries of layer j are the
isosurfaces (2D: isolines) of the pseudo-time at T_{j-1} and T_j, inside the part (docs/formulation.md 6).
Points are drawn on the first, evenly over its area, and the thickness is their distance to the second; a
point farther away than 1.3 times the target is drawn again, for it faces no part of the second. The target is
that of the config's layer_thickness; without one nothing is drawn again. The first and the last layer are
reported apart: of these the outer boundary is not an isosurface but the end of the part, and one close to it
is taken.

Prints a table and writes RUN_DIR/geometric_thickness.json.
"""

import itertools
import os

import h5py
import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonDataModel import vtkDataObject, vtkImageData
from vtkmodules.vtkFiltersCore import vtkContourFilter, vtkThreshold

from fabseq_tools.geometry.nearest_surface import Surface
from fabseq_tools.geometry.nodal_time import layer_times, nodal_time
from fabseq_tools.geometry.vtk_data import DOUBLE, corners_of, filtered, points_of
from fabseq_tools.run.command_line import RunError, parser_of, positive, whole_number, write_json
from fabseq_tools.run.read_run import check_grid, read_json, target_thickness

COMMAND = "thickness"

FARTHEST = 1.3  # of the target
MOST_DRAWS = 50  # rounds of drawing again; a layer that then has too few points is reported with those
MOST_POINTS = 1_000_000
END = 1e-3  # of a layer's time: how far from the part's end its isosurface is taken


def main(words):
    parser = parser_of(__doc__, COMMAND)
    parser.add_argument("directory", metavar="RUN_DIR")
    parser.add_argument("--target", type=positive, help="target thickness (default: the config's)")
    parser.add_argument("--points", type=whole_number(1, MOST_POINTS), default=1000,
                        help="points per layer (default: %(default)s)")
    parser.add_argument("--seed", type=whole_number(0), default=1, help="of the random numbers (default: %(default)s)")
    arguments = parser.parse_args(words)
    print(table(write_record(arguments.directory, arguments.target, arguments.points, arguments.seed)))


def write_record(directory, *how):
    """Writes geometric_thickness.json, and returns what is in it."""
    record = measure(directory, *how)
    write_json(os.path.join(directory, "geometric_thickness.json"), record)
    return record


def measure(directory, target=None, points=1000, seed=1):
    """The content of geometric_thickness.json, from an output directory. Raises RunError without a result."""
    config, summary = read_json(directory, "config.json"), read_json(directory, "summary.json")
    layers = summary.get("optimized", summary).get("layers")
    if layers is None:
        raise RunError(f"{directory}: holds no finished optimization or simulation")
    time, time_points = read_times(directory, config, len(layers))
    if target is None:
        target = target_thickness(config)
    rows = measure_layers(time, time_points, FARTHEST * target if target else np.inf, points, seed)
    for row, layer in zip(rows, layers):
        row["gradient"] = layer["thickness"]
    inner = [row for row in rows if row["mean"] is not None and row["place"] == "inner"]
    means = [row["mean"] for row in inner]
    between = {"layers": len(inner), "mean": np.mean(means), "least": min(means), "largest": max(means),
               "variance": np.mean([row["variance"] for row in inner]),
               "drawn_again": sum(row["drawn_again"] for row in inner)} if inner else None
    return {"target": target, "unit": config["domain"].get("unit"), "points": points, "seed": seed, "time": time.origin,
            "layers": rows, "inner": between}


def measure_layers(time, time_points, farthest, points, seed):
    """A dictionary per layer: `place` (first, inner, last, or empty), `mean`, `variance`, `least`, `largest`
    of the distances, `points` they are of, `drawn_again`."""
    random = np.random.default_rng(seed)
    used = max(j for j in range(1, len(time_points)) if time.largest > time_points[j - 1])
    rows = []
    for j, (lower, upper) in enumerate(itertools.pairwise(time_points), start=1):
        if j == 1:
            lower = time.smallest + END * (upper - lower)
        if j == used:
            upper = time.largest - END * (upper - lower)  # also where the part ends later than its last layer
        place = "empty" if j > used else "first" if j == 1 else "last" if j == used else "inner"
        distances, drawn_again = np.array([]), 0
        if place != "empty" and upper > lower:
            distances, drawn_again = draw_distances(time.isosurface(lower), time.isosurface(upper), farthest, points, random)
        figures = {"mean": np.mean, "variance": np.var, "least": np.min, "largest": np.max}
        figures = {key: figure(distances) if len(distances) else None for key, figure in figures.items()}
        rows.append({"layer": j, "place": place, **figures, "points": len(distances), "drawn_again": drawn_again})
    return rows


def draw_distances(lower, upper, farthest, points, random):
    """Distances of points of one surface from the other, and how many points were drawn again."""
    kept, drawn_again = np.array([]), 0
    for _ in range(MOST_DRAWS if lower and upper else 0):
        _, _, distances = upper.nearest(lower.sample(points - len(kept), random))
        near = distances <= farthest
        kept = np.append(kept, distances[near])
        drawn_again += int((~near).sum())
        if len(kept) == points:
            break
    return kept, drawn_again


class NodalTime:
    """Pseudo-time on the nodes of the part's elements, as VTK takes it. `values`: [z][y][x] on the nodes;
    `built`: which elements there are; `size`: edge lengths of the box, x first; `origin`: where the values
    come from, for the record."""

    def __init__(self, values, built, size, origin):
        self.origin = origin
        counts = list(built.shape[::-1])
        image = vtkImageData()
        image.SetDimensions(*[n + 1 for n in counts], *[1] * (3 - len(counts)))
        image.SetSpacing(*[length / n for length, n in zip(size, counts)], *[1.0] * (3 - len(counts)))
        for data, name, array in ((image.GetPointData(), "time", values), (image.GetCellData(), "built", built)):
            vtk_array = numpy_to_vtk(np.ascontiguousarray(array, float).ravel(), deep=True)
            vtk_array.SetName(name)
            data.SetScalars(vtk_array)
        part = vtkThreshold()
        part.SetInputArrayToProcess(0, 0, 0, vtkDataObject.FIELD_ASSOCIATION_CELLS, "built")
        self.part = filtered(image, part, UpperThreshold=0.5, ThresholdFunction=vtkThreshold.THRESHOLD_UPPER,
                             OutputPointsPrecision=DOUBLE)
        self.dimension = len(counts)
        self.smallest, self.largest = self.part.GetPointData().GetScalars().GetRange()

    def isosurface(self, level):
        """Triangles or, in 2D, lines; None without any that has an area or a length."""
        contour = vtkContourFilter()
        contour.SetValue(0, level)
        found = filtered(self.part, contour, ComputeScalars=False, OutputPointsPrecision=DOUBLE)
        cells = found.GetPolys() if self.dimension == 3 else found.GetLines()
        if cells.GetNumberOfCells() == 0:
            return None
        surface = Surface(points_of(found)[corners_of(cells, self.dimension), :self.dimension])
        return surface if len(surface.sizes) else None


def read_times(directory, config, count):
    """NodalTime of a result and T_0 ... T_N."""
    path = os.path.join(directory, "result.h5")
    try:
        with h5py.File(path, "r") as file:
            check_grid(path, file, config)
            values, origin = nodal_time(file, config)
            return NodalTime(values, file["density"][()] > 0, config["domain"]["size"], origin), layer_times(file, count)
    except (OSError, KeyError) as error:
        raise RunError(f"{path} cannot be read: {error}") from error


def table(record):
    """The record as lines of text."""
    lines = [f"{'layer':>9}{'gradient':>12}{'geometric':>12}{'deviation':>12}{'least':>12}{'largest':>12}{'drawn again':>13}"]
    for row in record["layers"]:
        if row["mean"] is None:
            continue
        name = f"{row['layer']}" + ("" if row["place"] == "inner" else f" {row['place']}")
        values = (row["gradient"], row["mean"], row["variance"]**0.5, row["least"], row["largest"])
        lines.append(f"{name:>9}" + "".join(f"{'-' if v is None else format(v, '.4g'):>12}" for v in values)
                     + f"{row['drawn_again']:>13}")
    inner = record["inner"]
    if inner:
        lines.append(f"layers between the first and the last: mean {inner['mean']:.4g} "
                     f"({inner['least']:.4g} to {inner['largest']:.4g}), mean variance "
                     f"{inner['variance']:.3g}, {inner['drawn_again']} points drawn again")
    lines.append(f"from {record['time']}, {record['points']} points per layer"
                 + (f", target {record['target']:.4g}" if record["target"] else ", no target: none drawn again"))
    return "\n".join(lines)
