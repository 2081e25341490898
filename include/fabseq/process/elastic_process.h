// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/process/adjoint_loads.h"
#include "fabseq/process/process.h"
#include "fabseq/process/strain_cases.h"
#include "fabseq/process/superposition.h"
#include "fabseq/process/support_forces.h"

#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace fabseq {

/// The layer-by-layer inherent-strain simulation and its adjoint (docs/formulation.md 4.1,
/// docs/developer/derivatives.md 8.2). Each step adds its increment to the displacement, u = sum of du_s,
/// where K_s du_s = f_s (StepSystems, BuildStep).
///
/// Under nominal deposition (4.6), u is the sum of w_j du_s, j the step's layer. Adjoint: K_s lambda_s =
/// -w_j (dJ/du + dJ/d(w_j du_s)), then dJ/drho_j,e = E' lambda^T K_0 du, and dJ/d(drho_j,e) = -q
/// drho^(q-1) lambda^T f_0 where the layer is added. For what is measured after the release (Release),
/// lambda_s on the supports is not 0 but the release's adjoint w.
///
/// With scenarios of the strain, one system has several right-hand sides (StrainCases). Under nominal
/// deposition, adjoints of steps with a negligible load are left out (AdjointLoads).
template <int Dim>
class ElasticProcess : public Process<Dim> {
 public:
  using Process<Dim>::groups, Process<Dim>::model;

  ElasticProcess(const ElasticModel<Dim>& model, std::unique_ptr<ElasticitySolver<Dim>> solver,
                 const LayerGroups& groups, BlockSolver blocks, int lanes = widest_block);

  const ProcessResult& simulate(const ProcessInput<Dim>& input) override;
  /// Simulates a step for each layer.
  const ProcessResult& simulate(const LayerDensities& densities, const StrainSource<Dim>& strains) {
    return simulate(ProcessInput<Dim>{densities, strains, steps_of_layers(densities.count())});
  }
  void pull_back(const LayerDensities& densities, std::span<const ProcessAdjoint> functionals,
                 std::span<const ProcessDerivatives> derivatives) override;
  std::vector<double> release_displacement(const LayerDensities& densities,
                                           const ReleaseSolver& solver) const override;
  LockedIn locked_in(const LayerDensities& densities) const override;
  LockedIn released(LockedIn built, std::span<const double> release) const override;
  /// Forces of the supports on the last simulation's part, sum_s (K_s du_s - f_s), [owned node][component], 0
  /// elsewhere, for unit Young's modulus. They balance themselves. `number`: of the strain case.
  std::vector<double> reactions(const LayerDensities& densities, std::size_t number = 0) const;

 private:
  class Forward;
  using Process<Dim>::systems_, Process<Dim>::deposition_, Process<Dim>::release_, Process<Dim>::strains_,
      Process<Dim>::result_, Process<Dim>::adjoint_iterations_;

  StrainCases<Dim> cases_;
  Superposition superposition_;
  SupportForces<Dim> supports_;
  AdjointLoads<Dim> adjoint_loads_;
};

}  // namespace fabseq
