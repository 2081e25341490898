#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# gmsh 4.8.4 and CalculiX 2.20 (Debian 12: gmsh 4.8.4+ds2-3, calculix-ccx 2.20-1), bricks of second order.
#
# Guess:     `gmsh -order 2` writes bricks to a .inp file as C3D20, which ccx has.
# Behaviour: as C3D27, which ccx has not; with Mesh.SecondOrderIncomplete = 1 as C3D20. Without a physical
#            group the edges and faces come, too, as trusses and membranes (T3D3, M3D9).
# Seen:      one brick: C3D27, which ccx does not read; C3D20 is read. Without a group: 12 T3D3, 6 M3D9.
source "$(dirname "${BASH_SOURCE[0]}")/common.bash"
fetch_debian gmsh=4.8.4+ds2-3 calculix-ccx=2.20-1

cat > brick.geo <<'EOF'
Point(1) = {0, 0, 0}; Point(2) = {10, 0, 0}; Point(3) = {10, 10, 0}; Point(4) = {0, 10, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Curve Loop(1) = {1 : 4}; Plane Surface(1) = {1};
Transfinite Curve {1 : 4} = 2; Transfinite Surface {1}; Recombine Surface {1};
Extrude {0, 0, 10} { Surface{1}; Layers{1}; Recombine; }
EOF
{ cat brick.geo; echo 'Physical Volume("PART") = {1};'; } > part.geo
mesh() { gmsh "$1" -3 -order 2 -setnumber Mesh.SecondOrderIncomplete "$2" -o "$3" > gmsh.log; }
kinds() { # of elements in a .inp file
  awk -F'[=,]' 'toupper($1) == "*ELEMENT" {count[$3]++} END {for (kind in count) print count[kind], kind}' "$1" |
    sort -k 2 | paste -s -d ,
}
read_by_ccx() { # yes or no
  {
    cat "$1"
    printf '*MATERIAL, NAME=STEEL\n*ELASTIC\n200000, 0.3\n*SOLID SECTION, ELSET=PART, MATERIAL=STEEL\n'
    printf '*BOUNDARY\n1, 1, 3\n2, 2, 3\n4, 3\n*STEP\n*STATIC\n*END STEP\n'
  } > deck.inp
  ccx -i deck > ccx.log 2>&1 || true
  if grep -q "Job finished" ccx.log; then echo yes; else echo no; fi
}
mesh part.geo 0 whole.inp
mesh part.geo 1 incomplete.inp
mesh brick.geo 0 all.inp
expect "bricks" "1 C3D27" "$(kinds whole.inp)"
expect "read by ccx" "no" "$(read_by_ccx whole.inp)"
expect "bricks with Mesh.SecondOrderIncomplete" "1 C3D20" "$(kinds incomplete.inp)"
expect "read by ccx" "yes" "$(read_by_ccx incomplete.inp)"
expect "elements without a physical group" "1 C3D27,6 M3D9,12 T3D3" "$(kinds all.inp)"
finish
