// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/mma/mma.h"
#include "mma/mma_variables.h"

#include <mpi.h>

#include <span>
#include <vector>

namespace fabseq {

/// Multipliers and artificial variables, one of each per row, and z.
struct MmaMultipliers {
  std::vector<double> lambda, y;
  double z = 0.0;
};

/// The optimality conditions of the subproblem if the rows' values were b - H lambda: finds lambda >= least
/// and y, z, s >= 0 with b_i - (H lambda)_i - a_i z - y_i + s_i = 0, (lambda_i - least_i) s_i = 0, y_i (c_i +
/// d_i y_i - lambda_i) = 0, z (a_0 - a^T lambda) = 0, and c + d y - lambda, a_0 - a^T lambda >= 0.
/// Primal-dual interior-point method with Mehrotra's predictor and corrector. Entries may come out not finite
/// where the data are beyond all bounds. \param matrix  H, symmetric and positive semidefinite, by columns,
/// lower triangle, leading dimension `stride` \param right   b \param least   least multipliers, >= 0;
/// fulfilling the bounds above with room, c > least where c > 0
MmaMultipliers solve_row_model(std::span<const double> matrix, std::size_t stride,
                               std::span<const double> right, const MmaRows& rows,
                               std::span<const double> least);

/// Solves min f0 + a0 z + sum_i (c_i y_i + d_i y_i^2 / 2), g_i(v) - a_i z - y_i <= 0, alpha <= v <= beta, y,
/// z >= 0, with f0, g the approximations of `variables`, by a primal-dual Newton method with a falling
/// barrier; `variables.step()` is the solution. z is left out where all a_i are 0. Collective on `comm`,
/// three reductions and a broadcast a Newton step. The report says whether the method converged. Throws
/// NumericalError if a gradient is not finite.
MmaReport solve_mma_subproblem(MPI_Comm comm, MmaVariables& variables, std::span<const double> values,
                               const MmaRows& rows);

}  // namespace fabseq
