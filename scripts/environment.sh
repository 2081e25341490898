# SPDX-License-Identifier: MIT
# shellcheck shell=bash
# Environment of all scripts; source it. What is set already stays.
export OMPI_ALLOW_RUN_AS_ROOT="${OMPI_ALLOW_RUN_AS_ROOT:-1}"
export OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="${OMPI_ALLOW_RUN_AS_ROOT_CONFIRM:-1}"
# One thread a rank: the ranks are the parallelism.
export OPENBLAS_NUM_THREADS="${OPENBLAS_NUM_THREADS:-1}"
export OMP_NUM_THREADS="${OMP_NUM_THREADS:-1}"
# mpirun would look at all X servers of the machine, and be killed when one goes away meanwhile.
export HWLOC_COMPONENTS="${HWLOC_COMPONENTS:--gl}"
# A rank that waits for another leaves its core to others. Otherwise it spins there, and beside busy processes keeps the
# rank it waits for from running.
export OMPI_MCA_mpi_yield_when_idle="${OMPI_MCA_mpi_yield_when_idle:-1}"
# On a busy machine mpirun may see a rank's end before the rank's last message, and would give a run that is done
# the status 1 ("exiting improperly", https://github.com/open-mpi/ompi/issues/7833).
export OMPI_MCA_orte_allowed_exit_without_sync="${OMPI_MCA_orte_allowed_exit_without_sync:-1}"
# mpirun would bind its ranks to the first cores, and a second mpirun its own to the same ones. A job of Slurm has cores
# of its own.
if [ -z "${SLURM_JOB_ID:-}" ]; then
  export OMPI_MCA_hwloc_base_binding_policy="${OMPI_MCA_hwloc_base_binding_policy:-none}"
fi

# Whether a process may read the memory of another one of the same user, as ranks of Open MPI do to get large messages.
# Some containers forbid that (seccomp), and some kernels (ptrace_scope); it takes Perl 5 ms to try.
can_read_others() {
  local calls
  case $(uname -m) in
    x86_64) calls="157, 310" ;; # prctl, process_vm_readv
    aarch64) calls="167, 270" ;;
    *) return 0 ;;
  esac
  command -v perl >/dev/null || return 0
  perl -e '
    my ($prctl, $read, $own, $parent) = ('"$calls"', "12345678", $$);
    my $here = pack("PQ", $own, 8);
    syscall($prctl, 0x59616d61, -1, 0, 0, 0);  # PR_SET_PTRACER, to anybody, as Open MPI has it
    my $child = fork() // exit 0;
    if (!$child) {
      my $copy = "        ";
      my $there = pack("PQ", $copy, 8);
      exit(syscall($read, $parent, $there, 1, $here, 1, 0) == 8 ? 0 : 1);
    }
    waitpid($child, 0);
    exit($? >> 8);'
}
# Otherwise each such message would print an error before it goes another way.
if [ -z "${OMPI_MCA_btl_vader_single_copy_mechanism:-}" ] && ! can_read_others; then
  export OMPI_MCA_btl_vader_single_copy_mechanism=none
fi

# Ctrl-C stops with a checkpoint: `mpirun` is a function from here on. In other shells than bash it stays as it is.
if [ -n "${BASH_VERSION:-}" ]; then
  source "$(dirname "${BASH_SOURCE[0]}")/launch.sh"
fi

# FABSEQ_PROGRAM, or the program of a repository or of an installation's share/fabseq, which has a link to it.
fabseq_program() {
  local program=$1/fabseq
  [ -x "$program" ] || program=$1/build/release/fabseq
  echo "${FABSEQ_PROGRAM:-$program}"
}

# More ranks than cores, and several mpirun side by side on the same cores: for tests and for small machines.
allow_more_ranks_than_cores() {
  export OMPI_MCA_rmaps_base_oversubscribe="${OMPI_MCA_rmaps_base_oversubscribe:-1}"
  export OMPI_MCA_hwloc_base_binding_policy="${OMPI_MCA_hwloc_base_binding_policy:-none}"
}

# Cores' time that the control groups of this process give it, rounded up; nothing without a limit.
time_limit_in_cores() {
  local groups folder
  groups=$(cat /proc/self/cgroup 2>/dev/null) || groups=
  {
    folder=$(echo "$groups" | sed -n 's|^0::||p')
    folder=${folder%/}
    while cat "/sys/fs/cgroup$folder/cpu.max"; [ -n "$folder" ]; do folder=${folder%/*}; done
    folder=$(echo "$groups" | sed -n 's|^[0-9]*:\(.*,\)*cpu\(,.*\)*:||p') # version 1
    folder=${folder%/}
    while echo "$(cat "/sys/fs/cgroup/cpu$folder/cpu.cfs_quota_us") $(cat "/sys/fs/cgroup/cpu$folder/cpu.cfs_period_us")"
      [ -n "$folder" ]; do folder=${folder%/*}; done
  } 2>/dev/null | awk '
    $1 + 0 > 0 && $2 + 0 > 0 { cores = int($1 / $2) + ($1 % $2 > 0); if (!least || cores < least) least = cores }
    END { if (least) print least }'
}

# Cores of the machine, and no more than there is time for; nproc alone would answer OMP_NUM_THREADS.
core_count() {
  local cores limit
  cores=$(env -u OMP_NUM_THREADS nproc)
  limit=$(time_limit_in_cores)
  [ "${limit:-$cores}" -ge "$cores" ] || cores=$limit
  echo "$cores"
}

# Parallel compiler jobs: CMAKE_BUILD_PARALLEL_LEVEL, or else the cores, but no more than memory allows at 2 GB a job.
compile_jobs() {
  local cores available limit jobs
  if [[ -n ${CMAKE_BUILD_PARALLEL_LEVEL:-} ]]; then
    echo "$CMAKE_BUILD_PARALLEL_LEVEL"
    return
  fi
  cores=$(core_count)
  available=$(awk '/^MemAvailable:/ {print int($2 / 1024)}' /proc/meminfo)
  limit=$(cat /sys/fs/cgroup/memory.max 2>/dev/null || echo max)
  if [[ $limit =~ ^[0-9]+$ ]] && ((limit / 1048576 < available)); then
    available=$((limit / 1048576))
  fi
  jobs=$((available / 2000))
  ((jobs < cores)) || jobs=$cores
  ((jobs > 0)) || jobs=1
  echo "$jobs"
}
