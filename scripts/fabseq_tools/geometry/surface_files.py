# SPDX-License-Identifier: MIT
"""Surfaces of triangles: finer ones, and files of them."""

import numpy as np
from vtkmodules.vtkFiltersCore import vtkCleanPolyData, vtkFeatureEdges
from vtkmodules.vtkFiltersModeling import vtkAdaptiveSubdivisionFilter
from vtkmodules.vtkIOGeometry import vtkSTLWriter
from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

from fabseq_tools.geometry.vtk_data import DOUBLE, add_array, corners_of, filtered, points_of, poly_data
from fabseq_tools.run.command_line import RunError

SAME_POINT = 1e-8   # of the bounding box's diagonal
ANY_AREA = 1e300    # of a triangle: only its edges are looked at


def finer(data, longest):
    """Points (n, 3) and triangles (m, 3) of a surface, whose edges are divided until none is longer. Points
    at one place become one, so that triangles which met there still do."""
    clean = filtered(data, vtkCleanPolyData(), Tolerance=SAME_POINT, OutputPointsPrecision=DOUBLE)
    result = filtered(clean, vtkAdaptiveSubdivisionFilter(), MaximumEdgeLength=longest, MaximumTriangleArea=ANY_AREA,
                      OutputPointsPrecision=DOUBLE)
    return points_of(result), corners_of(result.GetPolys(), 3).copy()


def surface_of(points, faces, arrays):
    """Triangles as VTK takes them, with arrays of the points by name."""
    data = poly_data(points, faces)
    for name, values in arrays.items():
        add_array(data, name, values)
    return data


def write_surface(data, path):
    """Writes an STL file, which holds no arrays, or a VTP file."""
    writer = vtkXMLPolyDataWriter()
    writer.SetDataModeToBinary()  # VTK 9.1 cannot read appended data with the expat of Debian's security updates
    if path.endswith(".stl"):
        writer = vtkSTLWriter()
        writer.SetFileTypeToBinary()
    writer.SetFileName(path)
    writer.SetInputData(data)
    if not writer.Write():
        raise RunError(f"{path}: cannot be written")


def boundary(data):
    """Edges with one triangle only, (n, end, axis)."""
    found = filtered(data, vtkFeatureEdges(), FeatureEdges=False, NonManifoldEdges=False, ManifoldEdges=False)
    return points_of(found)[corners_of(found.GetLines(), 2)] if found.GetNumberOfLines() else np.empty((0, 2, 3))
