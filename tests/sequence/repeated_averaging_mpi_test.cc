// SPDX-License-Identifier: MIT
/// Smoothing of direct designs (formulation 2.3).
#include "fabseq/base/mpi.h"
#include "fabseq/sequence/start_region.h"
#include "sequence/repeated_averaging.h"
#include "support/heat_case.h"
#include "support/small_parts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace fabseq {
namespace {

template <int Dim>
struct Case {
  explicit Case(DesignLocation location)
      : region(make_start_region(on_grid.part, location, std::nullopt)),
        support(on_grid.grid, location == DesignLocation::nodes, region.free) {}

  std::vector<double> noise(int salt) const {
    std::vector<double> result;
    for (std::size_t i = 0; i < support.size(); ++i) result.push_back(test::noise(support.number(i), salt));
    return result;
  }
  double product(const std::vector<double>& a, const std::vector<double>& b) const { return test::dot(a, b); }

  test::PartOnGrid<Dim> on_grid{test::odd_domain<Dim>(), test::gallows<Dim>()};
  StartRegion region;
  DesignSupport<Dim> support;
};

template <class T>
class RepeatedAveragingTest : public testing::Test {};
TYPED_TEST_SUITE(RepeatedAveragingTest, test::Dimensions);

constexpr DesignLocation both[] = {DesignLocation::elements, DesignLocation::nodes};

TYPED_TEST(RepeatedAveragingTest, NoRadiusNoChange) {
  constexpr int Dim = TypeParam::value;
  for (const DesignLocation location : both) {
    const Case<Dim> direct(location);
    const RepeatedAveraging<Dim> filter(direct.on_grid.part, direct.support, 0.0);
    EXPECT_EQ(filter.passes(), 0);
    EXPECT_EQ(filter.apply(direct.noise(1)), direct.noise(1));
    EXPECT_EQ(filter.apply_transpose(direct.noise(1)), direct.noise(1));
  }
}

/// Means: between the smallest and the largest value, among which is the start region's 0; a constant falls
/// towards it only.
TYPED_TEST(RepeatedAveragingTest, StaysWithinTheValuesAndFallsTowardsTheStart) {
  constexpr int Dim = TypeParam::value;
  for (const DesignLocation location : both) {
    const Case<Dim> direct(location);
    const MPI_Comm comm = direct.on_grid.grid.comm();
    const RepeatedAveraging<Dim> filter(direct.on_grid.part, direct.support, 1.2);
    ASSERT_GT(filter.passes(), 1);
    const std::vector<double> smoothed = filter.apply(std::vector<double>(direct.support.size(), 1.0));
    double least = 2.0, largest = -1.0;
    for (const double value : smoothed) {
      least = std::min(least, value);
      largest = std::max(largest, value);
    }
    EXPECT_LT(min(comm, least), 0.9);
    EXPECT_GT(min(comm, least), 0.0);
    EXPECT_NEAR(max(comm, largest), 1.0, 1e-3);
    EXPECT_LE(max(comm, largest), 1.0 + 1e-14);
  }
}

/// y'Fx = x'F'y, over all ranks.
TYPED_TEST(RepeatedAveragingTest, Transpose) {
  constexpr int Dim = TypeParam::value;
  for (const DesignLocation location : both) {
    const Case<Dim> direct(location);
    const RepeatedAveraging<Dim> filter(direct.on_grid.part, direct.support, 0.9);
    const auto x = direct.noise(2), y = direct.noise(3);
    const double there = test::dot(y, filter.apply(x)), back = test::dot(x, filter.apply_transpose(y));
    EXPECT_NEAR(there, back, 1e-12 * std::abs(there));
  }
}

}  // namespace
}  // namespace fabseq
