// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/fem/element_matrices.h"
#include "fabseq/kernels/lane_vector.h"
#include "fabseq/solve/elasticity_solver.h"
#include "fabseq/solve/reference/assembled_system.h"

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace fabseq {

/// Stock PETSc, as oracle of the tests and baseline of the benchmarks: one assembled system per layer, one
/// layer at a time. Systems small enough are kept from the forward to the adjoint solve.
template <int Dim>
class ReferenceElasticity : public ElasticitySolver<Dim> {
 public:
  /// Systems up to this many unknowns are kept, one per layer: a factorization costs more than its memory.
  static constexpr std::int64_t keep_limit = 40000;

  /// Collective. `domain` must outlive the solver.
  ReferenceElasticity(const Grid<Dim>& grid, const SystemDomain& domain,
                      const SquareMatrix<element_unknowns<Dim>>& stiffness,
                      const AssembledSolverSettings& settings);

  void set_operators(int first_layer, int lanes, std::span<const double> stiffness, bool changed) override;
  std::vector<std::vector<SolveReport>> solve(std::span<const LaneVector> loads,
                                              std::span<LaneVector> displacements) override;
  void set_tolerance(const SolveTolerance& tolerance) override;
  void start_cold() override;
  std::string description() const override;

 private:
  AssembledSystem<Dim>& assembled(int lane);

  const SystemDomain& domain_;
  SquareMatrix<element_unknowns<Dim>> stiffness_;
  AssembledSolverSettings settings_;
  std::shared_ptr<const UnknownNumbering<Dim>> numbering_;
  int first_layer_ = 0, lanes_ = 0;
  std::vector<double> coefficients_;                              ///< [element][lane] of the current block
  std::map<int, std::unique_ptr<AssembledSystem<Dim>>> systems_;  ///< by layer if kept, else under -1
  std::map<int, bool> up_to_date_;  ///< whether a kept layer's system holds its stiffness
  bool keep_;
};

}  // namespace fabseq
