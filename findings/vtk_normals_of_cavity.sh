#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# VTK 9.1.0 (Debian 12: python3-vtk9 9.1.0+really9.1.0+dfsg2-5+deb12u1), vtkPolyDataNormals with
# AutoOrientNormals.
#
# Guess:     on a closed part that is right already nothing changes: "outwards" is away from the material,
#            so the triangles of a closed cavity keep looking into it.
# Behaviour: each closed shell is turned outwards by itself: the cavity becomes a second body within the
#            part.
# Seen:      a box of 10 mm with a cavity of 4 mm: 936 mm³ before, 1064 mm³ after.
source "$(dirname "${BASH_SOURCE[0]}")/common.bash"
fetch_debian python3-vtk9=9.1.0+really9.1.0+dfsg2-5+deb12u1

debian_python - > seen.txt <<'EOF'
from solids import box, volume, write_stl
from vtkmodules.vtkFiltersCore import vtkPolyDataNormals
from vtkmodules.vtkIOGeometry import vtkSTLReader


def solid(surface):
    return "%.0f mm3" % volume([[surface.GetPoint(surface.GetCell(i).GetPointId(k)) for k in range(3)]
                                for i in range(surface.GetNumberOfCells())])


write_stl("part.stl", box((0, 0, 0), (10, 10, 10)) + box((3, 3, 3), (4, 4, 4), inwards=True))
reader = vtkSTLReader()
reader.SetFileName("part.stl")
normals = vtkPolyDataNormals()
normals.SetInputConnection(reader.GetOutputPort())
normals.SplittingOff()
normals.AutoOrientNormalsOn()
normals.Update()
print("before", solid(reader.GetOutput()))
print("after", solid(normals.GetOutput()))
EOF
expect "as read" "936 mm3" "$(sed -n 's/^before //p' seen.txt)"
expect "with AutoOrientNormals" "1064 mm3" "$(sed -n 's/^after //p' seen.txt)"
finish
