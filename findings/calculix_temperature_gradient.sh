#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# CalculiX 2.20 (Debian 12: calculix-ccx 2.20-1), first-order bricks with a temperature that varies in them.
#
# Guess:     the temperatures of the nodes are interpolated at the integration points, so that C3D8I, the
#            brick made for bending, bends as it is hotter on top; a wall needs one element across.
# Behaviour: C3D8 and C3D8I have one temperature each, the mean of their nodes. Bricks of second order bend.
# Seen:      a bar of 10 x 1 x 1 mm, free, 0 degrees below and 1000 on top, alpha = 1e-5: the end should
#            sink by alpha 1000 / 1 * 10^2 / 2 = 0.5 mm. One element across: 0 with C3D8 and C3D8I, 0.51 with
#            C3D20. Two across: 0.25 and 0.38.
source "$(dirname "${BASH_SOURCE[0]}")/common.bash"
fetch_debian calculix-ccx=2.20-1

deck() { # type of brick, number of elements across the bar
  debian_python - "$1" "$2" <<'EOF'
import sys

kind, across = sys.argv[1], int(sys.argv[2])
half = 2 if kind == "C3D20" else 1  # steps of the lattice in an element: its edges have middle nodes
size = (10 * half, half, across * half)
# Corners, then the middle nodes of edges below, above and upright, in units of half an edge.
corners = [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2)]
edges = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
middles = [tuple((a + b) // 2 for a, b in zip(corners[i], corners[j])) for i, j in edges]
shape = [tuple(c * half // 2 for c in corner) for corner in (corners + middles if half == 2 else corners)]
number = {}
elements = []
for x in range(10):
    for z in range(across):
        places = [(x * half + i, j, z * half + k) for i, j, k in shape]
        elements.append([number.setdefault(place, len(number) + 1) for place in places])
print("*NODE, NSET=ALL")
for (x, y, z), n in number.items():
    print(f"{n}, {x * 10 / size[0]}, {y / size[1]}, {z / size[2]}")
print(f"*ELEMENT, TYPE={kind}, ELSET=BAR")
for e, nodes in enumerate(elements, 1):
    words = [str(n) for n in (e, *nodes)]
    print(", ".join(words[:11]) + ("," if len(words) > 11 else ""))
    if len(words) > 11:
        print(", ".join(words[11:]))
print("*MATERIAL, NAME=STEEL\n*ELASTIC\n200000, 0\n*EXPANSION, ZERO=0\n1e-5\n*SOLID SECTION, ELSET=BAR, MATERIAL=STEEL")
print("*INITIAL CONDITIONS, TYPE=TEMPERATURE\nALL, 0\n*BOUNDARY")
print(f"{number[0, 0, 0]}, 1, 3\n{number[0, size[1], 0]}, 1\n{number[0, size[1], 0]}, 3\n{number[0, 0, size[2]]}, 1, 2")
print("*STEP\n*STATIC\n*TEMPERATURE")
for (x, y, z), n in number.items():
    print(f"{n}, {1000 * z / size[2]}")
print(f"*NSET, NSET=END\n{number[size[0], 0, 0]}\n*NODE PRINT, NSET=END\nU\n*END STEP")
EOF
}

{ ccx -v || true; } | grep -i version
for case in C3D8:1:0.00 C3D8I:1:0.00 C3D20:1:0.51 C3D8:2:0.25 C3D8I:2:0.38; do
  IFS=: read -r kind across sinks <<< "$case"
  deck "$kind" "$across" > bar.inp
  ccx -i bar > ccx.log
  expect "$kind, $across across, the end sinks by, mm" "$sinks" \
    "$(awk 'NF == 4 && $1 ~ /^[0-9]+$/ {printf "%.2f", $4 < -0.001 ? -$4 : 0}' bar.dat)"
done
finish
