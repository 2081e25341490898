#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Builds the program, optimizes the fabrication sequence of a small part on 2 ranks, which ends with its verdict beside planar
# layers, and leaves a picture of it: demo/overview.png.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/environment.sh
allow_more_ranks_than_cores # a machine with a single core runs it, too

bash scripts/setup.sh
mpirun -np 2 build/release/fabseq -config configs/demo.json -output demo -overwrite
scripts/fabseq-tools overview demo || {
  echo "demo.sh: the picture could not be drawn; all results are in demo/ (summary.json, result.xdmf)" >&2
  exit 1
}
echo "picture: $PWD/demo/overview.png"
