// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/kernels/lane_vector.h"
#include "fabseq/process/release.h"
#include "fabseq/process/step_systems.h"
#include "process/anderson.h"
#include "process/plastic_material.h"
#include "process/plastic_wave.h"

#include <functional>
#include <span>
#include <vector>

namespace fabseq {

/// Sweeps over a wave until its unknowns hardly change: forces that are left in the steps, found with the
/// plastic history of all elements, are taken to corrections by elastic solves, which Anderson's method
/// combines. Collective on the world of the groups.
class PlasticIteration {
 public:
  /// `release`: nullptr: there is none. All arguments must outlive the object.
  PlasticIteration(StepSystems<3>& systems, Release<3>* release, const PlasticInput& input,
                   const MaterialCurves& curves)
      : systems_(systems), release_(release), input_(input), curves_(curves), anderson_(make_anderson()) {}

  /// Prepares a wave. `changed`: whether its systems may be others than when it was last set.
  void set_wave(const PlasticWave& wave, bool changed);
  /// Finds the forces that unknowns leave, on all owned nodes; unknowns are on the model's nodes, of this
  /// group's steps.
  using Forces = std::function<void(const LaneVector& unknowns, LaneVector& forces)>;
  /// Improves the unknowns until a sweep changes them by at most this share of the unknowns of all waves so
  /// far; returns the number of sweeps. `adjoint`: whether they are adjoint displacements. Throws
  /// NumericalError if there would be too many.
  int solve(LaneVector& unknowns, const Forces& forces, bool adjoint, double change);
  /// Begins with the first wave: changes are relative to all unknowns from here on.
  void start_over() {
    square_ = 0.0;
    steps_ = 0;
  }
  /// Gives back what is kept from wave to wave. Local.
  void release_memory();

 private:
  /// `stiffness`: of the wave, [element][lane].
  void set_weights(std::span<const double> stiffness);
  void scale(const BlockRegion& block, std::span<double> stiffness) const;
  void set_tolerance(const SolveTolerance& of_steps, double release);
  void correct(bool adjoint);
  Anderson make_anderson() const;
  std::vector<float> leveled_weights(const LaneVector& unknowns) const;
  void warn_of_rounding(double reached, double change) const;

  StepSystems<3>& systems_;
  Release<3>* release_;
  const PlasticInput& input_;
  const MaterialCurves& curves_;
  PlasticWave wave_;
  std::vector<float> weights_;  ///< of the unknowns in products: the diagonal of the stiffness, about
  std::vector<char> hangs_;     ///< whether stiff pieces hang in what is not built yet, by lane
  double square_ = 0.0;         ///< of the norm of the unknowns of all waves so far
  int steps_ = 0;               ///< of all waves so far
  Anderson anderson_;
  LaneVector forces_, solution_, step_;  ///< of a sweep
};

}  // namespace fabseq
