#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Runs all tests, those that sanitizers have once more with them, clang-tidy on all sources and, as root with debootstrap and
# buildah, what people install who do not build (scripts/package/try_install.sh). Where all pass, and the tree is that of a
# commit, .ci/full_run says so.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
source scripts/environment.sh

record=.ci/full_run
commit=$(git rev-parse HEAD 2>/dev/null) || commit= # no git, or not its files
is_committed() { [[ -n $commit && -z $(git status --porcelain) ]]; }
is_committed || commit=

# Tests wait for processes and files much of the time: the build with sanitizers goes on beside the first ones, clang-tidy
# beside the others, in the time that these leave.
build_log=$(mktemp) tidy_log=$(mktemp) status=0
chrt --idle 0 bash scripts/test.sh --preset sanitizers --build -R . >"$build_log" 2>&1 &
build=$!
bash scripts/test.sh -R . || status=1
wait $build || { cat "$build_log"; exit 1; }
chrt --idle 0 bash scripts/dev/lint.sh --tidy >"$tidy_log" 2>&1 &
tidy=$!
bash scripts/test.sh --preset sanitizers -R . || status=1
wait $tidy || { cat "$tidy_log"; status=1; }
((status == 0)) || exit $status
if [[ -n $commit ]] && ((EUID == 0)) && command -v debootstrap >/dev/null && command -v buildah >/dev/null; then
  bash scripts/package/try_install.sh
else
  echo "package and container are not tried: that needs a commit, root, debootstrap and buildah"
fi
echo "all tests, all with sanitizers, clang-tidy: passed after $((SECONDS / 60)) min"
if is_committed; then
  printf '%s passed all of scripts/test.sh --all on %s, in %d min on %d cores\n' "$commit" "$(date -u +%F)" $((SECONDS / 60)) \
    "$(core_count)" >$record
fi
