#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# three.js 0.187.0 (npm), NRRDLoader.
#
# Guess:     what the header says about place and numbers is obeyed: the volume stands at `space origin`, and
#            values of `endian: big` are turned round.
# Behaviour: the matrix has directions but no origin, and big-endian values are read as little-endian ones,
#            both without a word.
# Seen:      `space origin: (10,20,30)`: translation 0 0 0. A big-endian 1.5: 6.89649e-41.
source "$(dirname "${BASH_SOURCE[0]}")/common.bash"
fetch_npm three@0.187.0

cat > read.mjs <<'EOF'
import { NRRDLoader } from 'three/addons/loaders/NRRDLoader.js';

const shape = [2, 3, 4], values = 24;
const header = [
  'NRRD0004', 'type: float', 'dimension: 3', 'space dimension: 3', `sizes: ${shape.join(' ')}`,
  'space directions: (1,0,0) (0,1,0) (0,0,1)', 'space origin: (10,20,30)', 'endian: big', 'encoding: raw', '', '',
].join('\n');
const bytes = new Uint8Array(header.length + 4 * values);
bytes.set(new TextEncoder().encode(header));
const view = new DataView(bytes.buffer);
for (let i = 0; i < values; ++i) view.setFloat32(header.length + 4 * i, 1.5, false);
const volume = new NRRDLoader().parse(bytes.buffer);
const matrix = volume.matrix.elements;
console.log(process.argv[2] === 'origin' ? matrix.slice(12, 15).join(' ') : volume.data[0].toPrecision(6));
EOF
expect "translation of the volume's matrix" "0 0 0" "$(node read.mjs origin)"
expect "a big-endian 1.5" "6.89649e-41" "$(node read.mjs value)"
finish
