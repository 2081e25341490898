// SPDX-License-Identifier: MIT
/// \file
/// Uses PETSc as the reference path does and, with any argument, forgets to destroy a vector: for
/// tests/integration/leaks_test.py.
#include <petscksp.h>

namespace {

/// Of the numbers 1, 2, ... on the diagonal.
Mat diagonal(PetscInt rows_of_a_rank) {
  Mat matrix = nullptr;
  PetscInt begin = 0, end = 0;
  (void)MatCreateAIJ(PETSC_COMM_WORLD, rows_of_a_rank, rows_of_a_rank, PETSC_DETERMINE, PETSC_DETERMINE, 1,
                     nullptr, 0, nullptr, &matrix);
  (void)MatGetOwnershipRange(matrix, &begin, &end);
  for (PetscInt row = begin; row < end; ++row) (void)MatSetValue(matrix, row, row, 1.0 + row, INSERT_VALUES);
  (void)MatAssemblyBegin(matrix, MAT_FINAL_ASSEMBLY);
  (void)MatAssemblyEnd(matrix, MAT_FINAL_ASSEMBLY);
  return matrix;
}

void solve(bool forget) {
  Mat matrix = diagonal(10);
  Vec load = nullptr, solution = nullptr;
  KSP solver = nullptr;
  PC preconditioner = nullptr;
  (void)MatCreateVecs(matrix, &load, &solution);
  (void)VecSet(load, 1.0);
  (void)KSPCreate(PETSC_COMM_WORLD, &solver);
  (void)KSPSetOperators(solver, matrix, matrix);
  (void)KSPGetPC(solver, &preconditioner);
  (void)PCSetType(preconditioner, PCGAMG);
  (void)KSPSolve(solver, load, solution);
  (void)KSPDestroy(&solver);
  (void)MatDestroy(&matrix);
  (void)VecDestroy(&solution);
  if (!forget) (void)VecDestroy(&load);
}

}  // namespace

int main(int argc, char** argv) {
  if (PetscInitialize(&argc, &argv, nullptr, nullptr) != 0) return 1;
  solve(argc > 1);
  return PetscFinalize() != 0;
}
