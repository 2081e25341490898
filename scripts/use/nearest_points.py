# SPDX-License-Identifier: MIT
"""The nearest of a set of points, for many places at once."""

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkStaticPointLocator
from vtkmodules.vtkFiltersPoints import vtkPointInterpolator, vtkVoronoiKernel

from vtk_data import add_array, filtered, poly_data


def nearest(points, places):
    """For each of the places (m, 3) the number of the nearest of the points (n, 3), and its distance."""
    source = poly_data(points)
    add_array(source, "number", np.arange(len(points), dtype=float))
    result = filtered(poly_data(places), vtkPointInterpolator(), SourceData=source, Locator=vtkStaticPointLocator(),
                      Kernel=vtkVoronoiKernel())
    found = vtk_to_numpy(result.GetPointData().GetArray("number")).astype(int)
    return found, np.linalg.norm(points[found] - places, axis=1)
