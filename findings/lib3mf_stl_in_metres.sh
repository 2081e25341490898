#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# lib3mf 1.8.1 (Debian 12: lib3mf1, lib3mf-dev 1.8.1+ds-4), its reader of binary STL files.
#
# Guess:     corners are joined where they are equal, or nearly so against the size of the part: the unit
#            does not matter, since an STL file has none.
# Behaviour: corners are joined within about 0.001 of whatever the unit is. A part in millimetres is
#            right; the same part in metres loses what is thinner than a millimetre. Status: no error.
# Seen:      a rod of 0.8 x 0.8 x 20 mm. In mm: 8 corners, 12 triangles, 12.8 mm³. In m: 2 corners and no
#            triangle are left.
source "$(dirname "${BASH_SOURCE[0]}")/common.bash"
fetch_debian lib3mf1=1.8.1+ds-4 lib3mf-dev=1.8.1+ds-4

debian_python - <<'EOF'
import struct
from solids import box, normal
for name, unit in (("mm", 1.0), ("m", 0.001)):
    triangles = box((0, 0, 0), (0.8 * unit, 0.8 * unit, 20 * unit))
    with open(name + ".stl", "wb") as file:
        file.write(bytes(80) + struct.pack("<I", len(triangles)))
        for triangle in triangles:
            corners = [x for corner in triangle for x in corner]
            file.write(struct.pack("<12fH", *normal(triangle), *corners, 0))
EOF
build_lib3mf_volume
expect "rod in millimetres" "8 corners, 12 triangles, 12.8 mm3" "$(./lib3mf_volume stl mm.stl 1)"
expect "rod in metres" "2 corners, 0 triangles, 0.0 mm3" "$(./lib3mf_volume stl m.stl 0.001)"
finish
