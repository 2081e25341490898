#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# VTK 9.1.0 (Debian 12: python3-vtk9 9.1.0), volumes in NRRD files whose first axis is short.
#
# Guess:     a file of dimension 3 whose axes are all of kind "domain" is a volume of scalars.
# Behaviour: where the first axis has fewer than ten values vtkNrrdReader takes them for the components of a
#            vector, whatever `kinds` says: a thin wall's scan becomes an image of one slice.
# Seen:      sizes 9 20 30, kinds domain domain domain: 20 x 30 x 1 points of 9 components; sizes 10 20 30:
#            10 x 20 x 30 points of 1.
source "$(dirname "${BASH_SOURCE[0]}")/common.bash"
fetch_debian python3-vtk9=9.1.0+really9.1.0+dfsg2-5+deb12u1

read_volume() { # length of the first axis
  debian_python - "$1" <<'EOF'
import sys

from vtkmodules.vtkIOImage import vtkNrrdReader  # this module alone: another one replaces it by a reader for MPI

length = int(sys.argv[1])
with open("scan.nrrd", "wb") as file:
    file.write(f"NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\nsizes: {length} 20 30\n"
               "space directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)\nkinds: domain domain domain\n"
               "encoding: raw\n\n".encode())
    file.write(bytes(length * 20 * 30))
reader = vtkNrrdReader()
reader.SetFileName("scan.nrrd")
reader.Update()
image = reader.GetOutput()
print(*image.GetDimensions(), "of", image.GetNumberOfScalarComponents())
EOF
}
expect "sizes 9 20 30: points, and components" "20 30 1 of 9" "$(read_volume 9)"
expect "sizes 10 20 30: points, and components" "10 20 30 of 1" "$(read_volume 10)"
finish
