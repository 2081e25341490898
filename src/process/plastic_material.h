// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/layers/layers.h"
#include "fabseq/process/build_step.h"
#include "fabseq/process/elastic_model.h"
#include "fabseq/process/process_adjoint.h"
#include "fabseq/process/step_temperatures.h"
#include "fabseq/process/strain_source.h"
#include "process/material_curves.h"
#include "process/plastic_batches.h"
#include "process/plastic_point.h"
#include "process/plastic_wave.h"

#include <cstddef>
#include <span>
#include <vector>

namespace fabseq {

/// What a process with plastic flow is simulated for. References must outlive their use.
struct PlasticInput {
  const LayerDensities& densities;
  std::span<const BuildStep> steps;
  const StepTemperatures* temperatures;  ///< nullptr: the process has one temperature
  const StrainSource<3>& strains;        ///< inherent strain where there are no temperatures

  bool heated() const { return temperatures != nullptr; }
};

/// Derivatives of a functional with respect to what a PlasticStep is made of.
struct PlasticStepDerivatives {
  PlasticLanes modulus, stiffness, yield, hardening, elongation, load;
  PlasticLanes stiffness_before;  ///< that of the step before
  Voigt inherent_strain;
};

/// Densities and temperatures to the material of elements in each step (docs/formulation.md 16), of this
/// rank's share of the elements, and derivatives back to them. Local.
class PlasticMaterial {
 public:
  /// All arguments must outlive the object.
  PlasticMaterial(const ElasticModel<3>& model, const PlasticBatches& batches, const PlasticInput& input);

  /// States of all batches before the first step.
  std::vector<PlasticPoint> start() const;
  /// Prepares step() for the steps of a wave.
  void set_wave(const PlasticWave& wave);
  /// Material of a batch in a step of the wave.
  PlasticStep step(std::size_t batch, int step) const;
  /// Adds derivatives to those with respect to densities, strains and temperatures.
  void add_derivatives(std::size_t batch, int step, const PlasticStepDerivatives& derivatives,
                       const ProcessDerivatives& to) const;
  const MaterialCurves& curves() const { return curves_; }

 private:
  struct Values {
    PlasticLanes modulus, stiffness, yield_share, elongation, load;
  };
  void set_values(std::size_t batch, int step, Values& values) const;
  void set_strains();
  /// Number of a step of the wave among all of them; the release has the material of the last one.
  std::size_t number_of(int step) const {
    return wave_.release ? input_.steps.size() - 1 : wave_.first + step;
  }
  bool adds(int step) const { return !wave_.release && input_.steps[number_of(step)].adds; }
  double density(std::size_t number, int element) const {
    return model_.stage_density(input_.densities.stage[input_.steps[number].layer], element);
  }

  const ElasticModel<3>& model_;
  const PlasticBatches& batches_;
  const PlasticInput& input_;
  MaterialCurves curves_;
  double yield_, hardening_;  ///< over Young's modulus
  PlasticWave wave_;
  std::vector<Values> values_;  ///< [batch][step]
  std::vector<Voigt> strains_;  ///< inherent, [step], or [batch][step] where elements have their own
};

// In the header, since what calls it takes longer to copy a step than to use it.
inline PlasticStep PlasticMaterial::step(std::size_t batch, int step) const {
  const std::size_t at = batch * wave_.count + step;
  const Values& values = values_[at];
  PlasticStep result;
  result.modulus = values.modulus;
  result.stiffness = values.stiffness;
  result.yield = values.yield_share * yield_;
  result.hardening = values.yield_share * hardening_;
  result.elongation = values.elongation;
  result.load = values.load;
  if (!wave_.release && !input_.heated()) {
    const Voigt& strain = strains_[strains_.size() == values_.size() ? at : static_cast<std::size_t>(step)];
    for (std::size_t c = 0; c < strain.size(); ++c) result.inherent_strain[c] = strain[c];
    return result;
  }
  for (PlasticLanes& strain : result.inherent_strain) strain = PlasticLanes::zero();
  if (wave_.release) return result;
  for (int a = 0; a < 3; ++a)
    result.inherent_strain[a] = values.elongation - PlasticLanes::broadcast(curves_.first_elongation());
  return result;
}

}  // namespace fabseq
