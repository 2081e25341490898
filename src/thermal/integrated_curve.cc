// SPDX-License-Identifier: MIT
#include "fabseq/thermal/integrated_curve.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace fabseq {

IntegratedCurve::IntegratedCurve(const std::vector<double>& temperatures, const std::vector<double>& values,
                                 double ambient)
    : values_(values) {
  if (values.empty()) return;
  for (const double temperature : temperatures) excesses_.push_back(temperature - ambient);
  integrals_.assign(values.size(), 0.0);
  for (std::size_t i = 1; i < values.size(); ++i)
    integrals_[i] = integrals_[i - 1] + 0.5 * (values[i - 1] + values[i]) * (excesses_[i] - excesses_[i - 1]);
  const double at_air = integral(0.0);
  for (double& integral : integrals_) integral -= at_air;
}

/// Finds the line on which a number lies among those of the points.
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
