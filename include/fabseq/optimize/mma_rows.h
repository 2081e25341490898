/// \file
/// The replicated half of the MMA subproblem: the rows' multipliers for a linear model of the rows.
#pragma once

#include "fabseq/optimize/mma.h"

#include <span>
#include <vector>

namespace fabseq {

/// Multipliers of the rows and of the artificial variables, one a row, and z.
struct MmaMultipliers {
  std::vector<double> lambda, y;
  double z = 0.0;
  bool converged = false;
};

/// Solves b_i - (H lambda)_i - a_i z - y_i + s_i = 0, lambda_i s_i = 0, y_i (c_i + d_i y_i - lambda_i) = 0,
/// z (a_0 - a^T lambda) = 0, everything including c + d y - lambda and a_0 - a^T lambda >= 0: the optimality
/// conditions of the subproblem if the rows' values were b - H lambda. By a primal-dual interior-point method
/// with Mehrotra's predictor and corrector. \param matrix  H, symmetric and positive semidefinite, m by m by
/// columns, lower triangle, leading dimension `stride` \param right   b
MmaMultipliers solve_row_model(std::span<const double> matrix, std::size_t stride,
                               std::span<const double> right, const MmaRows& rows);

}  // namespace fabseq
