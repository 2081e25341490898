// SPDX-License-Identifier: MIT
#include "fabseq/thermal/integrated_curve.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace fabseq {

/// Adds the air's temperature to the points: integrals near it are sums from 0, and lose no digits.
IntegratedCurve::IntegratedCurve(const std::vector<double>& temperatures, const std::vector<double>& values,
                                 double ambient)
    : values_(values) {
  if (values.empty()) return;
  for (const double temperature : temperatures) excesses_.push_back(temperature - ambient);
  integrals_.assign(values.size(), 0.0);
  const auto next = std::ranges::lower_bound(excesses_, 0.0) - excesses_.begin();
  if (next == std::ssize(excesses_) || excesses_[next] != 0.0) {
    const double here = value(0.0);
    excesses_.insert(excesses_.begin() + next, 0.0);
    values_.insert(values_.begin() + next, here);
    integrals_.push_back(0.0);
  }
  const auto area = [&](std::size_t i) {
    return 0.5 * (values_[i - 1] + values_[i]) * (excesses_[i] - excesses_[i - 1]);
  };
  const auto air = static_cast<std::size_t>(next);
  for (std::size_t i = air + 1; i < values_.size(); ++i) integrals_[i] = integrals_[i - 1] + area(i);
  for (std::size_t i = air; i > 0; --i) integrals_[i - 1] = integrals_[i] - area(i);
}

/// Finds the line of the curve by a number: an excess, or an integral, as `of_points` holds.
IntegratedCurve::Line IntegratedCurve::line_at(double number, const std::vector<double>& of_points) const {
  const auto above = std::ranges::upper_bound(of_points, number);
  const auto next = static_cast<std::size_t>(above - of_points.begin());
  const std::size_t i = next == 0 ? 0 : next - 1;
  const bool between = next > 0 && next < values_.size();
  return {excesses_[i], values_[i],
          between ? (values_[i + 1] - values_[i]) / (excesses_[i + 1] - excesses_[i]) : 0.0, integrals_[i]};
}

double IntegratedCurve::value(double excess) const {
  if (is_one()) return 1.0;
  const Line line = line_at(excess, excesses_);
  return line.value + line.slope * (excess - line.excess);
}

double IntegratedCurve::integral(double excess) const {
  if (is_one()) return excess;
  const Line line = line_at(excess, excesses_);
  const double along = excess - line.excess;
  return line.integral + along * (line.value + 0.5 * line.slope * along);
}

double IntegratedCurve::excess_of(double integral) const {
  if (is_one()) return integral;
  const Line line = line_at(integral, integrals_);
  const double more = integral - line.integral;
  const double value = std::sqrt(std::max(line.value * line.value + 2.0 * line.slope * more, 0.0));
  return line.excess + 2.0 * more / (line.value + value);
}

}  // namespace fabseq
