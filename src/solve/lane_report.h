// SPDX-License-Identifier: MIT
#pragma once

#include "cg/lane_outcome.h"
#include "fabseq/solve/solve_report.h"

#include <limits>

namespace fabseq {

/// Iterations after which the lane solvers leave a system to the reference path.
constexpr int lane_iterations = 300;

/// The report of a lane: what is no number has no residual, either.
inline SolveReport report_of(const LaneOutcome& outcome) {
  if (!outcome.finite)
    return {outcome.iterations, std::numeric_limits<double>::quiet_NaN(), false, "not a number"};
  return {outcome.iterations, outcome.residual, outcome.converged, outcome.converged ? "" : "iteration limit",
          outcome.has_islands};
}

}  // namespace fabseq
