// SPDX-License-Identifier: MIT
#include "process/material_curves.h"

#include <algorithm>
#include <cstddef>
#include <limits>

namespace fabseq {

MaterialCurves::MaterialCurves(const MaterialSettings& material)
    : temperatures_(material.temperatures),
      young_(material.young_factors),
      yield_(material.yield_factors),
      elongations_(material.elongations),
      cut_off_(material.cut_off.value_or(std::numeric_limits<double>::infinity())) {}

double MaterialCurves::elongation(double temperature) const {
  return at(elongations_, std::min(temperature, cut_off_), 0.0);
}

double MaterialCurves::at(const std::vector<double>& values, double temperature, double none) const {
  if (values.empty()) return none;
  const auto above = std::ranges::upper_bound(temperatures_, temperature);
  if (above == temperatures_.begin()) return values.front();
  if (above == temperatures_.end()) return values.back();
  const auto i = static_cast<std::size_t>(above - temperatures_.begin());
  const double share = (temperature - temperatures_[i - 1]) / (temperatures_[i] - temperatures_[i - 1]);
  return values[i - 1] + share * (values[i] - values[i - 1]);
}

double MaterialCurves::slope(const std::vector<double>& values, double temperature) const {
  if (values.empty()) return 0.0;
  const auto above = std::ranges::upper_bound(temperatures_, temperature);
  if (above == temperatures_.begin() || above == temperatures_.end()) return 0.0;
  const auto i = static_cast<std::size_t>(above - temperatures_.begin());
  return (values[i] - values[i - 1]) / (temperatures_[i] - temperatures_[i - 1]);
}

}  // namespace fabseq
