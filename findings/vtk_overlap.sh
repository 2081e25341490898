#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# VTK 9.1.0 (Debian 12: python3-vtk9 9.1.0+really9.1.0+dfsg2-5+deb12u1), which points and voxels lie in a
# closed surface.
#
# Guess:     where two closed bodies of one surface overlap, as parts put together from primitives do, is
#            inside.
# Behaviour: vtkPolyDataToImageStencil and vtkSelectEnclosedPoints count crossings: what lies in two
#            bodies is outside. What two bodies share becomes a hole, and nothing says so.
# Seen:      two cubes of 10 mm that share a cube of 5 mm, voxels of 0.5 mm: 1750 mm³ (both together are
#            1875), the middle of what they share is outside for both filters.
source "$(dirname "${BASH_SOURCE[0]}")/common.bash"
fetch_debian python3-vtk9=9.1.0+really9.1.0+dfsg2-5+deb12u1

debian_python - > seen.txt <<'EOF'
from solids import box, write_stl
from vtkmodules.vtkCommonCore import vtkPoints, vtkVersion
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPolyData
from vtkmodules.vtkFiltersModeling import vtkSelectEnclosedPoints
from vtkmodules.vtkImagingStencil import vtkImageStencil, vtkPolyDataToImageStencil
from vtkmodules.vtkIOGeometry import vtkSTLReader
write_stl("bodies.stl", box((0, 0, 0), (10, 10, 10)) + box((5, 5, 5), (10, 10, 10)))
reader = vtkSTLReader()
reader.SetFileName("bodies.stl")
reader.Update()
image = vtkImageData()
image.SetDimensions(40, 40, 40)
image.SetSpacing(0.5, 0.5, 0.5)
image.SetOrigin(-1.75, -1.75, -1.75)
image.AllocateScalars(3, 1)
image.GetPointData().GetScalars().Fill(1)
stencil = vtkPolyDataToImageStencil()
stencil.SetInputData(reader.GetOutput())
stencil.SetOutputOrigin(image.GetOrigin())
stencil.SetOutputSpacing(image.GetSpacing())
stencil.SetOutputWholeExtent(image.GetExtent())
cut = vtkImageStencil()
cut.SetInputData(image)
cut.SetStencilConnection(stencil.GetOutputPort())
cut.SetBackgroundValue(0)
cut.Update()
values = cut.GetOutput().GetPointData().GetScalars()
points = vtkPoints()
for point in ((2.1, 2.2, 2.3), (7.1, 7.2, 7.3), (12.1, 12.2, 12.3)):
    points.InsertNextPoint(point)
cloud = vtkPolyData()
cloud.SetPoints(points)
enclosed = vtkSelectEnclosedPoints()
enclosed.SetInputData(cloud)
enclosed.SetSurfaceData(reader.GetOutput())
enclosed.Update()
print("version", vtkVersion.GetVTKVersion())
print("stencil %g mm3" % (sum(values.GetTuple1(i) for i in range(values.GetNumberOfTuples())) / 8))
print("points", *(enclosed.IsInside(i) for i in range(3)))
EOF
sed -n 's/^version/VTK/p' seen.txt
expect "voxels inside, by vtkPolyDataToImageStencil" "1750 mm3" "$(sed -n 's/^stencil //p' seen.txt)"
expect "in the first cube, in both, in the second, by vtkSelectEnclosedPoints" "1 0 1" "$(sed -n 's/^points //p' seen.txt)"
finish
