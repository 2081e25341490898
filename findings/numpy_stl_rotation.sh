#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# numpy-stl (Debian 12: python3-stl 2.9.0-2+b3), Mesh.rotate, rotate_using_matrix and transform.
#
# Guess:     a positive angle about z turns x to y, by the right-hand rule, as in robot controllers and
#            SciPy; one matrix turns a part alike wherever it is given.
# Behaviour: rotate turns x to -y. rotate_using_matrix takes the matrix transposed, transform (4 x 4)
#            takes it as it stands: the same matrix turns the part one way in the one and the other way in
#            the other.
# Seen:      a corner at (1, 0, 0), 90 degrees about z: rotate (0, -1, 0), rotate_using_matrix (0, -1, 0),
#            transform (0, 1, 0).
source "$(dirname "${BASH_SOURCE[0]}")/common.bash"
fetch_debian python3-stl=2.9.0-2+b3

debian_python - > seen.txt 2> python.log <<'EOF'
import numpy
from stl import mesh
frame = numpy.array([[0, -1, 0, 0], [1, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]])
assert (frame @ [1, 0, 0, 1] == [0, 1, 0, 1]).all()
for name, turn in (("rotate", lambda part: part.rotate([0, 0, 1], numpy.radians(90))),
                   ("rotate_using_matrix", lambda part: part.rotate_using_matrix(frame[:3, :3])),
                   ("transform", lambda part: part.transform(frame))):
    part = mesh.Mesh(numpy.zeros(1, mesh.Mesh.dtype))
    part.vectors[0] = [[1, 0, 0], [2, 0, 0], [1, 0, 1]]
    turn(part)
    print(name, *(int(x) for x in part.vectors[0][0].round()))
EOF
expect "rotate by 90 degrees about z" "0 -1 0" "$(sed -n 's/^rotate //p' seen.txt)"
expect "rotate_using_matrix" "0 -1 0" "$(sed -n 's/^rotate_using_matrix //p' seen.txt)"
expect "transform" "0 1 0" "$(sed -n 's/^transform //p' seen.txt)"
finish
