// SPDX-License-Identifier: MIT
/// The smooth step between stages against its formula, its exponential against std::exp (formulation 3.1).
#include "fabseq/layers/smooth_step.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace fabseq {
namespace {

TEST(SmoothStep, ExponentialAgreesWithTheStandardOne) {
  for (int i = 0; i <= 100000; ++i) {
    const double x = 7e-3 * i;
    EXPECT_NEAR(exp_of_minus(x) / std::exp(-x), 1.0, 1e-15) << x;
  }
  EXPECT_EQ(exp_of_minus(0.0), 1.0);
}

TEST(SmoothStep, ExponentialOfWhatIsBeyondItsRange) {
  for (const double x : {708.0, 1e5, 1e300, std::numeric_limits<double>::infinity()}) {
    EXPECT_GE(exp_of_minus(x), 0.0) << x;
    EXPECT_LE(exp_of_minus(x), 1e-307) << x;
  }
  EXPECT_TRUE(std::isnan(exp_of_minus(std::nan(""))));
}

TEST(SmoothStep, AgreesWithTheFormula) {
  for (const double beta : {0.3, 10.0, 300.0, 1e5})
    for (const double point : {0.04, 0.5, 0.96}) {
      const SmoothStep step(point, beta);
      const double scale = 1.0 / (std::tanh(beta * point) + std::tanh(beta * (1.0 - point)));
      for (int i = 0; i <= 1000; ++i) {
        const double time = 1e-3 * i;
        const double x = beta * (time - point);
        const double slope = beta * scale / std::pow(std::cosh(std::clamp(x, -300.0, 300.0)), 2);
        EXPECT_NEAR(step.value(time), 1.0 - (std::tanh(beta * point) + std::tanh(x)) * scale, 1e-15);
        EXPECT_NEAR(step.derivative(time), -slope, 1e-12 * slope + 1e-250) << time << ' ' << beta;
      }
      EXPECT_TRUE(std::isnan(step.value(std::nan(""))));
    }
}

/// However smooth it is: as printed, it would leave [0, 1] there.
TEST(SmoothStep, BelongsToTheFirstOrTheLastLayerBeyondTheEnds) {
  for (const double beta : {0.3, 10.0, 300.0})
    for (const double point : {0.04, 0.5, 0.96}) {
      const SmoothStep step(point, beta);
      for (const double beyond : {1e-9, 0.02, 0.7, 50.0, 1e300}) {
        EXPECT_EQ(step.value(-beyond), step.value(0.0));
        EXPECT_EQ(step.value(1.0 + beyond), step.value(1.0));
        for (const double time : {-beyond, 1.0 + beyond}) {
          EXPECT_EQ(step.derivative(time), 0.0);
          EXPECT_NEAR(step.time_point_derivative(time), 0.0, 1e-13 * beta);
        }
      }
      EXPECT_NEAR(step.value(0.0), 1.0, 1e-15);
      EXPECT_NEAR(step.value(1.0), 0.0, 1e-15);
    }
}

/// Nothing moves at the ends of the time range, where the step is 1 and 0 whatever the time point.
TEST(SmoothStep, TimePointDerivativeAgreesWithDifferences) {
  for (const double beta : {0.3, 10.0, 300.0})
    for (const double point : {0.04, 0.5, 0.96}) {
      const SmoothStep step(point, beta);
      const double h = 1e-4 / std::max(1.0, beta);
      for (int i = 0; i <= 1000; ++i) {
        const double time = 1e-3 * i;
        const auto change = [&](double by) {
          return (SmoothStep(point + by, beta).value(time) - SmoothStep(point - by, beta).value(time)) /
                 (2.0 * by);
        };
        const double expected = (4.0 * change(0.5 * h) - change(h)) / 3.0;
        EXPECT_NEAR(step.time_point_derivative(time), expected, 1e-9 * std::max(1.0, beta))
            << time << ' ' << beta;
      }
      EXPECT_NEAR(step.time_point_derivative(0.0), 0.0, 1e-13 * beta);
      EXPECT_NEAR(step.time_point_derivative(1.0), 0.0, 1e-13 * beta);
    }
}

}  // namespace
}  // namespace fabseq
