// SPDX-License-Identifier: MIT
/// \file
/// The convex subproblem of an MMA update and its interior-point solution.
#pragma once

#include "fabseq/mma/mma.h"
#include "fabseq/mma/mma_variables.h"

#include <mpi.h>

#include <span>

namespace fabseq {

/// Solves min f0 + a0 z + sum_i (c_i y_i + d_i y_i^2 / 2), g_i(v) - a_i z - y_i <= 0, alpha <= v <= beta, y,
/// z >= 0, with f0, g the approximations of `variables`, by a primal-dual Newton method with a falling
/// barrier; `variables.step()` is the solution. z is left out where all a_i are 0. Collective on `comm`,
/// three reductions and a broadcast a Newton step. Throws NumericalError if a gradient is not finite or the
/// method does not converge.
MmaReport solve_mma_subproblem(MPI_Comm comm, MmaVariables& variables, std::span<const double> values,
                               const MmaRows& rows);

}  // namespace fabseq
