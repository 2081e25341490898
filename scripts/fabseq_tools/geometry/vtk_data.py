# SPDX-License-Identifier: MIT
"""Points, triangles and lines as VTK takes them, what its filters make of them, and back."""

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
from vtkmodules.vtkCommonExecutionModel import vtkAlgorithm

DOUBLE = vtkAlgorithm.DOUBLE_PRECISION


def poly_data(points, cells=None):
    """Points (n, 3), and polygons (m, corner), or lines where a cell has two corners."""
    data, vertices = vtkPolyData(), vtkPoints()
    vertices.SetData(numpy_to_vtk(np.ascontiguousarray(points, float), deep=True))
    data.SetPoints(vertices)
    if cells is not None:
        (data.SetLines if cells.shape[1] == 2 else data.SetPolys)(cell_array(cells))
    return data


def cell_array(cells):
    """Cells (m, corner) with the numbers of their points."""
    result, connectivity = vtkCellArray(), np.insert(cells, 0, cells.shape[1], axis=1).astype(np.int64)
    result.SetCells(len(cells), numpy_to_vtkIdTypeArray(connectivity.ravel(), deep=True))
    return result


def add_array(data, name, values):
    """Values of the points, by name."""
    array = numpy_to_vtk(np.ascontiguousarray(values), deep=True)
    array.SetName(name)
    data.GetPointData().AddArray(array)


def filtered(data, vtk_filter, **settings):
    """What a filter makes of the data. `settings`: arguments of its methods Set..., by what follows in their
    names."""
    vtk_filter.SetInputData(data)
    for name, value in settings.items():
        getattr(vtk_filter, f"Set{name}")(value)
    vtk_filter.Update()
    return vtk_filter.GetOutput()


def points_of(data):
    return vtk_to_numpy(data.GetPoints().GetData()).astype(float)


def corners_of(cells, count):
    """Numbers of the points of cells with `count` corners each, (m, count)."""
    return vtk_to_numpy(cells.GetConnectivityArray()).reshape(-1, count)
