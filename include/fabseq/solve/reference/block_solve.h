// SPDX-License-Identifier: MIT
/// \file
/// Many right-hand sides by one factorization.
#pragma once

#include "fabseq/base/petsc.h"

#include <vector>

namespace fabseq {

/// How the solve of a block of columns ended.
struct BlockReport {
  int iterations = 0;  ///< of all columns
  std::vector<double>
      residuals;  ///< of each column, preconditioned, relative to a zero start; 0 of a zero one
};

/// Solves for all columns of a dense matrix at once: solutions = M^-1 loads, iterated until the residuals are
/// at `tolerance`. M, the preconditioner of `solver`, is set up and a factorization: after two or three
/// iterations a column above the tolerance is the caller's to solve by `solver` itself. PETSc's own
/// KSPMatSolve takes the columns one by one for every method that measures a residual, and forgets how all
/// but the last ended. Collective.
BlockReport solve_block(KSP solver, Mat loads, Mat solutions, double tolerance);

}  // namespace fabseq
