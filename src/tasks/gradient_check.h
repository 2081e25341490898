// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/base/json.h"

#include <string>
#include <vector>

namespace fabseq {

/// Errors of one component of a response along a direction in the space of one kind of variables.
struct GradientError {
  std::string name, type;
  std::string variables;  ///< design (the sequence's), time_points or angles (the layers')
  double value = 0.0;
  double adjoint = 0.0;             ///< directional derivative by the adjoint
  std::vector<double> differences;  ///< central differences, one per step
  std::vector<double> relative;     ///< |difference - adjoint| / |adjoint|, one per step; 0 where both are 0

  /// Fourth-order differences (Richardson): of each step and the next shorter one, without the error in the
  /// square of the step. One less than steps.
  std::vector<double> extrapolated() const;
  double best() const;  ///< smallest relative error, of the central and the fourth-order differences
};

/// Adjoint gradients against central differences (docs/developer/derivatives.md 8.6): errors of all
/// components for a list of steps.
struct GradientCheck {
  std::string name;           ///< of the config
  std::vector<double> steps;  ///< of the optimizer's variable, fraction of its range
  std::vector<GradientError> errors;

  double worst() const;  ///< largest of the best errors
  std::string csv() const;
  Json json() const;
};

}  // namespace fabseq
