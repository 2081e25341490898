# Environment of all runs on one machine; sourced by the scripts beside it.
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1  # containers and test machines run as root
export OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1                   # a rank is a core
export OMPI_MCA_odls_base_sigkill_timeout=60                      # time for a checkpoint when a job is ended
export OMPI_MCA_rmaps_base_oversubscribe=1                        # two ranks also where there is one core
