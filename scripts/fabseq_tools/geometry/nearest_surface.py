# SPDX-License-Identifier: MIT
"""The nearest points of a surface: of a mesh file, or of the boundary of voxels."""

import itertools

import numpy as np
from vtkmodules.vtkCommonCore import reference
from vtkmodules.vtkCommonDataModel import vtkStaticCellLocator
from vtkmodules.vtkFiltersCore import vtkCleanPolyData, vtkPolyDataNormals
from vtkmodules.vtkFiltersModeling import vtkFillHolesFilter

from fabseq_tools.geometry.read_mesh import read_mesh
from fabseq_tools.geometry.vtk_data import corners_of, filtered, points_of, poly_data


class Surface:
    """Triangles, or in 2D edges: `corners` (cell, corner, axis), `sizes` twice the areas, or lengths. Which
    side of a cell is outside is not known: normals may point to either."""

    def __init__(self, corners):
        edges = corners[:, 1:] - corners[:, :1]
        normals = edges[:, 0, ::-1] * (1.0, -1.0) if corners.shape[2] == 2 else np.cross(edges[:, 0], edges[:, 1])
        sizes = np.linalg.norm(normals, axis=1)
        corners, self.sizes = corners[sizes > 0], sizes[sizes > 0]
        self.normals = normals[sizes > 0] / self.sizes[:, None]
        self.dimension, self.corners = corners.shape[2], corners
        points = np.pad(corners, ((0, 0), (0, 0), (0, 3 - self.dimension))).reshape(-1, 3)
        self.data = poly_data(points, np.arange(len(points)).reshape(corners.shape[:2]))
        self.locator = vtkStaticCellLocator()
        self.locator.SetDataSet(self.data)
        self.locator.BuildLocator()

    def closed(self):
        """With triangles over its holes, turned as those around them."""
        joined = filtered(self.data, vtkCleanPolyData())
        filled = filtered(joined, vtkFillHolesFilter(), HoleSize=1e30)
        if filled.GetNumberOfPolys() == joined.GetNumberOfPolys():
            return self
        turned = filtered(filled, vtkPolyDataNormals(), Consistency=True, Splitting=False)
        return Surface(points_of(turned)[corners_of(turned.GetPolys(), 3)])

    def sample(self, count, random):
        """Points (count, axis), evenly over the area."""
        cells = random.choice(len(self.sizes), count, p=self.sizes / self.sizes.sum())
        weights = random.exponential(size=(count, self.corners.shape[1]))  # normalized: even over a triangle
        weights /= weights.sum(axis=1, keepdims=True)
        return np.einsum("pc,pcx->px", weights, self.corners[cells])

    def nearest(self, points):
        """For each of the points (n, axis): the nearest point of the surface, the normal there, and the
        distance."""
        found, cells = np.empty((len(points), 3)), np.empty(len(points), dtype=int)
        place, cell, part, square = [0.0, 0.0, 0.0], reference(0), reference(0), reference(0.0)
        for number, point in enumerate(np.pad(points, ((0, 0), (0, 3 - self.dimension)))):
            self.locator.FindClosestPoint(point, place, cell, part, square)
            found[number], cells[number] = place, cell.get()
        found = found[:, :self.dimension]
        return found, self.normals[cells], np.linalg.norm(points - found, axis=1)


def mesh_surface(path, placement):
    """The surface in a mesh file as the program reads it, placed by a 3x4 matrix."""
    placement = np.array(placement)
    return Surface(read_mesh(path) @ placement[:, :3].T + placement[:, 3])


def voxel_surface(solid, size, origin):
    """The boundary of the elements that are there, [z][y][x]."""
    dimension, padded, cells = solid.ndim, np.pad(solid, 1), []
    square = np.array([(0, 0), (1, 0), (1, 1), (0, 1)] if dimension == 3 else [(0,), (1,)])
    for axis, side in itertools.product(range(dimension), (0, 1)):  # axes as in memory, z first
        beyond = np.roll(padded, 1 - 2 * side, axis)[(slice(1, -1),) * dimension]
        faces = np.argwhere(solid & ~beyond)[:, None] + np.insert(square, axis, side, axis=1)
        cells += [faces[:, [0, 1, 2]], faces[:, [0, 2, 3]]] if dimension == 3 else [faces]
    return Surface(np.concatenate(cells)[..., ::-1] / solid.shape[::-1] * size + origin)
