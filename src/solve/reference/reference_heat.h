// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/fem/element_matrices.h"
#include "fabseq/kernels/lane_vector.h"
#include "fabseq/solve/heat_solver.h"
#include "fabseq/solve/reference/assembled_system.h"

#include <memory>
#include <vector>

namespace fabseq {

/// Stock PETSc, as oracle of the tests and baseline of the benchmarks: one assembled system; a factorization
/// takes all right-hand sides side by side, an iterative method one after the other.
template <int Dim>
class ReferenceHeat : public HeatSolver<Dim> {
 public:
  /// The grid and `domain` must outlive the solver. `lumped`: the mass matrix is diagonal. Collective.
  ReferenceHeat(const Grid<Dim>& grid, const SystemDomain& domain, bool lumped,
                const AssembledSolverSettings& settings);

  using HeatSolver<Dim>::set_operator;
  void set_operator(const HeatOperator& of) override;
  std::vector<SolveReport> solve(std::span<const LaneVector> loads, std::span<LaneVector> solutions) override;
  void set_tolerance(const SolveTolerance& tolerance) override;
  void start_cold() override;

 private:
  ElementMatrices<Dim> element_;
  bool lumped_;
  AssembledSolverSettings settings_;
  const SystemDomain& domain_;
  std::shared_ptr<const UnknownNumbering<Dim>> numbering_;
  std::unique_ptr<AssembledSystem<Dim>> system_;
};

}  // namespace fabseq
