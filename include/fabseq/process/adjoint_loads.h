// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/process/process_adjoint.h"
#include "fabseq/process/process_result.h"
#include "fabseq/process/step_systems.h"

#include <span>
#include <vector>

namespace fabseq {

/// Sets `load` to -w_j (dJ/du + dJ/d(w_j du_s)) in a block's steps, on all owned nodes. Local.
void set_adjoint_load(const ProcessAdjoint& functional, const ProcessResult& result, std::size_t block,
                      LaneVector& load);

/// Loads of the adjoint systems of a process (docs/developer/derivatives.md 8.2), -w_j (dJ/du + dJ/d(w_j
/// du_j)).
///
/// Under nominal deposition w_j is 0 where nothing stands yet, and the load of most of the early steps next
/// to nothing. It is measured as what Jacobi's preconditioner makes of it,
///
///     |b_j|^2 = sum over free nodes of |b_j,n|^2 / (sum over the elements at n of E(rho_j,e)),
///
/// since small loads on soft material move it far. Steps with less than 1e-10 of the largest are negligible
/// (docs/performance.md). Source: fabseq's own.
template <int Dim>
class AdjointLoads {
 public:
  /// The systems must outlive the object.
  explicit AdjointLoads(const StepSystems<Dim>& systems) : systems_(systems), model_(systems.model()) {}

  /// Finds out which steps have a load worth solving for; all of them for functionals of the release, which
  /// load the supports in every step, and where all of the increments counts. Collective on the world of the
  /// groups.
  void update(const LayerDensities& densities, const ProcessResult& result,
              std::span<const ProcessAdjoint> functionals);
  /// Whether a functional, by its number, has such a step in a block.
  bool any(std::size_t functional, const StepBlock& block) const;
  /// Sets `load` to the load of a block, by its number; 0 in steps that are negligible. Local.
  void set(const ProcessAdjoint& functional, std::size_t number, const ProcessResult& result,
           std::size_t block, LaneVector& load) const;

 private:
  /// Adds |b_j|^2 of this rank's steps and nodes to `squares`, by step.
  void add_squares(const StepBlock& block, const LaneVector& load, const LaneVector& stiffness,
                   std::span<double> squares) const;

  const StepSystems<Dim>& systems_;
  const ElasticModel<Dim>& model_;
  std::vector<std::vector<char>> counts_;  ///< [functional][step]
};

}  // namespace fabseq
