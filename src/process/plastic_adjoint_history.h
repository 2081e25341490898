// SPDX-License-Identifier: MIT
#pragma once

#include "process/plastic_history.h"

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace fabseq {

/// Derivatives of a functional with respect to what histories depend on, of a share of the model's elements:
/// [element of the share][step].
struct PlasticDerivatives {
  std::vector<double> stage;         ///< stage density of the step's layer
  std::vector<double> stage_before;  ///< that of the step before (thermal strain of what stands)
  std::vector<double> layer;         ///< density of the layer that is added
  std::vector<double> strains;       ///< inherent strain, [element][step][Voigt]
  std::vector<double> modulus, yield, elongation;  ///< f, f_Y, g
};

/// The history of plastic flow in each element, transposed (docs/developer/derivatives.md 16): from what an
/// adjoint displacement does in each step to the forces of its equation, and to derivatives. Local.
class PlasticAdjointHistory {
 public:
  /// All arguments must outlive the object. `displacements`: increments or sums, as they were simulated.
  PlasticAdjointHistory(const PlasticHistory& history, const ElementModes& modes, const PlasticInput& input,
                        const PlasticHistory::Displacements& displacements);

  /// What adjoint displacements lambda_s are made of: lambda_s less that of the release; where displacements
  /// are sums, lambda_s less lambda_{s+1}, the release being the last one. [element of the
  /// share][step][ElementModes]; `release` [element of the share][ElementModes], or empty.
  struct Adjoint {
    std::span<const double> steps;
    std::span<const double> release;
  };
  /// Sets `forces` to the equation of each step, laid out as `steps`, where displacements are sums less that of
  /// the next step, and `at_release` to that of the release. `derivatives`: set if not null.
  void run(const Adjoint& adjoint, std::vector<double>& forces, std::vector<double>& at_release,
           PlasticDerivatives* derivatives) const;

 private:
  struct Record;
  void record(std::size_t element, std::vector<Record>& records) const;
  std::array<double, ElementModes::components> difference(const Adjoint& adjoint, std::size_t element,
                                                          std::size_t step) const;
  void add_derivatives(std::size_t element, std::size_t step, const std::vector<Record>& records,
                       PlasticDerivatives& derivatives) const;

  const PlasticHistory& history_;
  const ElementModes& modes_;
  const PlasticInput& input_;
  const PlasticHistory::Displacements& displacements_;
};

}  // namespace fabseq
