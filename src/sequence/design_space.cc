// SPDX-License-Identifier: MIT
#include "fabseq/sequence/sequence.h"

#include <algorithm>
#include <cmath>

namespace fabseq {

double DesignScale::to_unit(double design) const {
  const double unit =
      logarithmic ? std::log(design / lower) / std::log(upper / lower) : (design - lower) / (upper - lower);
  return std::clamp(unit, 0.0, 1.0);
}

double DesignScale::from_unit(double unit) const {
  const double design = logarithmic ? lower * std::pow(upper / lower, unit) : lower + unit * (upper - lower);
  return std::clamp(design, lower, upper);
}

double DesignScale::slope(double design) const {
  return logarithmic ? design * std::log(upper / lower) : upper - lower;
}

DesignSpace DesignSpace::from(std::size_t first) const {
  DesignSpace result = *this;
  std::rotate(result.components.begin(),
              result.components.begin() + static_cast<std::ptrdiff_t>(first % components.size()),
              result.components.end());
  return result;
}

}  // namespace fabseq
