# SPDX-License-Identifier: MIT
"""Lines on a surface within a layer along which a torch fills it: outlines, and a hatch inside them."""

import dataclasses

import numpy as np
from scipy.spatial import KDTree
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkFiltersCore import vtkClipPolyData, vtkContourFilter, vtkStripper
from vtkmodules.vtkFiltersModeling import vtkAdaptiveSubdivisionFilter

from fabseq_tools.geometry.surface_files import boundary
from fabseq_tools.geometry.vtk_data import DOUBLE, add_array, corners_of, filtered, points_of, poly_data

LEVEL = 0.25           # of the way through a layer: where its paths lie; thin ends of a layer reach no higher
LEAST_SLOPE = 0.3      # of the median: the layer is thought no thicker where its values hardly rise
LONGEST_EDGE = 1 / 3   # of the surface's triangles, in beads
PIECE, MOST_PIECES = 1 / 8, 64  # edge of the pieces that a layer's volume is counted in, in beads; per tetrahedron
BOUNDARY_STEP = 1 / 20  # between the points that stand for the boundary, in beads
SHORTEST = 0.5         # of a line, in beads: shorter ones are left out
NARROWEST = 0.25       # width that is hatched, in beads
TURNING = 0.25         # mean square of the normal's part across the hatch, up to which it may be turned


@dataclasses.dataclass
class Line:
    """`points` (n, 3); `closed`: the last point is the first one again; `row`: of a hatch."""

    points: np.ndarray
    kind: str
    closed: bool = False
    row: int = 0


class PathSurface:
    """A surface within a layer, in triangles of at most a third of a bead. `low`, `high`: between which the
    layer's values lie really, where it ends at the part's end. `centres`, `volumes`: of what it consists."""

    def __init__(self, part, layer, width):
        body = part.body.part(part.body.label == layer.number)
        values = layer.values(body)
        self.layer, self.width = layer, width
        self.low, self.high = max(layer.lower, values.min()), min(layer.upper, values.max())
        self.pieces, self.volumes = in_pieces(body, PIECE * width)
        body.label[:] = 0
        values, _ = body.cut(values - self.low - LEVEL * (self.high - self.low))
        body.label = body.side(values).astype(int)
        faces, own, other = body.triangles()
        used, corners = np.unique(faces[(own == 0) & (other == 1)], return_inverse=True)
        coarse = poly_data(body.points[used], corners.reshape(-1, 3))
        add_array(coarse, "slope", layer.slope(body, np.arange(len(body.points)))[used])
        self.data = filtered(coarse, vtkAdaptiveSubdivisionFilter(), MaximumEdgeLength=LONGEST_EDGE * width,
                             MaximumTriangleArea=width**2, MaximumNumberOfPasses=20, OutputPointsPrecision=DOUBLE)
        self.points = points_of(self.data)
        self.corners = corners_of(self.data.GetPolys(), 3)
        self.slope = vtk_to_numpy(self.data.GetPointData().GetArray("slope"))
        a, b, c = np.moveaxis(self.points[self.corners], 1, 0)
        normals = 0.5 * np.cross(b - a, c - a)
        self.areas = np.linalg.norm(normals, axis=1)
        self.normals = normals / np.where(self.areas > 0, self.areas, 1.0)[:, None]

    def spots(self):
        """Places (n, 3) of equal quarters of the triangles, and their areas."""
        weights = np.array([(1, 1, 1), (4, 1, 1), (1, 4, 1), (1, 1, 4)]) / np.array([[3], [6], [6], [6]])
        places = np.einsum("qc,ncx->nqx", weights, self.points[self.corners]).reshape(-1, 3)
        return places, np.repeat(self.areas / 4.0, 4)

    def below(self):
        """How far the layer reaches below the points, along its build direction."""
        slope = np.linalg.norm(self.slope, axis=1)
        return LEVEL * (self.high - self.low) / np.maximum(slope, LEAST_SLOPE * np.median(slope) + 1e-300)

    def directions(self):
        return self.slope / np.maximum(np.linalg.norm(self.slope, axis=1), 1e-300)[:, None]

    def lines(self, outlines, angle):
        """Outlines from the outside on, then the hatch; `angle`: of the hatch with the x axis, in degrees."""
        depth = self.depths()
        add_array(self.data, "depth", depth)
        found = [Line(points, "outline", closed) for k in range(outlines)
                 for points, closed in contours(self.data, "depth", [(k + 0.5) * self.width])]
        rest = clipped(self.data, "depth", outlines * self.width)
        if rest.GetNumberOfCells():
            found += self.hatch(rest, angle)
        found = [line for line in found if length(line.points) > SHORTEST * self.width]
        return found or self.one_line(depth)

    def depths(self):
        """Distance of the points from the surface's boundary."""
        ends = boundary(self.data)
        if len(ends) == 0:
            return np.full(len(self.points), np.inf)
        count = np.ceil(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1) / (BOUNDARY_STEP * self.width)).astype(int)
        which = np.repeat(np.arange(len(ends)), count)
        share = (np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)) / count[which]
        return KDTree(ends[which, 0] + share[:, None] * (ends[which, 1] - ends[which, 0])).query(self.points)[0]

    def hatch(self, rest, angle):
        across = self.across(angle)
        place = points_of(rest) @ across
        low, high = place.min(), place.max()
        if high - low < NARROWEST * self.width:
            return []
        rows = max(1, round((high - low) / self.width))
        levels = low + (np.arange(rows) + 0.5) * (high - low) / rows
        add_array(rest, "place", place)
        lines = contours(rest, "place", levels)
        return [Line(points, "hatch", closed, int(np.argmin(np.abs(levels - points[0] @ across)))) for points, closed in lines]

    def across(self, angle):
        """Normal of the hatch's planes: in the surface, as far as that is one plane or a cylinder."""
        moments = np.einsum("n,ni,nj->ij", self.areas, self.normals, self.normals) / self.areas.sum()
        shares, axes = np.linalg.eigh(moments)
        if shares[1] > TURNING:
            return axes[:, 0]
        normal = axes[:, 2] * (1.0 if (self.areas @ self.normals) @ axes[:, 2] >= 0 else -1.0)
        along = np.eye(3)[0] - normal[0] * normal if abs(normal[0]) < 0.9 else np.eye(3)[1] - normal[1] * normal
        along /= np.linalg.norm(along)
        turn = np.radians(angle + 90.0)
        return np.cos(turn) * along + np.sin(turn) * np.cross(normal, along)

    def one_line(self, depth):
        """Where a layer is narrower than a bead: a line along it through its deepest points, or a point."""
        middle = self.points[depth >= 0.7 * depth.max()] if np.isfinite(depth).all() else self.points
        axis = np.linalg.svd(middle - middle.mean(axis=0), full_matrices=False)[2][0] if len(middle) > 1 else np.eye(3)[0]
        place = (middle - middle.mean(axis=0)) @ axis
        bins = np.clip(((place - place.min()) / (0.5 * self.width)).astype(int), 0, None)
        points = np.array([middle[bins == k].mean(axis=0) for k in np.unique(bins)])
        return [Line(points if len(points) > 1 else np.repeat(points, 2, axis=0), "outline")]


