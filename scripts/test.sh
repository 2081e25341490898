#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Builds the program and runs its tests.
#
#   scripts/test.sh [--sanitizers] [ctest options]     e.g. scripts/test.sh -R grid
#
#   --sanitizers  afterwards the same tests with AddressSanitizer and UndefinedBehaviorSanitizer
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/environment.sh
allow_more_ranks_than_cores
unset OMPI_MCA_odls_base_sigkill_timeout # many tests provoke errors; mpirun would wait two minutes after each

presets=(release)
if [[ ${1:-} == --sanitizers ]]; then
  presets+=(sanitizers)
  shift
fi
for preset in "${presets[@]}"; do
  bash scripts/setup.sh --preset "$preset"
  echo "== tests, preset $preset"
  ctest --preset "$preset" --parallel "$(core_count)" "$@"
done
