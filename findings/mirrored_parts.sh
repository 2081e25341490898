#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# A part that is placed mirrored, in three libraries: lib3mf 1.8.1 (Debian 12: lib3mf1, lib3mf-dev
# 1.8.1+ds-4), lib3mf_model_mergetomodel; Assimp 5.2.5 (assimp-utils 5.2.5~ds0-1+b1), 3MF to STL; three.js
# 0.187.0 (npm: three@0.187.0), STLExporter, OBJExporter, PLYExporter.
#
# Guess:     the triangles are turned where the placement mirrors, so that outside stays outside: in 3MF a
#            mirrored shape must keep the sign of its volume, and three.js draws it so.
# Behaviour: all move the corners and keep the triangles: the solid is inside out, its volume negative.
# Seen:      a cube of 1 mm, x mirrored: -1 mm³ from each.
source "$(dirname "${BASH_SOURCE[0]}")/common.bash"
fetch_debian lib3mf1=1.8.1+ds-4 lib3mf-dev=1.8.1+ds-4 assimp-utils=5.2.5~ds0-1+b1
fetch_npm three@0.187.0

debian_python - <<'EOF'
from solids import mesh_3mf, write_3mf
write_3mf("mirrored.3mf", f'<object id="1" type="model">{mesh_3mf()}</object>',
          '<item objectid="1" transform="-1 0 0 0 1 0 0 0 1 0 0 0"/>')
EOF
cat > mirror.mjs <<'EOF'
import { BoxGeometry, Mesh, MeshBasicMaterial } from 'three';
import { STLExporter } from 'three/examples/jsm/exporters/STLExporter.js';
import { OBJExporter } from 'three/examples/jsm/exporters/OBJExporter.js';
import { PLYExporter } from 'three/examples/jsm/exporters/PLYExporter.js';
import { STLLoader } from 'three/examples/jsm/loaders/STLLoader.js';
import { OBJLoader } from 'three/examples/jsm/loaders/OBJLoader.js';
import { PLYLoader } from 'three/examples/jsm/loaders/PLYLoader.js';
import { volume } from './volume.mjs';
const part = new Mesh(new BoxGeometry(1, 1, 1).translate(2, 0, 0), new MeshBasicMaterial());
for (const side of [1, -1]) {
  part.scale.set(side, 1, 1);
  part.updateMatrixWorld(true);
  console.log(`${side} STL`, volume(new STLLoader().parse(new STLExporter().parse(part))));
  console.log(`${side} OBJ`, volume(new OBJLoader().parse(new OBJExporter().parse(part)).children[0].geometry));
  console.log(`${side} PLY`, volume(new PLYLoader().parse(new PLYExporter().parse(part, null))));
}
EOF
cp "$findings/volume.mjs" .
build_lib3mf_volume
expect "lib3mf, merged" "8 corners, 12 triangles, -1.0 mm3" "$(./lib3mf_volume 3mf mirrored.3mf)"
assimp export mirrored.3mf mirrored.stl -fstl > assimp.log
expect "Assimp, 3MF to STL" "-1 to 0, 0 to 1, 0 to 1; -1 mm3" "$(stl_solid mirrored.stl)"
node mirror.mjs > seen.txt
for format in STL OBJ PLY; do
  expect "three.js, not mirrored, $format" "12 triangles, 1.000 mm3" "$(sed -n "s/^1 $format //p" seen.txt)"
  expect "three.js, mirrored, $format" "12 triangles, -1.000 mm3" "$(sed -n "s/^-1 $format //p" seen.txt)"
done
finish
