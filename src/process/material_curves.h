// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/process/process_settings.h"

#include <vector>

namespace fabseq {

/// How a material depends on its temperature (docs/formulation.md 16): piecewise linear between the
/// temperatures of its table, constant beyond them. Local.
class MaterialCurves {
 public:
  explicit MaterialCurves(const MaterialSettings& material);

  /// Factor on Young's modulus at a temperature, degrees Celsius.
  double young(double temperature) const { return at(young_, temperature, 1.0); }
  /// Factor on yield stress and hardening.
  double yield(double temperature) const { return at(yield_, temperature, 1.0); }
  /// Free thermal elongation, a strain; none is added above the cut-off.
  double elongation(double temperature) const;
  // Their slopes, 1/K; at a point of the table, those above it.
  double young_slope(double temperature) const { return slope(young_, temperature); }
  double yield_slope(double temperature) const { return slope(yield_, temperature); }
  double elongation_slope(double temperature) const {
    return temperature < cut_off_ ? slope(elongations_, temperature) : 0.0;
  }
  /// The elongation that new material has when it begins to shrink: that at the cut-off.
  double first_elongation() const { return elongation(cut_off_); }

 private:
  /// Value of a curve; `none` where there is no table.
  double at(const std::vector<double>& values, double temperature, double none) const;
  double slope(const std::vector<double>& values, double temperature) const;

  std::vector<double> temperatures_, young_, yield_, elongations_;
  double cut_off_;
};

}  // namespace fabseq
