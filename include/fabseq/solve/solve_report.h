// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/base/error.h"
#include "fabseq/base/formatted.h"

#include <limits>
#include <string>

namespace fabseq {

/// How a solve ended.
struct SolveReport {
  int iterations = 0;
  double residual = 0.0;  ///< preconditioned residual relative to a zero start, docs/formulation.md 4.1
  bool converged = true;
  std::string reason;  ///< for how it ended, by PETSc or the lane solver; empty for a zero right-hand side
  bool has_islands = false;  ///< whether stiff pieces hang in soft surroundings; known in lanes only
};

/// Throws NumericalError("WHAT did not converge: ...") if a solve did not.
inline void require_convergence(const SolveReport& report, const std::string& what) {
  if (report.converged) return;
  throw NumericalError(what + formatted(" did not converge: %d iterations, residual %g (%s)",
                                        report.iterations, report.residual, report.reason.c_str()));
}

}  // namespace fabseq
