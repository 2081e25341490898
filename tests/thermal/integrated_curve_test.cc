// SPDX-License-Identifier: MIT
#include "fabseq/thermal/integrated_curve.h"

#include <gtest/gtest.h>

#include <cmath>

namespace fabseq {
namespace {

constexpr double ambient = 120.0;  ///< between two points of the table
const IntegratedCurve curve({20.0, 100.0, 300.0, 700.0}, {2.0, 2.0, 0.5, 3.0}, ambient);

TEST(IntegratedCurveTest, IsLinearBetweenPointsAndConstantBeyond) {
  EXPECT_DOUBLE_EQ(curve.value(-500.0), 2.0);
  EXPECT_DOUBLE_EQ(curve.value(200.0 - ambient), 1.25);
  EXPECT_DOUBLE_EQ(curve.value(300.0 - ambient), 0.5);
  EXPECT_DOUBLE_EQ(curve.value(5000.0), 3.0);
}

TEST(IntegratedCurveTest, IntegratesFromTheAirsTemperature) {
  EXPECT_EQ(curve.integral(0.0), 0.0);
  EXPECT_DOUBLE_EQ(curve.integral(1e-20), 1.85e-20);
  EXPECT_DOUBLE_EQ(curve.integral(300.0 - ambient), 0.5 * 180.0 * (1.85 + 0.5));
  EXPECT_DOUBLE_EQ(curve.integral(-220.0), -(0.5 * 20.0 * (1.85 + 2.0) + 200.0 * 2.0));
  EXPECT_NEAR(curve.integral(800.0 - ambient) - curve.integral(700.0 - ambient), 300.0, 1e-12);
}

TEST(IntegratedCurveTest, FindsTheExcessOfAnIntegral) {
  for (const double excess : {-1000.0, -50.0, 0.0, 10.0, 180.0, 400.0, 580.0, 3000.0})
    EXPECT_NEAR(curve.excess_of(curve.integral(excess)), excess, 1e-12 * (1.0 + std::abs(excess)));
}

TEST(IntegratedCurveTest, IsOneWithoutValues) {
  const IntegratedCurve none({20.0, 100.0}, {}, ambient);
  EXPECT_TRUE(none.is_one());
  EXPECT_EQ(none.value(7.0), 1.0);
  EXPECT_EQ(none.integral(7.0), 7.0);
  EXPECT_EQ(none.excess_of(7.0), 7.0);
}

}  // namespace
}  // namespace fabseq
