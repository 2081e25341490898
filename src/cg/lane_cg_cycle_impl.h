// SPDX-License-Identifier: MIT
/// \file
/// Definition of LaneCg's solution by a single cycle of the multigrid, for lane_cg_impl.h.
#pragma once

#include "cg/lane_cg.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/stop.h"
#include "kernels/flush_to_zero.h"

#include <array>
#include <cmath>

namespace fabseq {

/// solution = M load
template <class Problem, int Width>
std::vector<LaneOutcome> LaneCg<Problem, Width>::cycle_once(LaneArray& load, LaneArray& solution, int lanes) {
  using Value = Lanes<Width>;
  const FlushToZero flush_to_zero;
  Scalars scales = scales_of(load);
  auto factors = Value::load(scales.data());
  for (std::size_t i = 0; i < load.size(); i += Width)
    (Value::load(&load[i]) * factors).store(&rounded_residual_[i]);
  multigrid_->be_patient(false);
  multigrid_->apply(rounded_residual_.data(), preconditioned_.data());

  // A request to stop travels along: all ranks follow it in the same cycle.
  const Scalars stops{stop_requested() ? 1.0 : 0.0};
  std::array<Scalars, 2> sums{matrix_->dot(preconditioned_.data(), preconditioned_.data()), stops};
  sum_in_place(matrix_->level().comm, std::span<double>(sums.front().data(), Width + 1));
  if (sums[1][0] > 0.0) throw_stopped(matrix_->level().comm);
  std::vector<LaneOutcome> outcome(static_cast<std::size_t>(lanes));
  for (int lane = 0; lane < Width; ++lane)
    scales[lane] = lane < lanes && positive(lane) ? 1.0 / scales[lane] : 0.0;
  for (int lane = 0; lane < lanes; ++lane) {
    outcome[lane].iterations = 1;
    outcome[lane].finite = std::isfinite(sums[0][lane]);
    outcome[lane].converged = outcome[lane].finite;
  }
  solution.resize(load.size());
  factors = Value::load(scales.data());
  for (std::size_t i = 0; i < load.size(); i += Width)
    (Value::load(&preconditioned_[i]) * factors).store(&solution[i]);
  return outcome;
}

}  // namespace fabseq
