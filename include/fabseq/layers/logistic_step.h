// SPDX-License-Identifier: MIT
/// \file
/// The steps of multi-planar layers (docs/formulation.md 3.2).
#pragma once

#include "fabseq/layers/smooth_step.h"

#include <cmath>

namespace fabseq {

/// 1 / (1 + exp(-x)) and its derivative. A loop over many values becomes vector instructions.
struct Logistic {
  /// Below minus this it is 0: the smallest numbers a processor has are slow.
  static constexpr double negligible = 690.0;

  static double value(double x) {
    const double decay = exp_of_minus(std::abs(x));
    const double value = (x < 0.0 ? decay : 1.0) / (1.0 + decay);
    return x < -negligible ? 0.0 : value;
  }
  static double derivative(double x) {
    const double decay = exp_of_minus(std::abs(x));
    const double value = decay / ((1.0 + decay) * (1.0 + decay));
    return std::abs(x) > negligible ? 0.0 : value;
  }
};

/// H(t; tau) = 1 - logistic(sharpness (t - tau)): 1 before a timestamp, 0 after it.
class TimestampStep {
 public:
  TimestampStep(double timestamp, double sharpness) : timestamp_(timestamp), sharpness_(sharpness) {}

  double value(double time) const { return Logistic::value(sharpness_ * (timestamp_ - time)); }
  double derivative(double time) const {
    return -sharpness_ * Logistic::derivative(sharpness_ * (timestamp_ - time));
  }

 private:
  double timestamp_, sharpness_;
};

/// logistic(sharpness (1 - x^2)), x = (2 / w) (height - (j - 1/2) w): 1 inside slab j, 1/2 on its faces.
class SlabStep {
 public:
  SlabStep(int slab, double thickness, double sharpness)
      : center_((slab - 0.5) * thickness), scale_(2.0 / thickness), sharpness_(sharpness) {}

  double value(double height) const {
    const double x = scale_ * (height - center_);
    return Logistic::value(sharpness_ * (1.0 - x * x));
  }
  /// With respect to the height.
  double derivative(double height) const {
    const double x = scale_ * (height - center_);
    return -2.0 * sharpness_ * scale_ * x * Logistic::derivative(sharpness_ * (1.0 - x * x));
  }
  /// Slabs farther from a height than this, in their number, are 0 there.
  static double reach(double sharpness) { return 0.5 * std::sqrt(1.0 + Logistic::negligible / sharpness); }

 private:
  double center_, scale_, sharpness_;
};

}  // namespace fabseq
