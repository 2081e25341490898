#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# CalculiX 2.20 (Debian 12: calculix-ccx 2.20-1), elements that *MODEL CHANGE, ADD=STRAIN FREE brings back.
#
# Guess:     they are free of strain in the state in which the step begins, and what the step does to them
#            strains them, in however many increments.
# Behaviour: they are free of strain at the end of the step's first increment. What the temperature does in
#            it leaves no trace: a step of one increment no stress at all.
# Seen:      a cube of 1 mm, held at all nodes, added at 1000 degrees and cooled to 0 in its step, with
#            E alpha 1000 = 2000 MPa: stress 0, 1000, 1500, 1800 MPa with 1, 2, 4, 10 increments.
source "$(dirname "${BASH_SOURCE[0]}")/common.bash"
fetch_debian calculix-ccx=2.20-1

deck() { # the length of an increment, of a step of length 1
  cat <<EOF
*NODE, NSET=ALL
$(cube_nodes)
9, 0, 0, 2
10, 1, 0, 2
11, 1, 1, 2
12, 0, 1, 2
*ELEMENT, TYPE=C3D8, ELSET=GROUND
1, 1, 2, 3, 4, 5, 6, 7, 8
*ELEMENT, TYPE=C3D8, ELSET=LAYER
2, 5, 6, 7, 8, 9, 10, 11, 12
*MATERIAL, NAME=STEEL
*ELASTIC
200000, 0
*PLASTIC
1e9, 0
*EXPANSION, ZERO=0
1e-5
*SOLID SECTION, ELSET=GROUND, MATERIAL=STEEL
*SOLID SECTION, ELSET=LAYER, MATERIAL=STEEL
*INITIAL CONDITIONS, TYPE=TEMPERATURE
ALL, 0
*BOUNDARY
ALL, 1, 3
*STEP
*STATIC, DIRECT
1, 1
*MODEL CHANGE, TYPE=ELEMENT, REMOVE
LAYER
*TEMPERATURE
ALL, 1000
*END STEP
*STEP
*STATIC, DIRECT
$1, 1
*MODEL CHANGE, TYPE=ELEMENT, ADD=STRAIN FREE
LAYER
*TEMPERATURE
ALL, 0
*EL PRINT, ELSET=LAYER
S
*END STEP
EOF
}

{ ccx -v || true; } | grep -i version
for increments in 1:0 2:1000 4:1500 10:1800; do
  deck "$(awk "BEGIN {print 1 / ${increments%:*}}")" > layer.inp
  ccx -i layer > ccx.log
  expect "stress of the layer, ${increments%:*} increments, MPa" "${increments#*:}" \
    "$(awk '$1 == 2 && NF >= 8 {stress = $3} END {printf "%g", stress}' layer.dat)"
done
finish
