# SPDX-License-Identifier: MIT
# shellcheck shell=bash
# What the batch scripts of this folder share; they source it. Needs FABSEQ_ROOT, the root of the repository or
# share/fabseq of an installation.
#
# From the environment, handed on by sbatch:
#   FABSEQ_LAUNCH    what starts the ranks: "mpirun" (default), or "srun --mpi=pmix" if Slurm was built for the PMIx of
#                    your MPI (srun --mpi=list tells)
#   FABSEQ_PROGRAM   the program; default: build/release/fabseq of the repository, or the installed one

# Slurm kills 30 seconds (its KillWait) after TERM. mpirun gets the same TERM and must not kill ranks that are writing
# their checkpoint before; it takes twice this time to return when they end with status 4.
export OMPI_MCA_odls_base_sigkill_timeout="${OMPI_MCA_odls_base_sigkill_timeout:-10}"
# The cores are the job's alone: nobody to leave them to.
export OMPI_MCA_mpi_yield_when_idle="${OMPI_MCA_mpi_yield_when_idle:-0}"
source "$FABSEQ_ROOT/scripts/environment.sh"
unset -f mpirun # the traps below do with Slurm's signals what that function does with a terminal's

# One task of an array has the array's number as SLURM_JOB_ID; requeued by that, all tasks would run again.
job=${SLURM_ARRAY_JOB_ID:+${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID}
job=${job:-$SLURM_JOB_ID}

signals=0
warned=no # the job's time is nearly over: USR1 from sbatch --signal
ended=no  # Slurm takes the job away: cancelled, preempted, requeued
launcher=

# mpirun and srun hand it on to the ranks; once, as a second one would end them without a checkpoint.
on_warning() {
  [[ $warned == yes || -z $launcher ]] || kill -USR1 "$launcher"
  signals=$((signals + 1)) warned=yes
}

# Slurm sends TERM to the ranks as well. The script has to stay: when it ends, Slurm kills the rest of the job at once.
on_end() { signals=$((signals + 1)) ended=yes; }

completed_iterations() { if [[ -f $1/history.jsonl ]]; then wc -l <"$1/history.jsonl"; else echo 0; fi; }

# One job, as often as it takes: fabseq_until_done CONFIG OUTPUT [OPTION OF FABSEQ]... Starts the run or continues it. If
# the job's time ends before the run does, the job is queued again. Ends the script with the status of the run.
fabseq_until_done() {
  local config=$1 output=$2 status=0 before done_now
  shift 2
  local launch
  read -ra launch <<<"${FABSEQ_LAUNCH:-mpirun}"
  local command=("${launch[@]}" "$(fabseq_program "$FABSEQ_ROOT")"
    -config "$config" -output "$output" -restart auto "$@")
  before=$(completed_iterations "$output")
  echo "job $job on ${SLURM_JOB_NODELIST}, start $((${SLURM_RESTART_COUNT:-0} + 1)), $(date '+%F %T'): ${command[*]}"

  trap on_warning USR1
  trap on_end TERM
  "${command[@]}" &
  launcher=$!
  [[ $warned == no ]] || kill -USR1 "$launcher"
  wait_for_end "$launcher" || status=$?

  if [[ $status == 4 && $warned == yes && $ended == no ]]; then
    done_now=$(completed_iterations "$output")
    if ((done_now == before)); then
      echo "job $job: not queued again: no iteration was completed in the time of this job; ask for more with --time" >&2
    elif scontrol requeue "$job"; then
      printf 'job %s: queued again after iteration %d, %(%F %T)T\n' "$job" "$done_now" -1 # other commands are killed by now
    else
      echo "job $job: could not be queued again; submit the same command once more to continue" >&2
    fi
  fi
  exit "$status"
}
