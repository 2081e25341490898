#!/usr/bin/env bash
# Sets up, builds and runs all tests:  bash scripts/test.sh [--sanitizers] [arguments of ctest]
# --sanitizers: the build with AddressSanitizer and UndefinedBehaviorSanitizer instead of the optimized one.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
bash "$root/scripts/setup.sh"
. "$root/scripts/environment.sh"
cd "$root"
preset=release
if [ "${1:-}" = --sanitizers ]; then
  shift
  preset=sanitizers
  cmake --preset sanitizers >/dev/null
  cmake --build --preset sanitizers --parallel "$(nproc)"
fi
ctest --preset "$preset" --parallel "$(nproc)" "$@"
