// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/fem/element_matrices.h"
#include "fabseq/layers/layers.h"
#include "fabseq/process/build_step.h"
#include "fabseq/process/elastic_model.h"
#include "fabseq/process/step_temperatures.h"
#include "fabseq/process/strain_source.h"
#include "process/material_curves.h"

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

/// The history of plastic flow in each element (docs/formulation.md 16): J2 with isotropic hardening,
/// one state per element, radial return in each step. Strains and stresses are in Voigt order, forces and
/// stresses for unit Young's modulus at room temperature. Local.
class PlasticHistory {
 public:
  /// The model must outlive the object.
  explicit PlasticHistory(const ElasticModel<3>& model);

  /// What a history is found for. References must outlive the call.
  struct Input {
    const LayerDensities& densities;
    std::span<const BuildStep> steps;
    const StepTemperatures* temperatures;   ///< nullptr: the process has one temperature
    const StrainSource<3>& strains;         ///< inherent strain where there are no temperatures
    std::size_t first_element;              ///< of the share: number among the model's elements
    std::span<const double> displacements;  ///< of the steps, [element of the share][step][ElementModes]
    bool accumulated;                       ///< whether they are sums up to the step
    std::span<const double> release;        ///< [element of the share][ElementModes]; empty: none
  };
  struct Output {
    /// Stresses and amplitudes times stiffness (ElementModes::forces()): what each step adds to them, or
    /// where displacements are sums, what they are. [element of the share][step][ElementModes]
    std::vector<double> forces;
    std::vector<double>
        at_end;  ///< what they are after the last step, or the release: [element][ElementModes]
    PlasticState built, released;
  };
  void run(const Input& input, Output& output) const;
  const MaterialCurves& curves() const { return curves_; }

 private:
  struct Point;
  struct Step;
  void advance(const Step& step, const double* displacement, Point& point) const;
  void set_step(const Input& input, std::size_t model_element, std::size_t number, Step& step) const;

  const ElasticModel<3>& model_;
  MaterialCurves curves_;
  double yield_, hardening_;  ///< over Young's modulus
};

}  // namespace fabseq
