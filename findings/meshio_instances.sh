#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# meshio (Debian 12: python3-meshio 7.0.0-3), an Abaqus file with an assembly.
#
# Guess:     the instances of a part come at their places, or the file is refused: without them the mesh
#            is another one.
# Behaviour: *ASSEMBLY and *INSTANCE are passed over without a word: each part comes once, at its own
#            origin.
# Seen:      a cube that stands at x = 0 and x = 100: 8 points, 1 hexahedron, x from 0 to 1; nothing on
#            the error output.
source "$(dirname "${BASH_SOURCE[0]}")/common.bash"
fetch_debian python3-meshio=7.0.0-3

cat > posts.inp <<EOF
*PART, NAME=POST
*NODE
$(cube_nodes)
*ELEMENT, TYPE=C3D8, ELSET=BODY
1, 1, 2, 3, 4, 5, 6, 7, 8
*END PART
*ASSEMBLY, NAME=PLATE
*INSTANCE, NAME=LEFT, PART=POST
*END INSTANCE
*INSTANCE, NAME=RIGHT, PART=POST
100, 0, 0
*END INSTANCE
*END ASSEMBLY
EOF
now=$(debian_python 2> errors.txt - <<'EOF'
import meshio
mesh = meshio.read("posts.inp")
cells = ", ".join("%d %s" % (len(block.data), block.type) for block in mesh.cells)
print("%d points, %s, x %g to %g" % (len(mesh.points), cells, mesh.points[:, 0].min(), mesh.points[:, 0].max()))
EOF
)
expect "two instances of a cube" "8 points, 1 hexahedron, x 0 to 1" "$now"
expect "bytes on the error output" 0 "$(wc -c < errors.txt)"
finish
