#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# VTK 9.1.0 (Debian 12: python3-vtk9 9.1.0), scans whose axes are not those of space.
#
# Guess:     since images of VTK 9 have a direction matrix, the readers of MetaImage and NRRD files set it:
#            a scan lies on the part that it was made of, as it does in programs that obey the file.
# Behaviour: both leave the unit matrix, without a word. NRRD's `axis mins` is passed over, too.
# Seen:      axes turned by 90 degrees about z (TransformMatrix; space directions): direction matrix
#            1 0 0 0 1 0 0 0 1. NRRD with `axis mins: 10 20 30`: origin 0 0 0.
source "$(dirname "${BASH_SOURCE[0]}")/common.bash"
fetch_debian python3-vtk9=9.1.0+really9.1.0+dfsg2-5+deb12u1

cat > scan.mhd <<'EOF'
ObjectType = Image
NDims = 3
BinaryData = True
BinaryDataByteOrderMSB = False
TransformMatrix = 0 1 0 -1 0 0 0 0 1
Offset = 10 20 30
CenterOfRotation = 0 0 0
ElementSpacing = 1 2 3
DimSize = 10 11 12
ElementType = MET_UCHAR
ElementDataFile = scan.raw
EOF
head -c 1320 /dev/zero > scan.raw
cat > turned.nhdr <<'EOF'
NRRD0004
type: uint8
dimension: 3
space dimension: 3
sizes: 10 11 12
space directions: (0,1,0) (-2,0,0) (0,0,3)
space origin: (10,20,30)
kinds: domain domain domain
encoding: raw
data file: scan.raw
EOF
cat > placed.nhdr <<'EOF'
NRRD0001
type: uint8
dimension: 3
sizes: 10 11 12
spacings: 1 2 3
axis mins: 10 20 30
encoding: raw
data file: scan.raw
EOF
read_scan() { # reader, file, what is asked
  debian_python - "$@" <<'EOF'
import sys

from vtkmodules import vtkIOImage

reader = getattr(vtkIOImage, sys.argv[1])()
reader.SetFileName(sys.argv[2])
reader.Update()
image = reader.GetOutput()
matrix = image.GetDirectionMatrix()
values = image.GetOrigin() if sys.argv[3] == "origin" else [matrix.GetElement(i, j) for i in range(3) for j in range(3)]
print(*(f"{value:g}" for value in values))
EOF
}
expect "MetaImage, direction matrix" "1 0 0 0 1 0 0 0 1" "$(read_scan vtkMetaImageReader scan.mhd directions)"
expect "MetaImage, origin" "10 20 30" "$(read_scan vtkMetaImageReader scan.mhd origin)"
expect "NRRD, direction matrix" "1 0 0 0 1 0 0 0 1" "$(read_scan vtkNrrdReader turned.nhdr directions)"
expect "NRRD, origin where the file says axis mins" "0 0 0" "$(read_scan vtkNrrdReader placed.nhdr origin)"
finish
