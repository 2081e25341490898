// SPDX-License-Identifier: MIT
#include "sequence/shared_solve.h"

#include "fabseq/base/mpi.h"
#include "fabseq/base/verdict.h"
#include "fabseq/grid/index_box.h"

#include <utility>

namespace fabseq {

template <int Dim>
void SharedSolve<Dim>::set_tolerance(const SolveTolerance& tolerance) {
  solver_.set_tolerance(tolerance);
  warm_ = tolerance.warm;
}

template <int Dim>
void SharedSolve<Dim>::start_cold() {
  solver_.start_cold();
  last_.clear();
}

/// Other groups would only take bandwidth from the first.
template <int Dim>
const std::vector<double>& SharedSolve<Dim>::solve(const LaneVector& load,
                                                   const std::function<void()>& set_up,
                                                   const std::string& what) {
  LaneVector solution = load;
  const bool improves = warm_ && !last_.empty();
  if (improves) solution.values = std::move(last_);
  run_in_groups(across_, [&] {
    set_up();
    if (rank_of(across_) != 0) return;
    const auto reports =
        improves ? solver_.improve({&load, 1}, {&solution, 1}) : solver_.solve({&load, 1}, {&solution, 1});
    require_convergence(reports[0], what);
    iterations_ = reports[0].iterations;
  });
  if (solver_.saves_memory()) solver_.release_memory();
  last_ = std::move(solution.values);
  broadcast(across_, last_);
  MPI_Bcast(&iterations_, 1, MPI_INT, 0, across_);
  return last_;
}

FABSEQ_INSTANTIATE_CLASS(SharedSolve);

}  // namespace fabseq
