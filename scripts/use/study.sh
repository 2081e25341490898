#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# A parameter study on this machine, one run a line of a table, one after the other. The same command goes on where it
# was: runs that are done stay as they are. Ctrl-C stops it with a checkpoint.
#
#   scripts/use/study.sh [-np RANKS] CONFIG TABLE.csv OUTPUT [OPTION OF FABSEQ]...
#
# e.g. configs/l_shape.json configs/alpha_study.csv output/alpha. Tables are those of
# scripts/slurm/study.sh: the first column is the name of the run, which goes to OUTPUT/NAME; the others are keys
# of the config with their values. Afterwards scripts/fabseq-tools compare OUTPUT/* gathers the results.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)

ranks=()
if [[ ${1:-} == -np ]]; then
  ranks=(-np "${2:?"-np needs a number of ranks"}")
  shift 2
fi
(($# >= 3)) || { echo "usage: scripts/use/study.sh [-np RANKS] CONFIG TABLE.csv OUTPUT [OPTION OF FABSEQ]..." >&2; exit 2; }
config=$1 table=$2 output=$3
shift 3

row_words() { /usr/bin/python3 "$root/scripts/slurm/study_table.py" "$table" "$@"; }

count=$(row_words) || exit 2
failed=()
stopped=no
trap 'stopped=yes' INT TERM # run.sh takes care of the run
for ((row = 1; row <= count; ++row)); do
  words=$(row_words "$row")
  mapfile -t words <<<"$words" # a name, then -set and KEY=VALUE by turns
  echo "== run $row of $count: ${words[0]}"
  "$root/scripts/use/run.sh" "${ranks[@]}" -config "$config" -output "$output/${words[0]}" -restart auto "${words[@]:1}" "$@" ||
    failed+=("${words[0]} ($?)")
  if [[ $stopped == yes ]]; then
    echo "study.sh: stopped in run $row of $count; the same command goes on" >&2
    exit 4
  fi
done
if ((${#failed[@]})); then
  echo "study.sh: not done, with their exit status: ${failed[*]}" >&2
  exit 1
fi
echo "== all $count runs are done; scripts/fabseq-tools compare $output/* compares them"
