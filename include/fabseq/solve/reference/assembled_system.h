// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/base/petsc.h"
#include "fabseq/grid/unknown_numbering.h"
#include "fabseq/solve/reference/preconditioner.h"
#include "fabseq/solve/solve_report.h"
#include "fabseq/solve/solver_settings.h"

#include <initializer_list>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace fabseq {

/// What to solve with.
struct AssembledSolverSettings {
  ReferenceMethod method = ReferenceMethod::automatic;
  double tolerance = 1e-6;
  int max_iterations = 1000;
  std::string options_prefix;  ///< of PETSc options, such as "elasticity_": -elasticity_ksp_monitor
};

/// The reference solver, of stock PETSc: a symmetric positive definite system on the nodes of a model:
/// conduction (one component) or elasticity (Dim components). Prescribed values are zero: a lifted solution
/// is the caller's. Solved by conjugate gradients to a preconditioned residual, with algebraic multigrid
/// (GAMG, rigid-body or constant near-null space), geometric multigrid with Galerkin coarse operators and
/// Chebyshev/Jacobi smoothing (as in Aage et al. 2015), or a Cholesky factorization (MUMPS) as
/// preconditioner.
template <int Dim>
class AssembledSystem {
 public:
  /// A sum of element matrices: sum over elements of coefficient[element] * matrix.
  struct Term {
    std::span<const double> matrix;        ///< (components * corners)^2, row by row
    std::span<const double> coefficients;  ///< one per element of the domain, in its order
  };

  /// Collective. `domain` must outlive the system; `numbering` is shared between systems on the same
  /// unknowns.
  AssembledSystem(const SystemDomain& domain, std::shared_ptr<const UnknownNumbering<Dim>> numbering,
                  const AssembledSolverSettings& settings);

  /// Fills the matrix and sets up the preconditioner. `diagonal`: added for each owned node of a system with
  /// one component; empty: 0. Collective.
  void assemble(std::initializer_list<Term> terms, std::span<const double> diagonal = {});
  /// Solves for one right-hand side, [owned node][component]; entries at fixed nodes are ignored and come
  /// back 0, as do nodes that are no unknowns. A zero right-hand side gives zero. Collective; does not throw
  /// if it does not converge.
  SolveReport solve(std::span<const double> load, std::span<double> solution);
  /// The same for several right-hand sides, with a report each. A factorization takes them side by side
  /// (-ksp_monitor does not see those), an iterative method one after the other.
  std::vector<SolveReport> solve(std::span<const std::vector<double>> loads,
                                 std::span<std::vector<double>> solutions);

  /// Later solves go to this tolerance. Collective.
  void set_tolerance(double tolerance);

 private:
  void create_matrix();
  void add_diagonal(std::span<const double> diagonal);
  void create_solver();
  void gather_load(std::span<const double> load, PetscScalar* values) const;
  void scatter_solution(const PetscScalar* values, std::span<double> solution) const;
  std::vector<SolveReport> solve_side_by_side(std::span<const std::vector<double>> loads,
                                              std::span<std::vector<double>> solutions);
  SolveReport last_report() const;

  const SystemDomain& domain_;
  std::shared_ptr<const UnknownNumbering<Dim>> numbering_;
  AssembledSolverSettings settings_;
  ReferenceMethod method_;
  bool relaxed_ = false;  ///< whether a solve needed the safe preconditioner
  MatHandle matrix_;
  KspHandle solver_;
  VecHandle load_, solution_;
};

}  // namespace fabseq
