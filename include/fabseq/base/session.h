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

/// MPI and PETSc for the lifetime of the object, for whoever has no function to hand to run_session().
/// Constructor and destructor are collective on the world.
class Session {
 public:
  /// Begins what does not run already: under mpi4py MPI, under petsc4py both do, and then they also go on
  /// afterwards. `petsc_arguments` as in run_session(); PETSc that runs already does not get them. Throws
  /// InputError if PETSc does not like its options.
  explicit Session(const std::vector<std::string>& petsc_arguments);
  Session(Session&&) = delete;
  ~Session();

 private:
  bool begun_ = false;  ///< whether PETSc is this object's to end
};

/// Runs `program` between PetscInitialize and PetscFinalize and returns the exit status of the process.
/// Collective on the world.
///
/// `petsc_arguments` is argv without fabseq's own options, argv[0] first. If `program` throws an Error, rank
/// 0 prints it once on stderr as "fabseq: MESSAGE", and every rank returns its status. Any other exception is
/// printed by the rank that has it, which then aborts all ranks with status 3. PETSc options that were never
/// read are reported as warnings. Processes that were started together but do not know of each other
/// (launch.h) end with status 2 without it. Until it returns, the C library reads and writes numbers in this
/// thread with a decimal point, whatever the locale, since PETSc's options depend on that.
int run_session(const std::vector<std::string>& petsc_arguments, const std::function<void()>& program);

/// Prints "warning: MESSAGE" on stderr from rank 0 of the world; does nothing on other ranks. Not collective.
void warn(const std::string& message);
/// The same from rank 0 of `comm`, for warnings that rank 0 of the world may not know of.
void warn(MPI_Comm comm, const std::string& message);
/// Prints a line on stdout from rank 0 of the world; does nothing on other ranks. Not collective.
void print(const std::string& line);

/// Writes all of `text` to file descriptor 1 or 2 and waits while there is no room for it. Once this rank has
/// been asked to stop (stop.h), it waits only for a moment, and text without room is lost: an mpirun that was
/// told to end no longer reads what its ranks print, and a checkpoint must not wait for that. Does not fail.
void write_text(int descriptor, const std::string& text) noexcept;

}  // namespace fabseq
