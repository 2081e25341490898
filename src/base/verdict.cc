// SPDX-License-Identifier: MIT
#include "fabseq/base/verdict.h"

#include "fabseq/base/error.h"
#include "fabseq/base/mpi.h"

#include <cstdint>
#include <string>

namespace fabseq {

namespace {

[[noreturn]] void throw_error(ExitStatus status, const std::string& message) {
  if (status == ExitStatus::bad_input) throw InputError(message);
  if (status == ExitStatus::numerical_failure) throw NumericalError(message);
  if (status == ExitStatus::stopped) throw Stopped(message);
  throw OutputError(message);
}

}  // namespace

void run_on_all(MPI_Comm comm, const std::function<void()>& work) {
  auto status = static_cast<int>(ExitStatus::done);
  std::string message;
  try {
    work();
  } catch (const Error& error) {
    status = static_cast<int>(error.status());
    message = error.what();
  } catch (const std::exception& error) {
    status = static_cast<int>(ExitStatus::output_failure);
    message = error.what();
  }
  const bool failed = status != static_cast<int>(ExitStatus::done);
  const auto ranks = static_cast<std::int64_t>(size_of(comm));
  const std::int64_t first = min(comm, failed ? static_cast<std::int64_t>(rank_of(comm)) : ranks);
  if (first == ranks) return;
  const auto root = static_cast<int>(first);
  MPI_Bcast(&status, 1, MPI_INT, root, comm);
  throw_error(static_cast<ExitStatus>(status), broadcast(comm, message, root));
}

void run_in_groups(MPI_Comm across, const std::function<void()>& work) {
  if (size_of(across) == 1) return work();
  run_on_all(across, work);
}

void run_on_first(MPI_Comm comm, const std::function<void()>& work) {
  const bool is_first = rank_of(comm) == 0;
  run_on_all(comm, [&] {
    if (is_first) work();
  });
}

}  // namespace fabseq
