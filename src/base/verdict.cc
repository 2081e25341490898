// SPDX-License-Identifier: MIT
#include "fabseq/base/verdict.h"

#include "fabseq/base/error.h"
#include "fabseq/base/mpi.h"

#include <cstdint>
#include <optional>
#include <string>

namespace fabseq {

namespace {

struct Failure {
  ExitStatus status = ExitStatus::output_failure;
  std::string message;
};

std::optional<Failure> attempt(const std::function<void()>& work) {
  try {
    work();
    return std::nullopt;
  } catch (const Error& error) {
    return Failure{error.status(), error.what()};
  } catch (const std::exception& error) {
    return Failure{ExitStatus::output_failure, error.what()};
  }
}

Failure broadcast_failure(MPI_Comm comm, int root, Failure failure) {
  std::int64_t header[2] = {static_cast<std::int64_t>(failure.status),
                            static_cast<std::int64_t>(failure.message.size())};
  MPI_Bcast(header, 2, MPI_INT64_T, root, comm);
  failure.status = static_cast<ExitStatus>(header[0]);
  failure.message.resize(static_cast<std::size_t>(header[1]));
  MPI_Bcast(failure.message.data(), static_cast<int>(header[1]), MPI_CHAR, root, comm);
  return failure;
}

[[noreturn]] void throw_failure(const Failure& failure) {
  if (failure.status == ExitStatus::bad_input) throw InputError(failure.message);
  if (failure.status == ExitStatus::numerical_failure) throw NumericalError(failure.message);
  if (failure.status == ExitStatus::stopped) throw Stopped(failure.message);
  throw OutputError(failure.message);
}

}  // namespace

void run_on_all(MPI_Comm comm, const std::function<void()>& work) {
  const std::optional<Failure> failure = attempt(work);
  const auto ranks = static_cast<std::int64_t>(size_of(comm));
  const std::int64_t first = min(comm, failure ? static_cast<std::int64_t>(rank_of(comm)) : ranks);
  if (first == ranks) return;
  throw_failure(broadcast_failure(comm, static_cast<int>(first), failure.value_or(Failure{})));
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
