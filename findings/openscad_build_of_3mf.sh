#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# OpenSCAD 2021.01 (Debian 12: openscad 2021.01-6), import() of a 3MF file.
#
# Guess:     it reads the build, as a printer does: items at their places, as often as they are listed,
#            components put together, objects that no item names left out.
# Behaviour: it unites the mesh objects of the file as they stand in the resources. Build and components
#            do not count: a cube built twice comes once and at the origin, and an object that is not
#            built is part of the solid.
# Seen:      items at x = 0 and 10 of a 1 mm cube, beside a 2 mm cube that is not built: one solid from 0
#            to 2, 8 mm³ (meant: 0 to 11, 2 mm³). A component turned, three times as high and moved by the
#            item to 9 to 10, 100 to 101: 0 to 1. No warning, exit status 0.
source "$(dirname "${BASH_SOURCE[0]}")/common.bash"
fetch_debian openscad=2021.01-6

debian_python - <<'EOF'
from solids import mesh_3mf, write_3mf
move = 'transform="1 0 0 0 1 0 0 0 1 %g %g %g"'
write_3mf("items.3mf", f'<object id="1" type="model">{mesh_3mf()}</object>'
          f'<object id="2" type="model">{mesh_3mf(2)}</object>', f'<item objectid="1"/><item objectid="1" {move % (10, 0, 0)}/>')
write_3mf("component.3mf", f'<object id="1" type="model">{mesh_3mf()}</object><object id="2" type="model"><components>'
          '<component objectid="1" transform="0 1 0 -1 0 0 0 0 3 10 0 0"/></components></object>',
          f'<item objectid="2" {move % (0, 100, 0)}/>')
EOF
solid() {
  echo "import(\"$folder/$1.3mf\");" > "$1.scad"
  openscad -o "$1.stl" "$1.scad" > "$1.log" 2>&1
  stl_solid "$1.stl"
}
openscad --version 2>&1
expect "two items, and an object that is not built" "0 to 2, 0 to 2, 0 to 2; 8 mm3" "$(solid items)"
expect "a component, moved by itself and by its item" "0 to 1, 0 to 1, 0 to 1; 1 mm3" "$(solid component)"
expect "warnings" 0 "$(cat ./*.log | grep -ciE 'warning|error' || true)"
finish
