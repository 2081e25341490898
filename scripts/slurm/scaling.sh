#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# A strong-scaling study: submits one job (run.sh) a number of ranks, and one that makes the table and the figure when all
# are done. To be run on the login node:
#
#   scripts/slurm/scaling.sh CONFIG OUTPUT "1 2 4 8 16" [OPTION OF FABSEQ]...
#
# Runs go to OUTPUT/ranks_00001 and so on, table and figure to OUTPUT/scaling.csv and .png (scripts/fabseq-tools scaling). Each job has
# its nodes to itself. Options of sbatch come from its environment variables, as SBATCH_PARTITION, SBATCH_ACCOUNT or
# SBATCH_TIMELIMIT; FABSEQ_LAUNCH as in job.sh.
set -euo pipefail
(($# >= 3)) || { echo "usage: scripts/slurm/scaling.sh CONFIG OUTPUT \"RANKS...\" [OPTION OF FABSEQ]..." >&2; exit 2; }
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
export FABSEQ_ROOT=${FABSEQ_ROOT:-$(dirname "$(dirname "$here")")}
config=$1 output=$2 ranks=$3
shift 3
mkdir -p "$output"

# Twelve iterations: two to warm up, ten for the median. No files while they run.
runs=() jobs=()
for count in $ranks; do
  runs+=("$output/ranks_$(printf %05d "$count")")
  jobs+=("$(sbatch --parsable --exclusive --ntasks="$count" --job-name="scaling_$count" --output="$output/%x.log" \
    "$here/run.sh" "$config" "${runs[-1]}" -max_iterations 12 -output_every 0 -checkpoint_every 0 "$@")")
  echo "job ${jobs[-1]}: $count ranks"
done
gather=$(printf '%q ' /usr/bin/python3 "$FABSEQ_ROOT/scripts/fabseq-tools" scaling "${runs[@]}" --table "$output/scaling.csv" --picture "$output/scaling.png")
job=$(sbatch --parsable --ntasks=1 --job-name=scaling --output="$output/scaling.log" --dependency="afterok$(printf ':%s' "${jobs[@]}")" \
  --kill-on-invalid-dep=yes --wrap="$gather")
echo "job $job: table and figure"
