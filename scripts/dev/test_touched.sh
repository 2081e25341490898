#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Tests with sanitizers, and clang-tidy, of what has changed since the last commit of .ci/full_run: unit tests that
# touched.py names; if a source of the program is among it, also two runs of the whole program.
#
#   scripts/dev/test_touched.sh [--build]     with --build: builds them, and runs none
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
source scripts/environment.sh

commit=$(tail -n 1 .ci/full_run | cut -d ' ' -f 1)
tests=$(scripts/dev/touched.py --since "$commit" --tests)
names=$(scripts/dev/touched.py --since "$commit" --sources)
sources=()
[[ -z $names ]] || mapfile -t sources <<<"$names"
echo "== touched since $commit: ${#sources[@]} sources; unit tests: ${tests:-none}"
whole_program='^integration\.(simulate|guided)$'
((${#sources[@]} == 0)) || tests=${tests:+$tests|}$whole_program
if [[ -n $tests ]]; then
  bash scripts/test.sh --preset sanitizers "$@" -R "$tests"
fi
if ((${#sources[@]})) && [[ ${1:-} != --build ]]; then
  bash scripts/dev/lint.sh --tidy "${sources[@]}"
fi
