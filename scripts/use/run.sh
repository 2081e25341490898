#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Runs fabseq on several ranks of this machine. Ctrl-C stops it with a checkpoint, as soon as the solve in hand is done;
# the same command with -restart auto continues. A second Ctrl-C ends it at once.
#
#   scripts/use/run.sh [-np RANKS] -config FILE.json [OPTION OF FABSEQ]...     RANKS: as many as there are cores
#
# FABSEQ_PROGRAM names the program; default: build/release/fabseq of the repository, or the installed one.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
unset OMPI_MCA_odls_base_sigkill_timeout # set for batch jobs; after each error mpirun would wait twice as long
source "$root/scripts/environment.sh"

ranks=$(core_count)
if [[ ${1:-} == -np ]]; then
  ranks=${2:?"-np needs a number of ranks"}
  shift 2
fi
(($# > 0)) || { echo "usage: scripts/use/run.sh [-np RANKS] -config FILE.json [OPTION OF FABSEQ]..." >&2; exit 2; }

launch_stoppable run.sh mpirun -np "$ranks" "$(fabseq_program "$root")" "$@" </dev/null
