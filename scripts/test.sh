#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Builds the program and the tests that are to run, and runs them.
#
#   scripts/test.sh [--sanitizers | --preset NAME] [--quick | --label NAME] [--build] [ctest options]
#   scripts/test.sh --all | --touched
#
# Without options: what must pass before a change is taken, in about ten minutes, once it is built. With ctest options
# (-R grid, say), the tests that these select.
#
#   --all         all tests, then all of them that sanitizers have, and clang-tidy on all sources. Where they pass on a
#                 clean tree, .ci/full_run gets the commit
#   --touched     with sanitizers and clang-tidy, what has changed since the last commit of .ci/full_run (touched.py)
#   --sanitizers  afterwards the same tests with AddressSanitizer and UndefinedBehaviorSanitizer
#   --preset NAME the tests of this preset (release, sanitizers, indices64) only
#   --quick       what finds most mistakes in less than three minutes, once it is built
#   --label NAME  quick, thorough (what --all has beside the others), kernels, gradients, files, scripts, evidence, indices or
#                 slurm: CONTRIBUTING.md says when which of them
#   --build       builds what the tests need, and runs none
#
# With FABSEQ_NO_SKIPS=1, a test that has to be skipped fails, unless the regular expression FABSEQ_MAY_SKIP
# matches why.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/environment.sh
allow_more_ranks_than_cores

presets=(release) selection=() build_only=no
while (($#)); do
  case $1 in
    --all) exec bash scripts/dev/full_run.sh ;;
    --touched) exec bash scripts/dev/test_touched.sh ;;
    --build) build_only=yes ;;
    --sanitizers) presets+=(sanitizers) ;;
    --preset) presets=("${2:?"--preset needs a name"}"); shift ;;
    --quick) selection+=(-L '^quick$') ;;
    --label) selection+=(-L "^${2:?"--label needs a name"}\$"); shift ;;
    *) selection+=("$1") ;;
  esac
  shift
done
((${#selection[@]})) || selection=(-LE '^thorough$')

# Programs of the tests that ctest would run; scripts run fabseq itself.
targets() {
  ctest --preset "$1" --show-only --verbose "${selection[@]}" | sed -nE '/^[0-9]+: Test command:/{
    s#.*/evidence/tests/scaling_test\.py.*#scaling_plan#; s#.*/python3 .*#fabseq#
    s#.*/(tests|benchmarks)/([a-z_0-9]+)("| |$).*#\2#; p }' | sort -u
}

for preset in "${presets[@]}"; do
  bash scripts/setup.sh --preset "$preset"
  echo "== tests, preset $preset"
  mapfile -t names < <(targets "$preset")
  if ((${#names[@]} == 0)); then
    echo "test.sh: no such tests" >&2
    exit 2
  fi
  cmake --build --preset "$preset" --parallel "$(compile_jobs)" --target "${names[@]}"
  [[ $build_only == no ]] || continue
  ctest --preset "$preset" --parallel "$(($(core_count) + 1))" "${selection[@]}"  # many wait for processes
done
