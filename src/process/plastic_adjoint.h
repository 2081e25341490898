// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/process/process_adjoint.h"
#include "fabseq/process/process_result.h"
#include "fabseq/process/release.h"
#include "fabseq/process/step_systems.h"
#include "process/plastic_adjoint_history.h"
#include "process/plastic_sweeps.h"

#include <cstddef>
#include <span>
#include <vector>

namespace fabseq {

/// The adjoint of a plastic process for one functional, by sweeps like those forward
/// (docs/developer/derivatives.md 16). The unknowns are those of PlasticAdjointHistory::Adjoint; they vanish on
/// the supports but for the release's. Collective on the world of the groups.
class PlasticAdjoint : public StepLoads {
 public:
  /// `forward`: the sweeps that have found the state. `release`: nullptr: there is none. References must
  /// outlive the object.
  PlasticAdjoint(StepSystems<3>& systems, Release<3>* release, const PlasticSweeps& forward,
                 const ProcessResult& result, const ProcessAdjoint& functional);

  /// Iterates until a sweep changes the adjoint by less than this share of it. Returns the number of sweeps.
  /// Throws NumericalError if there would be too many.
  int run(double tolerance);
  /// Derivatives of this rank's share of the elements.
  const PlasticDerivatives& derivatives() const { return derivatives_; }

  std::size_t begin(std::size_t) override { return 1; }
  void set(std::size_t block, std::size_t side, LaneVector& load) override;
  void take(std::size_t block, std::size_t side, LaneVector& solution) override;

 private:
  /// Sets what the functional adds to the equation of each step; where displacements are sums, less that of
  /// the next step.
  void set_explicit(const ProcessResult& result);
  void find_forces(PlasticDerivatives* derivatives);

  StepSystems<3>& systems_;
  Release<3>* release_;
  const PlasticSweeps& forward_;
  const ProcessAdjoint& functional_;
  PlasticHistory::Displacements displacements_;
  PlasticAdjointHistory history_;
  std::vector<LaneVector> explicit_;  ///< by block
  std::vector<double> unknowns_, step_;
  std::vector<LaneVector> forces_;
  std::vector<double> at_release_;  ///< on all owned nodes
  PlasticDerivatives derivatives_;
};

}  // namespace fabseq
