// SPDX-License-Identifier: MIT
/// Islands of stiffness fields that are drawn by hand.
#include "fabseq/lanes/stiff_islands.h"

#include <gtest/gtest.h>

#include "support/islands.h"
#include "support/small_parts.h"
#include <limits>
#include <utility>
#include <vector>

namespace fabseq {
namespace {

template <int Dim>
StiffIslands found_in(const test::Islands<Dim>& islands, double contrast = 100.0, int most = 8) {
  return find_stiff_islands<Dim>(islands.elements, islands.field(), islands.supported(), contrast, most);
}
template <int Dim>
IndexBox<Dim> all_nodes(const test::Islands<Dim>& islands) {
  IndexBox<Dim> nodes{{}, islands.elements};
  for (int& extent : nodes.size) ++extent;
  return nodes;
}

template <class T>
class StiffIslandsTest : public testing::Test {};
TYPED_TEST_SUITE(StiffIslandsTest, test::Dimensions);

TYPED_TEST(StiffIslandsTest, AreBlocksThatDoNotStandOnThePlate) {
  constexpr int Dim = TypeParam::value;
  const auto islands = test::two_islands<Dim>();
  const StiffIslands found = found_in(islands);
  ASSERT_EQ(found.count, 2);
  all_nodes(islands).for_each([&](const Index<Dim>& node, std::int64_t offset) {
    EXPECT_EQ(found.node_island[offset], islands.block_at(node)) << to_text<Dim>(node);
  });
}

TYPED_TEST(StiffIslandsTest, OnlyTheLargestCount) {
  constexpr int Dim = TypeParam::value;
  const auto islands = test::two_islands<Dim>();
  const StiffIslands found = found_in(islands, 100.0, 1);
  ASSERT_EQ(found.count, 1);
  all_nodes(islands).for_each([&](const Index<Dim>& node, std::int64_t offset) {
    EXPECT_EQ(found.node_island[offset], islands.block_at(node) == 0 ? 0 : -1);
  });
}

TYPED_TEST(StiffIslandsTest, NeedContrast) {
  const auto islands = test::two_islands<TypeParam::value>();
  EXPECT_EQ(found_in(islands, 0.9 / test::soft).count, 2);
  EXPECT_EQ(found_in(islands, 1.1 / test::soft).count, 0);
}

/// Down to the plate, by a column one element thick.
TYPED_TEST(StiffIslandsTest, WhatIsConnectedToThePlateIsNone) {
  constexpr int Dim = TypeParam::value;
  auto islands = test::two_islands<Dim>();
  IndexBox<Dim> column = islands.blocks[0];
  column.size.fill(1);
  column.start[Dim - 1] = 0;
  column.size[Dim - 1] = islands.blocks[0].start[Dim - 1];
  islands.blocks.push_back(column);
  const StiffIslands found = found_in(islands);
  ASSERT_EQ(found.count, 1);
  all_nodes(islands).for_each([&](const Index<Dim>& node, std::int64_t offset) {
    EXPECT_EQ(found.node_island[offset], islands.block_at(node) == 1 ? 0 : -1);
  });
}

/// A bridge of a stiffness between: two islands if it is soft enough, else one.
TYPED_TEST(StiffIslandsTest, BridgesJoinIslands) {
  constexpr int Dim = TypeParam::value;
  const auto islands = test::two_islands<Dim>();
  const auto& first = islands.blocks[0];
  const auto& second = islands.blocks[1];
  for (const double bridge : {1e-3, 0.1}) {
    auto field = islands.field();
    Index<Dim> at = second.start;  // a line along x at the height of the second that meets the first
    const IndexBox<Dim> all{{}, islands.elements};
    for (at[0] = first.start[0] + first.size[0]; at[0] < second.start[0]; ++at[0]) {
      ASSERT_TRUE(at[0] > first.start[0] + first.size[0] || first.contains([&] {
        Index<Dim> before = at;
        --before[0];
        return before;
      }()));
      field[all.offset(at)] = bridge;
    }
    const StiffIslands found = find_stiff_islands<Dim>(islands.elements, field, islands.supported());
    EXPECT_EQ(found.count, bridge < 0.01 ? 2 : 1) << bridge;
  }
}

TYPED_TEST(StiffIslandsTest, UniformFieldsHaveNone) {
  constexpr int Dim = TypeParam::value;
  auto islands = test::two_islands<Dim>();
  for (const double value : {1.0, 1e-9, 0.0}) {
    const std::vector<double> field(islands.field().size(), value);
    EXPECT_EQ(find_stiff_islands<Dim>(islands.elements, field, islands.supported()).count, 0);
  }
}

/// Elements that are not there separate nothing from the plate: an island needs soft surroundings to move in.
TYPED_TEST(StiffIslandsTest, NothingAroundIsAsGoodAsSoft) {
  constexpr int Dim = TypeParam::value;
  const auto islands = test::two_islands<Dim>();
  auto field = islands.field();
  for (double& value : field)
    if (value == test::soft && test::noise(&value - field.data()) < 0.3) value = 0.0;
  const StiffIslands found = find_stiff_islands<Dim>(islands.elements, field, islands.supported());
  EXPECT_EQ(found.count, 2);
}

/// What is no number, or no stiffness, counts as nothing there, and infinity as a large number.
TYPED_TEST(StiffIslandsTest, WhatIsNoNumberDoesNoHarm) {
  constexpr int Dim = TypeParam::value;
  const auto islands = test::two_islands<Dim>();
  const auto found_with = [&](double value) {
    auto field = islands.field();
    for (std::size_t i = 0; i < field.size(); i += 11) field[i] = value;
    return find_stiff_islands<Dim>(islands.elements, field, islands.supported(), 100.0,
                                   static_cast<int>(field.size()));
  };
  const double infinity = std::numeric_limits<double>::infinity();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const auto& [spoiled, equivalent] :
       {std::pair(nan, 0.0), std::pair(-1.0, 0.0), std::pair(infinity, 1e300)}) {
    const StiffIslands found = found_with(spoiled), expected = found_with(equivalent);
    EXPECT_GE(expected.count, 2);
    EXPECT_EQ(found.count, expected.count) << spoiled;
    EXPECT_EQ(found.node_island, expected.node_island) << spoiled;
  }
}

}  // namespace
}  // namespace fabseq
