#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# CalculiX 2.20 (Debian 12: calculix-ccx 2.20-1), displacements of nodes with a *TRANSFORM.
#
# Guess:     *NODE PRINT and *NODE FILE write the same components of U, in the .dat and the .frd file.
# Behaviour: unless GLOBAL is given, *NODE PRINT writes them in the node's own system (an L stands behind
#            each row), *NODE FILE in the global one: x in one file is y in the other.
# Seen:      a cube of 1 mm, its top with a system turned by 90 degrees about z and moved by 0.01 along
#            its first axis: .dat U = 0.01 0 0, .frd U = 0 0.01 0.
source "$(dirname "${BASH_SOURCE[0]}")/common.bash"
fetch_debian calculix-ccx=2.20-1

cat > cube.inp <<EOF
*NODE, NSET=ALL
$(cube_nodes)
*ELEMENT, TYPE=C3D8, ELSET=CUBE
1, 1, 2, 3, 4, 5, 6, 7, 8
*NSET, NSET=BOTTOM
1, 2, 3, 4
*NSET, NSET=TOP
5, 6, 7, 8
*MATERIAL, NAME=STEEL
*ELASTIC
210000, 0.3
*SOLID SECTION, ELSET=CUBE, MATERIAL=STEEL
*TRANSFORM, NSET=TOP, TYPE=R
0, 1, 0, -1, 0, 0
*STEP
*STATIC
*BOUNDARY
BOTTOM, 1, 3
TOP, 1, 1, 0.01
TOP, 2, 3
*NODE PRINT, NSET=TOP
U
*NODE FILE
U
*END STEP
EOF
{ ccx -v || true; } | grep -i version
ccx -i cube > ccx.log
dat=$(awk '$1 == 5 && NF >= 4 {printf "%g %g %g%s", $2, $3, $4, $5 == "L" ? " L" : ""}' cube.dat)
frd=$(awk '/DISP/ {on = 1} /^ -3/ {on = 0}
  on && /^ -1 +5/ {printf "%g %g %g", substr($0, 14, 12) + 0, substr($0, 26, 12) + 0, substr($0, 38, 12) + 0}' cube.frd)
expect "node 5 in the .dat file" "0.01 0 0 L" "$dat"
expect "node 5 in the .frd file" "0 0.01 0" "${frd/-0 /0 }"
finish
