#!/usr/bin/env bash
# Sets up, builds, and optimizes the fabrication sequence of a small topology-optimized part on 2 ranks:  bash scripts/demo.sh
# Leaves demo/overview.png and all results in demo/.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
bash "$root/scripts/setup.sh"
. "$root/scripts/environment.sh"
cd "$root"
mpirun -np 2 build/release/fabseq -config configs/demo.json -output demo -overwrite
xvfb-run -a /usr/bin/python3 scripts/overview.py demo demo/overview.png --table
echo "picture: $root/demo/overview.png"
