// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/fem/element_matrices.h"
#include "fabseq/layers/layers.h"
#include "fabseq/process/build_step.h"
#include "fabseq/process/elastic_model.h"
#include "fabseq/process/step_temperatures.h"
#include "fabseq/process/strain_source.h"
#include "process/material_curves.h"
#include "process/plastic_point.h"

#include <cstddef>
#include <span>
#include <vector>

namespace fabseq {

/// What a process leaves in its elements after the last step, or after the release: of a share of the model's
/// elements.
struct PlasticState {
  std::vector<double> stress;          ///< [element][Voigt], for unit Young's modulus
  std::vector<double> plastic_strain;  ///< equivalent, [element]
};

/// What histories of plastic flow are found for. References must outlive their use.
struct PlasticInput {
  const LayerDensities& densities;
  std::span<const BuildStep> steps;
  const StepTemperatures* temperatures;  ///< nullptr: the process has one temperature
  const StrainSource<3>& strains;        ///< inherent strain where there are no temperatures
};

/// The history of plastic flow in each element (docs/formulation.md 16): J2 with isotropic hardening, one
/// state per element, radial return in each step (PlasticPoint). Local.
class PlasticHistory {
 public:
  /// The model must outlive the object.
  explicit PlasticHistory(const ElasticModel<3>& model);

  /// Displacements of a share of the model's elements as ElementModes.
  struct Displacements {
    std::size_t first_element;        ///< of the share: number among the model's elements
    std::span<const double> steps;    ///< [element of the share][step][ElementModes]
    bool accumulated;                 ///< whether they are sums up to the step
    std::span<const double> release;  ///< [element of the share][ElementModes]; empty: none
  };
  struct Output {
    /// Stresses and amplitudes times stiffness (ElementModes::forces()): what each step adds to them, or
    /// where displacements are sums, what they are. [element of the share][step][ElementModes]
    std::vector<double> forces;
    std::vector<double>
        at_end;  ///< what they are after the last step, or the release: [element][ElementModes]
    PlasticState built, released;
  };
  void run(const PlasticInput& input, const Displacements& displacements, Output& output) const;

  /// Sets the material of an element of the model in a step.
  void set_step(const PlasticInput& input, std::size_t model_element, std::size_t number,
                PlasticStep& step) const;
  /// State of an element before the first step.
  PlasticPoint start(const PlasticInput& input, std::size_t model_element) const;
  const ElasticModel<3>& model() const { return model_; }
  const MaterialCurves& curves() const { return curves_; }
  /// Yield stress and hardening over Young's modulus, at room temperature.
  double yield() const { return yield_; }
  double hardening() const { return hardening_; }

 private:
  const ElasticModel<3>& model_;
  MaterialCurves curves_;
  double yield_, hardening_;
};

}  // namespace fabseq
