// SPDX-License-Identifier: MIT
#include "fabseq/kernels/lane_vector.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace fabseq {
namespace {

LaneVector numbered(int nodes, int components, int lanes) {
  LaneVector result(nodes, components, lanes);
  for (std::size_t i = 0; i < result.values.size(); ++i) result.values[i] = static_cast<double>(i) + 1.0;
  return result;
}

TEST(LaneVector, PicksTheValuesOfSomeNodes) {
  const LaneVector all = numbered(5, 3, 2);
  const std::vector<int> nodes = {0, 3};
  LaneVector some;
  pick(all, nodes, some);
  ASSERT_EQ(some.nodes, 2);
  ASSERT_EQ(some.components, 3);
  ASSERT_EQ(some.lanes, 2);
  for (int component = 0; component < 3; ++component)
    for (int lane = 0; lane < 2; ++lane) {
      EXPECT_EQ(some(component, lane), all(component, lane));
      EXPECT_EQ(some(3 + component, lane), all(9 + component, lane));
    }
}

TEST(LaneVector, SpreadsThemAgainWithZerosElsewhere) {
  const LaneVector all = numbered(6, 2, 4);
  for (const std::vector<int>& nodes : {std::vector<int>{}, {2}, {0, 5}, {0, 1, 2, 3, 4, 5}}) {
    LaneVector some, spread_again = numbered(6, 2, 4);
    pick(all, nodes, some);
    spread(some, nodes, 6, spread_again);
    for (int node = 0; node < 6; ++node)
      for (int component = 0; component < 2; ++component)
        for (int lane = 0; lane < 4; ++lane) {
          const bool picked = std::find(nodes.begin(), nodes.end(), node) != nodes.end();
          EXPECT_EQ(spread_again(node * 2 + component, lane), picked ? all(node * 2 + component, lane) : 0.0);
        }
  }
}

}  // namespace
}  // namespace fabseq