def in_pieces(body, edge):
    """Random places (n, 3) in tetrahedra, as many in each as it has cubes of an edge, and their volumes."""
    volumes = body.volumes()
    count = np.clip(np.ceil(np.abs(volumes) / edge**3), 1, MOST_PIECES).astype(int)
    weights = np.random.default_rng(1).exponential(size=(count.sum(), 4))
    weights = np.where(np.repeat(count, count)[:, None] == 1, 0.25, weights / weights.sum(axis=1, keepdims=True))
    places = np.einsum("nc,ncx->nx", weights, body.points[np.repeat(body.corners, count, axis=0)])
    return places, np.repeat(volumes / count, count)


def length(points):
    return np.linalg.norm(np.diff(points, axis=0), axis=1).sum()


def contours(data, name, levels):
    """Lines on which an array has one of the levels, and whether they are closed."""
    data.GetPointData().SetActiveScalars(name)
    contour = vtkContourFilter()
    for number, level in enumerate(levels):
        contour.SetValue(number, level)
    found = filtered(filtered(data, contour, OutputPointsPrecision=DOUBLE), vtkStripper(), JoinContiguousSegments=True,
                     MaximumLength=1_000_000)
    if found.GetNumberOfLines() == 0:
        return []
    points, lines = points_of(found), found.GetLines()
    starts, numbers = (vtk_to_numpy(array) for array in (lines.GetOffsetsArray(), lines.GetConnectivityArray()))
    cells = [numbers[low:high] for low, high in zip(starts[:-1], starts[1:])]
    return [(points[cell], bool(cell[0] == cell[-1])) for cell in cells]


def clipped(data, name, level):
    """The part of a surface where an array is above a level."""
    data.GetPointData().SetActiveScalars(name)
    return filtered(data, vtkClipPolyData(), Value=level, OutputPointsPrecision=DOUBLE)
