// SPDX-License-Identifier: MIT
/// Even layers, and directions of planar ones (docs/formulation.md 3.3, 3.4).
#include "fabseq/base/mpi.h"
#include "fabseq/sequence/even_time.h"
#include "fabseq/sequence/given_sequence.h"
#include "fabseq/sequence/tilted_directions.h"
#include "support/small_parts.h"

#include <gtest/gtest.h>

#include <cmath>

namespace fabseq {
namespace {

TEST(EvenTimeTest, IsPlanarInABlock) {
  const test::PartOnGrid<3> on_grid(test::odd_domain<3>(), test::block<3>());
  const Part<3>& part = on_grid.part;
  const auto [time, height] = even_time(part);
  EXPECT_NEAR(height, planar_height<3>(part, {}), 1e-12);
  const PseudoTime<3> planar = planar_time(part, {});
  for (std::size_t e = 0; e < time.time.size(); ++e) EXPECT_NEAR(time.time[e], planar.time[e], 1e-12);
  for (std::size_t i = 0; i < time.gradient.size(); ++i)
    EXPECT_NEAR(time.gradient[i], planar.gradient[i], 1e-12);
}

/// A post with an arm to the right: the arm's end is as far as the way up and along it.
TEST(EvenTimeTest, FollowsAnArm) {
  const Shape shape = test::union_of({test::box({0, 0}, {1, 4}), test::box({0, 3}, {8, 4})});
  const test::PartOnGrid<2> on_grid({{8.0, 4.0}, {16, 8}, 1.0}, shape);
  const auto [time, height] = even_time(on_grid.part);
  EXPECT_GT(height, 3.0 + 7.0);
  EXPECT_LT(height, 4.0 + 7.5);
  for (std::size_t e = 0; e < time.time.size(); ++e) {
    const Point<2> x =
        on_grid.grid.element_center(on_grid.grid.owned_elements().index(on_grid.part.elements()[e]));
    if (x[0] < 3.0) continue;
    EXPECT_NEAR(height * std::hypot(time.gradient[2 * e], time.gradient[2 * e + 1]), 1.0, 0.06);
    EXPECT_GT(time.gradient[2 * e], 0.0);
  }
}

TEST(TiltedDirectionsTest, LeanFromTheNormalByEqualSteps) {
  const auto flat = tilted_directions<2>({1, false}, 40.0);
  ASSERT_EQ(flat.size(), 7U);  // the normal, three steps to both sides
  EXPECT_EQ(flat[0].tilt, 0.0);
  EXPECT_NEAR(flat.back().tilt, 40.0, 1e-12);
  const auto solid = tilted_directions<3>({0, true}, 30.0);
  ASSERT_EQ(solid.size(), 17U);
  for (const auto& [direction, tilt] : solid) {
    EXPECT_NEAR(dot(direction, direction), 1.0, 1e-12);
    EXPECT_NEAR(-direction[0], std::cos(tilt * M_PI / 180.0), 1e-12);
  }
  EXPECT_EQ(tilted_directions<3>({2, false}, 0.0).size(), 1U);
}

}  // namespace
}  // namespace fabseq
