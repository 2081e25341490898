// SPDX-License-Identifier: MIT
/// \file
/// How the process was started.
#pragma once

namespace fabseq {

/// Makes a command of a shell that is a task of Slurm (`srun --pty bash`) a run on one rank: it has the
/// shell's environment, by which MPI would look for the step's other tasks. Before MPI_Init. Not collective.
void leave_step_of_shell();

/// Whether this process is one of several that were started together, but each of which is alone in its MPI:
/// srun without PMIx, or the mpirun of another MPI. All of them would compute the whole run and write to one
/// directory. The first of them says so in a line on stderr. A single process that Open MPI's mpirun started
/// is none. Between MPI_Init and MPI_Finalize. Not collective.
bool is_one_of_copies();

}  // namespace fabseq
