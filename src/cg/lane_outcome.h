// SPDX-License-Identifier: MIT
#pragma once

namespace fabseq {

/// A lane's solve stops at a preconditioned residual of `tolerance`, and not before the error, as the
/// spectrum lets it be estimated, is within `error_factor` times as much. With a `reach` above 1 a lane that
/// is within this many times both makes one more step and stops: the residual behind that step is not
/// measured, which saves a cycle of the multigrid. Few steps tell nothing of an island (IslandModes) that
/// hangs by little: lanes that have one may have a tolerance of their own.
struct LaneStop {
  double tolerance = 1e-6;
  int max_iterations = 200;
  double error_factor = 2.0;
  double reach = 1.0;
  double of_islands = 0.0;  ///< tolerance of lanes with islands; 0: the same
  bool one_cycle = false;   ///< if no lane has islands: one cycle of the multigrid, whatever it leaves

  double tolerance_of(bool has_islands) const {
    return has_islands && of_islands > 0.0 ? of_islands : tolerance;
  }
};

/// How a lane's solve ended.
struct LaneOutcome {
  int iterations = 0;
  /// |M (f - K u)| relative to |M f| or |u|, whichever is smaller, docs/formulation.md 4.1
  double residual = 0.0;
  bool converged = false;
  double smallest = 1.0;  ///< estimate of the smallest eigenvalue of M K (SpectrumEstimate)
  bool finite = true;     ///< false: something was not a number
  bool has_islands = false;
};

}  // namespace fabseq
