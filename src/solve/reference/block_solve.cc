// SPDX-License-Identifier: MIT
#include "fabseq/solve/reference/block_solve.h"

namespace fabseq {

namespace {

/// The first iteration of an exact solve gains all the digits there are; rounding may want a second one.
constexpr int max_iterations = 3;

std::vector<double> column_norms(Mat matrix) {
  PetscInt columns = 0;
  check(MatGetSize(matrix, nullptr, &columns));
  std::vector<double> norms(columns);
  check(MatGetColumnNorms(matrix, NORM_2, norms.data()));
  return norms;
}

}  // namespace

BlockReport solve_block(KSP solver, Mat loads, Mat solutions, double tolerance) {
  PC pc = nullptr;
  Mat matrix = nullptr;
  check(KSPGetPC(solver, &pc));
  check(KSPGetOperators(solver, &matrix, nullptr));
  MatHandle residuals, corrections;
  check(MatDuplicate(loads, MAT_DO_NOT_COPY_VALUES, residuals.receive()));
  check(MatDuplicate(loads, MAT_DO_NOT_COPY_VALUES, corrections.receive()));

  check(PCMatApply(pc, loads, solutions));
  const std::vector<double> start = column_norms(solutions);
  BlockReport report;
  while (true) {
    ++report.iterations;
    Mat products = residuals;
    check(MatMatMult(matrix, solutions, MAT_REUSE_MATRIX, PETSC_DEFAULT, &products));
    check(MatAYPX(residuals, -1.0, loads, SAME_NONZERO_PATTERN));
    check(PCMatApply(pc, residuals, corrections));
    report.residuals = column_norms(corrections);
    bool solved = true;
    for (std::size_t column = 0; column < start.size(); ++column) {
      if (start[column] > 0.0) report.residuals[column] /= start[column];
      solved = solved && report.residuals[column] <= tolerance;
    }
    if (solved || report.iterations == max_iterations) return report;
    check(MatAXPY(solutions, 1.0, corrections, SAME_NONZERO_PATTERN));
  }
}

}  // namespace fabseq
