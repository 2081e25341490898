#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Runs fabseq on several ranks of this machine. Ctrl-C stops it with a checkpoint, as soon as the solve in hand is done;
# the same command with -restart auto continues. A second Ctrl-C ends it at once.
#
#   scripts/use/run.sh [-np RANKS] -config FILE.json [OPTION OF FABSEQ]...     RANKS: as many as there are cores
#
# FABSEQ_PROGRAM names the program; default: build/release/fabseq of the repository.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
# mpirun returns after twice this time, in seconds, when ranks end with status 4. Nobody sends it the signal for which
# others have to wait longer.
export OMPI_MCA_odls_base_sigkill_timeout="${OMPI_MCA_odls_base_sigkill_timeout:-1}"
source "$root/scripts/environment.sh"
source "$root/scripts/wait_for_end.sh"

ranks=$(core_count)
if [[ ${1:-} == -np ]]; then
  ranks=${2:?"-np needs a number of ranks"}
  shift 2
fi
(($# > 0)) || { echo "usage: scripts/use/run.sh [-np RANKS] -config FILE.json [OPTION OF FABSEQ]..." >&2; exit 2; }

# mpirun answers Ctrl-C by ending its ranks; so it gets a group of its own, and what the program listens for.
on_stop() {
  signals=$((signals + 1))
  if ((signals == 1)); then
    echo "run.sh: stopping after the solve in hand, with a checkpoint; press Ctrl-C again to end at once" >&2
    kill -USR1 "$launcher" 2>/dev/null || true
  else
    echo "run.sh: ending at once" >&2
    kill -KILL -- "-$launcher" 2>/dev/null || true
    exit 137
  fi
}

launcher=
trap on_stop INT TERM
setsid mpirun -np "$ranks" "${FABSEQ_PROGRAM:-$root/build/release/fabseq}" "$@" &
launcher=$!
status=0
wait_for_end "$launcher" || status=$?
((status != 4 || signals == 0)) || echo "run.sh: stopped; the same command with -restart auto continues" >&2
exit "$status"
