// SPDX-License-Identifier: MIT
/// \file
/// Work that may fail on one rank, with an outcome that all ranks know.
#pragma once

#include <mpi.h>

#include <exception>
#include <functional>

namespace fabseq {

/// Runs `work` on every rank of `comm` and waits for all of them. If it throws on any, the error of the
/// lowest such rank is thrown on all: an Error as what it was, any other exception as OutputError with its
/// text. `work` must not contain collective calls that a failure elsewhere would leave waiting. Collective.
void run_on_all(MPI_Comm comm, const std::function<void()>& work);

/// The same for work of rank 0 alone; the others wait for the outcome. Collective.
void run_on_first(MPI_Comm comm, const std::function<void()>& work);

/// The same for work that is collective on each of several groups of ranks, fails on all of a group or none,
/// and is waited for in between: `across` holds one rank of each group. With one group this is `work` and
/// nothing else. Collective on `across`.
void run_in_groups(MPI_Comm across, const std::function<void()>& work);

/// Puts off an exception until the collective calls around the failed work are through: after the first
/// failure further work is skipped, and rethrow() throws it.
class FirstFailure {
 public:
  template <class Work>
  void run(Work&& work) noexcept {
    if (failure_) return;
    try {
      work();
    } catch (...) {
      failure_ = std::current_exception();
    }
  }
  void rethrow() const {
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  std::exception_ptr failure_;
};

}  // namespace fabseq
