#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Assimp 5.2.5 (Debian 12: assimp-utils 5.2.5~ds0-1+b1), 3MF to STL, beside three.js 0.187.0 (npm:
# three@0.187.0), 3MFLoader.
#
# Guess:     the unit that a 3MF file names is obeyed: unlike STL, the format has one, and both libraries
#            have a scale for it (a root node or a group).
# Behaviour: the numbers are passed on as they stand and the scene's scale is 1: a part in inches is 25.4
#            times too small, one in metres a thousand times. Nothing says so.
# Seen:      cubes of 1 inch, 1 metre: 0 to 1 in the STL file, 0 to 1 and scale 1 in three.js, as for 1
#            mm.
source "$(dirname "${BASH_SOURCE[0]}")/common.bash"
fetch_debian assimp-utils=5.2.5~ds0-1+b1
fetch_npm three@0.187.0 linkedom@0.18.15

debian_python - <<'EOF'
from solids import mesh_3mf, write_3mf
for unit in ("millimeter", "inch", "meter"):
    write_3mf(unit + ".3mf", f'<object id="1" type="model">{mesh_3mf()}</object>', '<item objectid="1"/>', unit)
EOF
cat > extent.mjs <<'EOF'
import { readFileSync } from 'node:fs';
import { DOMParser } from 'linkedom';
import { Box3 } from 'three';
import { ThreeMFLoader } from 'three/examples/jsm/loaders/3MFLoader.js';
globalThis.DOMParser = DOMParser;
const group = new ThreeMFLoader().parse(new Uint8Array(readFileSync(process.argv[2])).buffer);
const box = new Box3().setFromObject(group);
console.log(`${box.min.x} to ${box.max.x}, scale ${group.scale.x}`);
EOF
for unit in millimeter inch meter; do
  assimp export "$unit.3mf" "$unit.stl" -fstl > assimp.log
  expect "Assimp, $unit" "0 to 1, 0 to 1, 0 to 1; 1 mm3" "$(stl_solid "$unit.stl")"
  expect "three.js, $unit" "0 to 1, scale 1" "$(node extent.mjs "$unit.3mf")"
done
finish
