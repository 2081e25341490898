// SPDX-License-Identifier: MIT
#include "fabseq/sequence/sequence.h"

#include <algorithm>
#include <cmath>

namespace fabseq {

double DesignSpace::to_unit(double design) const {
  const double unit =
      logarithmic ? std::log(design / lower) / std::log(upper / lower) : (design - lower) / (upper - lower);
  return std::clamp(unit, 0.0, 1.0);
}

double DesignSpace::from_unit(double unit) const {
  const double design = logarithmic ? lower * std::pow(upper / lower, unit) : lower + unit * (upper - lower);
  return std::clamp(design, lower, upper);
}

double DesignSpace::slope(double design) const {
  return logarithmic ? design * std::log(upper / lower) : upper - lower;
}

}  // namespace fabseq
