# SPDX-License-Identifier: MIT
"""Surfaces of triangles: finer ones, and files of them."""

from command_line import RunError  # before any package

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonExecutionModel import vtkAlgorithm
from vtkmodules.vtkFiltersCore import vtkCleanPolyData
from vtkmodules.vtkFiltersModeling import vtkAdaptiveSubdivisionFilter
from vtkmodules.vtkIOGeometry import vtkSTLWriter
from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

from render_part import poly_data

SAME_POINT = 1e-8   # of the bounding box's diagonal
ANY_AREA = 1e300    # of a triangle: only its edges are looked at


def finer(data, longest):
    """Points (n, 3) and triangles (m, 3) of a surface, whose edges are divided until none is longer. Points
    at one place become one, so that triangles which met there still do."""
    clean, divide = vtkCleanPolyData(), vtkAdaptiveSubdivisionFilter()
    clean.SetInputData(data)
    clean.SetTolerance(SAME_POINT)
    clean.SetOutputPointsPrecision(vtkAlgorithm.DOUBLE_PRECISION)
    divide.SetInputConnection(clean.GetOutputPort())
    divide.SetMaximumEdgeLength(longest)
    divide.SetMaximumTriangleArea(ANY_AREA)
    divide.SetOutputPointsPrecision(vtkAlgorithm.DOUBLE_PRECISION)
    divide.Update()
    result = divide.GetOutput()
    return (vtk_to_numpy(result.GetPoints().GetData()).copy(),
            vtk_to_numpy(result.GetPolys().GetConnectivityArray()).reshape(-1, 3).copy())


def surface_of(points, faces, arrays):
    """Triangles as VTK takes them, with arrays of the points by name."""
    data = poly_data(points, faces)
    for name, values in arrays.items():
        array = numpy_to_vtk(np.ascontiguousarray(values), deep=True)
        array.SetName(name)
        data.GetPointData().AddArray(array)
    return data


def write_surface(data, path):
    """Writes an STL file, which holds no arrays, or a VTP file."""
    writer = vtkXMLPolyDataWriter()
    if path.endswith(".stl"):
        writer = vtkSTLWriter()
        writer.SetFileTypeToBinary()
    writer.SetFileName(path)
    writer.SetInputData(data)
    if not writer.Write():
        raise RunError(f"{path}: cannot be written")
