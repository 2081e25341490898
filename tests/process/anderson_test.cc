// SPDX-License-Identifier: MIT
/// Anderson's method against a linear system, which it solves in as many steps as the method of minimal
/// residuals.
#include "process/anderson.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace fabseq {
namespace {

constexpr std::size_t size = 5000;

/// Entries along which x <- x + z contracts by one of four factors, some of them negative or beyond 1.
std::vector<double> step_at(const std::vector<double>& x) {
  constexpr double factors[] = {0.2, 0.9, -0.5, 2.5};
  std::vector<double> result(size);
  for (std::size_t i = 0; i < size; ++i)
    result[i] = factors[i % 4] * (std::sin(static_cast<double>(i)) - x[i]);
  return result;
}

TEST(AndersonTest, EndsSoonBehindAsManyStepsAsThereAreFactors) {
  const std::vector<float> weights(size, 0.5F);
  Anderson anderson(MPI_COMM_SELF, 6);
  anderson.start(weights);
  std::vector<double> x(size, 0.0);
  double first = 0.0, last = 0.0;
  for (int sweep = 0; sweep < 9; ++sweep) {
    const Anderson::Norms norms = anderson.advance(x, step_at(x));
    if (sweep == 0) first = norms.step;
    last = norms.step;
  }
  EXPECT_LT(last, 1e-6 * first);
  for (std::size_t i = 0; i < size; ++i) EXPECT_NEAR(x[i], std::sin(static_cast<double>(i)), 1e-5);
}

TEST(AndersonTest, NormsAreWeighted) {
  std::vector<float> weights(size, 0.0F);
  weights[3] = 4.0F;
  Anderson anderson(MPI_COMM_SELF, 2);
  anderson.start(weights);
  std::vector<double> x(size, 1.0);
  const Anderson::Norms norms = anderson.advance(x, std::vector<double>(size, 2.0));
  EXPECT_DOUBLE_EQ(norms.step, 4.0);
  EXPECT_DOUBLE_EQ(norms.x, 6.0);
}

TEST(AndersonTest, RanksWithoutEntriesTakePart) {
  Anderson anderson(MPI_COMM_SELF, 2);
  anderson.start({});
  std::vector<double> x;
  for (int sweep = 0; sweep < 3; ++sweep) EXPECT_EQ(anderson.advance(x, {}).step, 0.0);
}

}  // namespace
}  // namespace fabseq
