// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/process/adjoint_loads.h"
#include "fabseq/process/deposition.h"
#include "fabseq/process/process_adjoint.h"
#include "fabseq/process/process_result.h"
#include "fabseq/process/step_systems.h"
#include "fabseq/process/strain_cases.h"
#include "fabseq/process/strain_source.h"
#include "fabseq/process/support_forces.h"

#include <cstddef>
#include <span>
#include <vector>

namespace fabseq {

/// A functional on its way back through an elastic process.
struct ElasticFunctional {
  const ProcessAdjoint* from = nullptr;
  const ProcessDerivatives* to = nullptr;
  std::vector<double> motion;  ///< of the supports in its adjoints, [owned node][component]; empty: none
};

/// What the adjoint of an elastic process is found from. References must outlive its use.
template <int Dim>
struct ElasticRun {
  const StepSystems<Dim>& systems;
  const SupportForces<Dim>& supports;
  const Deposition<Dim>* deposition;  ///< nullptr: all of the increments counts
  const StrainCases<Dim>& cases;
  const LayerDensities& densities;
  const StrainSource<Dim>& strains;
  const ProcessResult& result;
  LaneVector& increments;  ///< memory for those of a block on all owned nodes
};

/// Adjoint loads of several functionals, and what their solutions add to the derivatives
/// (docs/developer/derivatives.md 8.2). Functionals with negligible loads in a block have explicit
/// derivatives only.
template <int Dim>
class ElasticAdjoint : public StepLoads {
 public:
  ElasticAdjoint(const ElasticRun<Dim>& run, const AdjointLoads<Dim>& loads,
                 std::span<const ElasticFunctional> functionals)
      : run_(run), loads_(loads), functionals_(functionals) {}

  std::size_t begin(std::size_t block) override;
  void set(std::size_t block, std::size_t side, LaneVector& load) override;
  void take(std::size_t block, std::size_t side, LaneVector& solution) override;

 private:
  /// Adds what comes from the adjoints of a block, if it has any, and from the weights.
  void add_derivatives(std::size_t block, const ElasticFunctional& functional, const LaneVector* adjoint);

  const ElasticRun<Dim>& run_;
  const AdjointLoads<Dim>& loads_;
  std::span<const ElasticFunctional> functionals_;
  std::vector<std::size_t> solved_;                         ///< functionals, by side of the block
  std::vector<typename Deposition<Dim>::Missing> missing_;  ///< of the block's steps
  const LaneVector* spread_from_ = nullptr;                 ///< the result's that run_.increments are, if any
};

}  // namespace fabseq
