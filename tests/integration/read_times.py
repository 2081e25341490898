# SPDX-License-Identifier: MIT
"""Prints the times that ParaView finds in a series of XDMF files, with the reader that makes a film of them,
and an array's values at the last:  fabseq-tools virtual-display pvpython read_times.py ARRAY FILE.xdmf..."""

import os
import sys

from paraview import servermanager, simple

if __name__ == "__main__":
    reader = simple.Xdmf3ReaderT(FileName=[os.path.abspath(path) for path in sys.argv[2:]])
    reader.UpdatePipeline()
    times = list(reader.TimestepValues)
    reader.UpdatePipeline(times[-1])
    grid = servermanager.Fetch(reader)
    if grid.IsA("vtkMultiBlockDataSet"):
        grid = grid.GetBlock(0)
    array = grid.GetCellData().GetArray(sys.argv[1])
    print(times, [array.GetValue(i) for i in range(array.GetNumberOfValues())], sep="\n")
