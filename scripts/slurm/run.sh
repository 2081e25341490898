#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Slurm job: one run of fabseq, requeued until it is done. From the root of the repository (or with FABSEQ_ROOT set to it):
#
#   sbatch --ntasks=32 --time=12:00:00 scripts/slurm/run.sh CONFIG OUTPUT [OPTION OF FABSEQ]...
#
# e.g. configs/bracket.json "$SCRATCH/bracket" -max_iterations 120. Submitted once more after a failure, it continues.
# Options of sbatch count more than the lines below. FABSEQ_LAUNCH chooses between mpirun and srun (job.sh).
#SBATCH --job-name=fabseq
#SBATCH --ntasks=4
#SBATCH --cpus-per-task=1
#SBATCH --time=12:00:00
#SBATCH --signal=B:USR1@180
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --output=%x_%j.log
set -euo pipefail
FABSEQ_ROOT=${FABSEQ_ROOT:-${SLURM_SUBMIT_DIR:?"submit this script with sbatch"}}
source "$FABSEQ_ROOT/scripts/slurm/job.sh"

(($# >= 2)) || { echo "usage: sbatch scripts/slurm/run.sh CONFIG OUTPUT [OPTION OF FABSEQ]..." >&2; exit 2; }
fabseq_until_done "$@"
