#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Slurm job array: a parameter study, one run a line of a table, each requeued until it is done. From the root of the
# repository (or with FABSEQ_ROOT set to it):
#
#   sbatch --array=1-$(scripts/slurm/study_table.py TABLE.csv) --ntasks=8 scripts/slurm/study.sh CONFIG TABLE.csv OUTPUT [OPTION OF FABSEQ]...
#
# e.g. configs/l_shape.json configs/alpha_study.csv output/alpha. The table's first column is the name of the run,
# which goes to OUTPUT/NAME; the others are keys of the config with their values. Afterwards scripts/fabseq-tools compare
# OUTPUT/* gathers the results.
#SBATCH --job-name=fabseq_study
#SBATCH --ntasks=4
#SBATCH --cpus-per-task=1
#SBATCH --time=12:00:00
#SBATCH --signal=B:USR1@180
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --output=%x_%A_%a.log
set -euo pipefail
FABSEQ_ROOT=${FABSEQ_ROOT:-${SLURM_SUBMIT_DIR:?"submit this script with sbatch"}}
source "$FABSEQ_ROOT/scripts/slurm/job.sh"

(($# >= 3)) || { echo "usage: sbatch --array=1-N scripts/slurm/study.sh CONFIG TABLE.csv OUTPUT [OPTION OF FABSEQ]..." >&2; exit 2; }
config=$1 table=$2 output=$3
shift 3
row=${SLURM_ARRAY_TASK_ID:?"this is a job array: sbatch --array=1-N, N being the number of lines of the table"}
words=$(/usr/bin/python3 "$FABSEQ_ROOT/scripts/slurm/study_table.py" "$table" "$row")
mapfile -t words <<<"$words" # a name, then -set and KEY=VALUE by turns
fabseq_until_done "$config" "$output/${words[0]}" "${words[@]:1}" "$@"
