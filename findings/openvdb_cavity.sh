#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# OpenVDB 10.0.1 (Debian 12: python3-openvdb 10.0.1-2), FloatGrid.createLevelSetFromPolygons.
#
# Guess:     a closed cavity stays hollow if its triangles look into it, as they do in a right STL file,
#            and is filled if they look the other way.
# Behaviour: the triangles' sense does not count: all that the outside cannot reach is inside, so the
#            cavity is filled either way.
# Seen:      a box of 10 mm with a cavity of 4 mm, voxels of 0.25 mm: as many voxels inside as without the
#            cavity, and -0.75 (the width of the band: deep inside) in its middle, 2 mm from the nearest
#            wall, where it is hollow.
source "$(dirname "${BASH_SOURCE[0]}")/common.bash"
fetch_debian python3-openvdb=10.0.1-2

debian_python - > seen.txt 2> /dev/null <<'EOF'
import numpy
import pyopenvdb
from solids import box
solid = box((0, 0, 0), (10, 10, 10))
for name, triangles in (("none", solid), ("inwards", solid + box((3, 3, 3), (4, 4, 4), inwards=True)),
                        ("outwards", solid + box((3, 3, 3), (4, 4, 4)))):
    corners = sorted({corner for triangle in triangles for corner in triangle})
    index = {corner: i for i, corner in enumerate(corners)}
    grid = pyopenvdb.FloatGrid.createLevelSetFromPolygons(
        numpy.array(corners, numpy.float32),
        triangles=numpy.array([[index[corner] for corner in triangle] for triangle in triangles], numpy.uint32),
        transform=pyopenvdb.createLinearTransform(voxelSize=0.25), halfWidth=3)
    values = numpy.zeros((52, 52, 52), numpy.float32)
    grid.copyToArray(values, ijk=(-6, -6, -6))
    print(name, int((values < 0).sum()), "voxels inside, middle", grid.getAccessor().getValue((20, 20, 20)))
EOF
none=$(sed -n 's/^none //p' seen.txt)
echo "no cavity: $none"
expect "middle of a full box" "-0.75" "${none##* }"
expect "cavity whose triangles look into it" "$none" "$(sed -n 's/^inwards //p' seen.txt)"
expect "cavity whose triangles look out of it" "$none" "$(sed -n 's/^outwards //p' seen.txt)"
finish
