// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/process/process_adjoint.h"
#include "fabseq/process/process_result.h"
#include "process/plastic_sweeps.h"

#include <cstddef>
#include <span>
#include <vector>

namespace fabseq {

/// The adjoints of a plastic process, wave by wave from the release to the first steps, by sweeps like those
/// forward (docs/developer/derivatives.md 16). The unknowns of a wave are those of
/// PlasticHistory::run_back(); they vanish on the supports but for the release's. Collective on the world of
/// the groups.
class PlasticAdjoint {
 public:
  /// `forward`: the sweeps that have found the state. All arguments must outlive the object.
  PlasticAdjoint(PlasticSweeps& forward, const ProcessResult& result) : forward_(forward), result_(result) {}

  /// Adds derivatives of functionals. Returns the number of sweeps of each step, the largest of its
  /// functionals. `unknowns`: [functional][wave], from which sweeps begin and with which they end; empty:
  /// from zero, and they are not kept. Throws NumericalError if there would be too many sweeps.
  std::vector<int> run(std::span<const ProcessAdjoint> functionals,
                       std::span<const ProcessDerivatives> derivatives, double change,
                       std::span<std::vector<LaneVector>> unknowns);

 private:
  /// What a functional adds to the equations of a wave.
  LaneVector explicit_forces(const PlasticWave& wave, const ProcessAdjoint& functional) const;
  static void subtract_next(const LaneVector& stiffness, LaneVector& forces);
  /// Takes adjoints back through a wave from `dual`: sets `forces`, or adds derivatives, and leaves in `dual`
  /// what is before the wave.
  void run_back(std::size_t wave, const LaneVector& unknowns, std::vector<PlasticDual>& dual,
                LaneVector* forces, const ProcessDerivatives* to);

  PlasticSweeps& forward_;
  const ProcessResult& result_;
  PlasticHistory::Records records_;
};

}  // namespace fabseq
