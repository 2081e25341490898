// SPDX-License-Identifier: MIT
/// What conjugate gradients tell of a spectrum that is known.
#include "cg/spectrum_estimate.h"

#include "support/small_parts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace fabseq {
namespace {

/// Conjugate gradients on a diagonal matrix; the estimates before and after each step.
std::vector<double> estimates(const std::vector<double>& diagonal, int steps) {
  SpectrumEstimate spectrum;
  std::vector<double> result = {spectrum.smallest()}, rest, direction(diagonal.size(), 0.0);
  for (std::size_t i = 0; i < diagonal.size(); ++i) rest.push_back(0.5 + test::noise(i));
  double last = 0.0;
  for (int step = 0; step < steps; ++step) {
    double square = 0.0, energy = 0.0;
    for (const double value : rest) square += value * value;
    const double beta = step > 0 ? square / last : 0.0;
    last = square;
    for (std::size_t i = 0; i < rest.size(); ++i) {
      direction[i] = rest[i] + beta * direction[i];
      energy += diagonal[i] * direction[i] * direction[i];
    }
    const double alpha = square / energy;
    for (std::size_t i = 0; i < rest.size(); ++i) rest[i] -= alpha * diagonal[i] * direction[i];
    spectrum.add(alpha, beta);
    result.push_back(spectrum.smallest());
  }
  return result;
}

TEST(SpectrumEstimateTest, IsOneBeforeTheFirstStep) { EXPECT_EQ(SpectrumEstimate().smallest(), 1.0); }

/// As many steps as there are eigenvalues: nothing is left to estimate.
TEST(SpectrumEstimateTest, FindsTheSmallestEigenvalue) {
  for (const double smallest : {0.9, 0.1, 1e-4}) {
    const std::vector<double> diagonal = {1.0, smallest, 1.2, 0.95, 2.0};
    EXPECT_NEAR(estimates(diagonal, 5).back() / smallest, 1.0, 1e-6);
  }
}

TEST(SpectrumEstimateTest, FallsTowardsIt) {
  std::vector<double> diagonal;
  for (int i = 0; i < 200; ++i) diagonal.push_back(0.02 + 1.3 * test::noise(i));
  const auto found = estimates(diagonal, 40);
  const double smallest = *std::min_element(diagonal.begin(), diagonal.end());
  for (std::size_t step = 2; step < found.size(); ++step) {
    EXPECT_LE(found[step], found[step - 1] * (1.0 + 1e-9));
    EXPECT_GE(found[step], smallest * (1.0 - 1e-9));
  }
  EXPECT_LT(found.back(), 1.2 * smallest);
}

/// Steps of a lane that rests, or that broke down.
TEST(SpectrumEstimateTest, StepsOfNoLengthDoNotCount) {
  SpectrumEstimate spectrum;
  for (const double alpha : {0.0, -1.0, static_cast<double>(NAN)}) spectrum.add(alpha, 0.5);
  EXPECT_EQ(spectrum.smallest(), 1.0);
  spectrum.add(4.0, 0.5);
  EXPECT_NEAR(spectrum.smallest(), 0.25, 1e-9);
}

}  // namespace
}  // namespace fabseq
