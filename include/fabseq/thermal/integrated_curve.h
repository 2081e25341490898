// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

namespace fabseq {

/// A positive property as a function of the temperature, and its integral from the temperature of the air
/// (docs/formulation.md 14.3): piecewise linear between the points of its table, constant beyond them. All
/// arguments are excesses over that temperature, K. Local.
class IntegratedCurve {
 public:
  /// Is 1 at all temperatures.
  IntegratedCurve() = default;
  /// `temperatures`: rising, degrees Celsius. `values`: above 0, one for each; empty: 1 everywhere.
  /// `ambient`: of the air.
  IntegratedCurve(const std::vector<double>& temperatures, const std::vector<double>& values, double ambient);

  bool is_one() const { return values_.empty(); }
  double value(double excess) const;
  /// Integral of the values from 0.
  double integral(double excess) const;
  /// The excess at which integral() is this one.
  double excess_of(double integral) const;

 private:
  /// Line before the first point, between two, or beyond the last: from a point of the table, with a slope.
  struct Line {
    double excess, value, slope, integral;
  };
  Line line_at(double number, const std::vector<double>& of_points) const;

  std::vector<double> excesses_, values_, integrals_;  ///< of the points
};

}  // namespace fabseq
