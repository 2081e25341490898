# SPDX-License-Identifier: MIT
"""Opens XDMF files with ParaView's default reader and checks what arrives.

usage: fabseq-tools virtual-display pvpython read_xdmf.py FILE.xdmf [FILE.xdmf ...]

All files must hold the same grid and the same arrays, value by value. An array `node_position` must equal the
coordinates of ParaView's own points, an array `cell_position` those of its cell centres (2D: x and y): so
axes, order, spacing and offsets are right. Exit status 0 if everything agrees.
"""
import os
import sys

import numpy as np
from paraview import servermanager, simple
from paraview.vtk.util.numpy_support import vtk_to_numpy


def read(path):
    """Dimensions in points, bounds, and arrays by (centre, name)."""
    reader = simple.OpenDataFile(os.path.abspath(path))
    reader.UpdatePipeline()
    grid = servermanager.Fetch(reader)
    if grid.IsA("vtkMultiBlockDataSet"):
        grid = grid.GetBlock(0)
    centers = simple.CellCenters(Input=reader)
    centers.UpdatePipeline()
    center_points = servermanager.Fetch(centers)
    if center_points.IsA("vtkMultiBlockDataSet"):
        center_points = center_points.GetBlock(0)
    places = {
        "Cell": [center_points.GetPoint(i) for i in range(grid.GetNumberOfCells())],
        "Node": [grid.GetPoint(i) for i in range(grid.GetNumberOfPoints())],
    }
    arrays = {}
    for center, data in (("Cell", grid.GetCellData()), ("Node", grid.GetPointData())):
        for i in range(data.GetNumberOfArrays()):
            arrays[center, data.GetArrayName(i)] = np.array(vtk_to_numpy(data.GetArray(i)))
    places = {key: np.array(value) for key, value in places.items()}
    return grid.GetDimensions(), grid.GetBounds(), arrays, places


def check(condition, message):
    if not condition:
        sys.exit("read_xdmf: " + message)


def main():
    paths = sys.argv[1:]
    check(paths, __doc__)
    first = None
    for path in paths:
        dimensions, bounds, arrays, places = read(path)
        for center, name in (("Node", "node_position"), ("Cell", "cell_position")):
            check((center, name) in arrays, f"{path}: no {center} array {name}")
            found = arrays[center, name]
            expected = places[center][:, : found.shape[1]]
            check(found.shape == expected.shape, f"{path}: {name} has shape {found.shape}")
            check(np.allclose(found, expected, rtol=1e-12, atol=1e-12), f"{path}: {name} is out of place")
        if first is None:
            first = (dimensions, bounds, arrays)
        check(dimensions == first[0] and bounds == first[1], f"{path}: another grid")
        check(arrays.keys() == first[2].keys(), f"{path}: other arrays: {sorted(arrays)}")
        for key, values in arrays.items():
            check(np.array_equal(values, first[2][key]), f"{path}: other values of {key}")
        kinds = {name: (center, values.shape, str(values.dtype)) for (center, name), values in arrays.items()}
        print(path, dimensions, bounds, kinds)


if __name__ == "__main__":
    main()
