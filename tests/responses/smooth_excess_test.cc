// SPDX-License-Identifier: MIT
/// The smooth excess and its slope, near the limit and far from it (formulation 13.2).
#include "responses/smooth_excess.h"

#include <gtest/gtest.h>

namespace fabseq {
namespace {

/// The formula as it stands, in a precision in which nothing cancels: log2(1 + ln(1 + e^x) / ln 2).
TEST(SmoothExcessTest, IsItsFormula) {
  const long double ln2 = std::log(2.0L);
  for (const double x : {-700.0, -60.0, -40.001, -39.999, -20.0, -12.001, -11.999, -8.0, -1.0, -1e-9, 0.0,
                         1e-9, 1.0, 39.0, 800.0}) {
    const long double power = std::exp(static_cast<long double>(x)), plus = std::log1p(power) / ln2;
    const SmoothExcess excess(x);
    EXPECT_NEAR(excess.value / static_cast<double>(std::log1p(plus) / ln2), 1.0, 1e-14) << x;
    EXPECT_NEAR(excess.slope / static_cast<double>(power / (1 + power) / ((1 + plus) * ln2 * ln2)), 1.0,
                1e-14)
        << x;
  }
}

}  // namespace
}  // namespace fabseq
