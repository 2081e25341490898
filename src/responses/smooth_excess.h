// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/responses/response.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace fabseq {

/// How much something counts that is x beyond a limit, in units of the sharpness: log2(1 + ln(1 + e^x) / ln
/// 2). It is 1 at the limit, grows with the logarithm of x beyond it, and falls exponentially before it. So a
/// mean over the part is no less than the share of the part that is beyond, and places that cannot be mended
/// do not hide the others (docs/formulation.md 13.2).
struct SmoothExcess {
  explicit SmoothExcess(double x) {
    constexpr double ln2 = std::numbers::ln2;
    const double small = std::exp(-std::abs(x));
    if (x < -series) {  // as most places are; both logarithms by their first terms
      const double inner = small * (1.0 - small * (0.5 - small / 3.0)), plus = inner / ln2;
      value = plus * (1.0 - plus * (0.5 - plus / 3.0)) / ln2;
      slope = small / ((1.0 + small) * (1.0 + plus) * ln2 * ln2);
      return;
    }
    const double plus = (std::max(x, 0.0) + std::log1p(small)) / ln2;
    value = std::log1p(plus) / ln2;
    slope = (x < 0.0 ? small : 1.0) / ((1.0 + small) * (1.0 + plus) * ln2 * ln2);
  }

  double value, slope;

 private:
  static constexpr double series = 12.0;  ///< e^-3x is less than rounding of 1
};

/// Upper bound of a mean of excesses. Its logarithm is bounded: the means range over orders of magnitude.
/// `limit`: none: it adapts, beginning with `first`.
inline ConstraintRow excess_bound(const std::optional<double>& limit, double first, double margin) {
  return {.bound = margin * limit.value_or(first), .logarithmic = true, .adapts = !limit};
}

}  // namespace fabseq
