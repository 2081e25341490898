# SPDX-License-Identifier: MIT
"""The nearest of a set of points, for many places at once."""

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkPolyData, vtkStaticPointLocator
from vtkmodules.vtkFiltersPoints import vtkPointInterpolator, vtkVoronoiKernel


def cloud(points):
    """Points (n, 3) as VTK takes them."""
    data, vertices = vtkPolyData(), vtkPoints()
    vertices.SetData(numpy_to_vtk(np.ascontiguousarray(points, float), deep=True))
    data.SetPoints(vertices)
    return data


def nearest(points, places):
    """For each of the places (m, 3) the number of the nearest of the points (n, 3), and its distance."""
    source, interpolator, locator = cloud(points), vtkPointInterpolator(), vtkStaticPointLocator()
    numbers = numpy_to_vtk(np.arange(len(points), dtype=float), deep=True)
    numbers.SetName("number")
    source.GetPointData().AddArray(numbers)
    interpolator.SetSourceData(source)
    interpolator.SetInputData(cloud(places))
    interpolator.SetLocator(locator)
    interpolator.SetKernel(vtkVoronoiKernel())
    interpolator.Update()
    found = vtk_to_numpy(interpolator.GetOutput().GetPointData().GetArray("number")).astype(int)
    return found, np.linalg.norm(points[found] - places, axis=1)
