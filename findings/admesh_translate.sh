#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# ADMesh 0.98.4 (Debian 12: admesh 0.98.4-2), --translate.
#
# Guess:     --translate=1,2,3 moves a part by that much, so that the parts of an assembly, or a part and its
#            plate, stay together when each file is moved alike.
# Behaviour: it moves the lowest corner of the file's box to that place. Where options stand does not matter:
#            --scale always comes first.
# Seen:      a tetrahedron in the box 5..15 x 5..10 x 5..8: lowest corner 1 2 3, and with --scale=2 behind it
#            1 2 3, not 2 4 6.
source "$(dirname "${BASH_SOURCE[0]}")/common.bash"
fetch_debian admesh=0.98.4-2

debian_python - > part.stl <<'EOF'
corners = [(5, 5, 5), (15, 5, 5), (5, 10, 5), (5, 5, 8)]
print("solid part")
for face in (0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3):
    print("facet normal 0 0 0\nouter loop")
    for corner in face:
        print("vertex", *corners[corner])
    print("endloop\nendfacet")
print("endsolid part")
EOF
lowest() { admesh "$@" part.stl | sed -n 's/^Min . = *\([^,]*\),.*/\1/p' | awk '{printf "%s%g", sep, $1; sep = " "}'; }
expect "lowest corner as it is" "5 5 5" "$(lowest)"
expect "lowest corner, --translate=1,2,3" "1 2 3" "$(lowest --translate=1,2,3)"
expect "lowest corner, --translate=1,2,3 --scale=2" "1 2 3" "$(lowest --translate=1,2,3 --scale=2)"
finish
