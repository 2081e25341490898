#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# CalculiX 2.20 (Debian 12: calculix-ccx 2.20-1), heat transfer with *SPECIFIC HEAT that depends on temperature.
#
# Guess:     what an element stores is the integral of the table, so that a body without losses ends at the
#            temperature that its heat makes, in however many increments.
# Behaviour: each increment stores the specific heat at its end, times the rise: where this grows with the
#            temperature, a body ends too cold, by a quarter in one increment.
# Seen:      a cube of 1 kg, from 0 degrees, 100 J/(kg K) at 0 and 1000 at 1000 degrees, gets 550 kJ, which
#            makes 1000 degrees: 728, 826, 940, 991 with 1, 2, 8, 64 increments.
source "$(dirname "${BASH_SOURCE[0]}")/common.bash"
fetch_debian calculix-ccx=2.20-1

deck() { # number of increments
  cat <<EOF
*NODE, NSET=ALL
$(cube_nodes)
*ELEMENT, TYPE=C3D8, ELSET=CUBE
1, 1, 2, 3, 4, 5, 6, 7, 8
*MATERIAL, NAME=METAL
*CONDUCTIVITY
1.
*DENSITY
1.
*SPECIFIC HEAT
100., 0.
1000., 1000.
*SOLID SECTION, ELSET=CUBE, MATERIAL=METAL
*INITIAL CONDITIONS, TYPE=TEMPERATURE
ALL, 0
*STEP, INC=1000, AMPLITUDE=STEP
*HEAT TRANSFER, DIRECT
$(awk "BEGIN {print 1 / $1}"), 1.
*DFLUX
CUBE, BF, 550000.
*NODE PRINT, NSET=ALL, FREQUENCY=1000
NT
*END STEP
EOF
}

{ ccx -v || true; } | grep -i version
for seen in 1:728 2:826 8:940 64:991; do
  deck "${seen%:*}" > cube.inp
  ccx -i cube > ccx.log
  expect "degrees after ${seen%:*} increments" "${seen#*:}" \
    "$(awk 'NF == 2 && $1 ~ /^[0-9]+$/ {degrees = $2} END {printf "%.0f", degrees}' cube.dat)"
done
finish
