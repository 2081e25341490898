#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# three.js 0.187.0 (npm: three@0.187.0), PLYLoader.
#
# Guess:     faces of any number of corners are cut into triangles, as quads are.
# Behaviour: triangles are taken, quads are cut in two, faces with five corners or more are left out
#            without a word: a closed part comes with holes.
# Seen:      a prism over a pentagon, 2 pentagons and 5 quads: 10 triangles (16 would close it), 1.585
#            instead of 2.378 mm³.
source "$(dirname "${BASH_SOURCE[0]}")/common.bash"
fetch_npm three@0.187.0

cat > prism.mjs <<'EOF'
import { PLYLoader } from 'three/examples/jsm/loaders/PLYLoader.js';
import { volume } from './volume.mjs';
console.warn = console.error = (text) => console.log(`warning: ${text}`);
const around = [0, 1, 2, 3, 4];
const corner = (i, z) => `${Math.cos(0.4 * Math.PI * i)} ${Math.sin(0.4 * Math.PI * i)} ${z}`;
const corners = [0, 1].flatMap((z) => around.map((i) => corner(i, z)));
const sides = around.map((i) => `4 ${i} ${(i + 1) % 5} ${(i + 1) % 5 + 5} ${i + 5}`);
const faces = ['5 4 3 2 1 0', '5 5 6 7 8 9', ...sides];
console.log('prism', volume(new PLYLoader().parse(['ply', 'format ascii 1.0', `element vertex ${corners.length}`,
  'property float x', 'property float y', 'property float z', `element face ${faces.length}`,
  'property list uchar int vertex_indices', 'end_header', ...corners, ...faces, ''].join('\n'))));
EOF
cp "$findings/volume.mjs" .
node prism.mjs > seen.txt
expect "prism over a pentagon" "10 triangles, 1.585 mm3" "$(sed -n 's/^prism //p' seen.txt)"
expect "warnings" 0 "$(grep -c '^warning' seen.txt || true)"
finish
