// SPDX-License-Identifier: MIT
/// \file
/// Start and end of MPI and PETSc, the one place where exceptions become exit statuses, and text for standard
/// output and standard error that never keeps a run from stopping.
#pragma once

#include <mpi.h>

#include <functional>
#include <string>
#include <vector>

namespace fabseq {

/// Runs `program` between PetscInitialize and PetscFinalize and returns the exit status of the process.
///
/// `petsc_arguments`: argv without fabseq's own options, argv[0] first. An Error thrown by `program` is
/// printed once, by rank 0, as "fabseq: MESSAGE" on stderr, and its status is returned on every rank; any
/// other exception is printed by the rank that has it and aborts all ranks with status 3. PETSc options that
/// nobody read are reported as warnings.
int run_session(const std::vector<std::string>& petsc_arguments, const std::function<void()>& program);

/// Prints "warning: MESSAGE" on stderr, once (rank 0 of the world).
void warn(const std::string& message);
/// The same once for each communicator that says it: for what the first rank of the world may not know of.
void warn(MPI_Comm comm, const std::string& message);
/// Prints a line on stdout, once (rank 0 of the world).
void print(const std::string& line);

/// Writes text to file descriptor 1 or 2, whole, and waits where there is no room for it. Once this rank has
/// been asked to stop (stop.h) it waits no longer than a moment, and what has no room is lost: mpirun, told
/// to end, reads no more of what its ranks print, and a checkpoint must not wait for that. Does not fail.
void write_text(int descriptor, const std::string& text) noexcept;

}  // namespace fabseq
