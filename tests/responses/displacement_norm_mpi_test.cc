// SPDX-License-Identifier: MIT
/// Norm of the displacement (formulation 5): from the mean square to the largest displacement, whatever its
/// size.
#include "fabseq/base/mpi.h"
#include "support/measure_case.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace fabseq {
namespace {

std::string norm(double power) { return R"("nodes": "tip", "norm": )" + std::to_string(power); }

template <class T>
class DisplacementNormTest : public testing::Test {
 protected:
  static constexpr int dim = T::value;
  using Case = test::MeasureCase<dim>;
};
TYPED_TEST_SUITE(DisplacementNormTest, test::Dimensions);

TYPED_TEST(DisplacementNormTest, OfPowerTwoIsTheMean) {
  typename TestFixture::Case measures;
  const auto u = measures.rough_displacement(0.01);
  const double mean = measures.value(*measures.make(R"("nodes": "tip", "mean": true)"), u);
  EXPECT_NEAR(measures.value(*measures.make(norm(2.0)), u), mean, 1e-13 * mean);
}

TYPED_TEST(DisplacementNormTest, OfHighPowerIsTheLargest) {
  constexpr int Dim = TypeParam::value;
  typename TestFixture::Case measures;
  const auto u = measures.rough_displacement(0.01);
  const NodeSet& tip = measures.pipeline.setup.node_sets.at("tip");
  double largest = 0.0;
  for (const int node : tip.owned) {
    double square = 0.0;
    for (int a = 0; a < Dim; ++a) square += std::pow(u[static_cast<std::size_t>(node) * Dim + a], 2);
    largest = std::max(largest, square);
  }
  largest = max(PETSC_COMM_WORLD, largest);
  double before = 0.0;
  for (const double power : {2.0, 8.0, 60.0, 1e4}) {
    const double value = measures.value(*measures.make(norm(power)), u);
    EXPECT_GT(value, before);
    EXPECT_LE(value, largest * (1.0 + 1e-12));
    EXPECT_GE(value, largest * std::pow(static_cast<double>(tip.count), -2.0 / power) * (1.0 - 1e-12));
    before = value;
  }
}

TYPED_TEST(DisplacementNormTest, NeitherOverflowsNorVanishes) {
  typename TestFixture::Case measures;
  const auto response = measures.make(norm(12.0));
  const double expected = measures.value(*response, measures.rough_displacement(1.0));
  for (const double size : {1e-140, 1e140}) {
    const auto u = measures.rough_displacement(size);
    EXPECT_NEAR(measures.value(*response, u) / size / size, expected, 1e-12 * expected);
  }
  const auto nothing = measures.rough_displacement(0.0);
  EXPECT_EQ(measures.value(*response, nothing), 0.0);
  const auto derivative = measures.derivative(*response, nothing).displacement;
  ASSERT_EQ(derivative.size(), nothing.size());
  EXPECT_EQ(test::largest(derivative), 0.0);
}

TYPED_TEST(DisplacementNormTest, DerivativesAgreeWithDifferences) {
  typename TestFixture::Case measures;
  for (const double power : {2.0, 3.5, 8.0})
    EXPECT_LT(
        measures.error_of_derivative(*measures.make(norm(power)), measures.rough_displacement(0.01), 1e-6),
        1e-7)
        << power;
}

TYPED_TEST(DisplacementNormTest, HasNoFunctionals) {
  typename TestFixture::Case measures;
  EXPECT_FALSE(measures.make(norm(8.0))->squares(TermScaling::current));
}

}  // namespace
}  // namespace fabseq
