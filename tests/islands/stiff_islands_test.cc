// SPDX-License-Identifier: MIT
/// Islands of stiffness fields that are drawn by hand.
#include "islands/island_map.h"
#include "support/islands.h"
#include "support/masked_grid.h"
#include "support/small_parts.h"

#include <gtest/gtest.h>

#include <limits>
#include <utility>
#include <vector>

namespace fabseq {
namespace {

/// Islands of a field on one rank, and which each node is on; -1: none.
struct Found {
  int count = 0;
  std::vector<int> node_island;
};

/// `field`: of each element of the box; those of the lowest layer are supported.
template <int Dim>
Found find(const Index<Dim>& elements, const std::vector<double>& field, double contrast = 100.0,
           int most = 8) {
  const test::Mask<Dim> full = test::masks<Dim>()[0];
  const test::MaskedGrid<Dim> masked(PETSC_COMM_SELF, elements, full, {Dim - 1, false});
  const LaneHierarchy<Dim> hierarchy(masked.grid, masked.domain);
  const LaneIslands islands = IslandMap<Dim>(hierarchy.level(0)).find(field, 1, contrast, most)[0];
  Found found{islands.count, std::vector<int>(static_cast<std::size_t>(masked.whole.nodes.count()), -1)};
  for (const auto& node : islands.nodes) found.node_island[node.node] = node.island;
  return found;
}

template <int Dim>
Found found_in(const test::Islands<Dim>& islands, double contrast = 100.0, int most = 8) {
  return find<Dim>(islands.elements, islands.field(), contrast, most);
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
  const Found found = found_in(islands);
  ASSERT_EQ(found.count, 2);
  all_nodes(islands).for_each([&](const Index<Dim>& node, std::int64_t offset) {
    EXPECT_EQ(found.node_island[offset], islands.block_at(node)) << to_text<Dim>(node);
  });
}

TYPED_TEST(StiffIslandsTest, OnlyTheLargestCount) {
  constexpr int Dim = TypeParam::value;
  const auto islands = test::two_islands<Dim>();
  const Found found = found_in(islands, 100.0, 1);
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
  const Found found = found_in(islands);
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
    const Found found = find<Dim>(islands.elements, field);
    EXPECT_EQ(found.count, bridge < 0.01 ? 2 : 1) << bridge;
  }
}

TYPED_TEST(StiffIslandsTest, UniformFieldsHaveNone) {
  constexpr int Dim = TypeParam::value;
  auto islands = test::two_islands<Dim>();
  for (const double value : {1.0, 1e-9, 0.0}) {
    const std::vector<double> field(islands.field().size(), value);
    EXPECT_EQ(find<Dim>(islands.elements, field).count, 0);
  }
}

/// Elements that are not there separate nothing from the plate: an island needs soft surroundings to move in.
TYPED_TEST(StiffIslandsTest, NothingAroundIsAsGoodAsSoft) {
  constexpr int Dim = TypeParam::value;
  const auto islands = test::two_islands<Dim>();
  auto field = islands.field();
  for (double& value : field)
    if (value == test::soft && test::noise(&value - field.data()) < 0.3) value = 0.0;
  const Found found = find<Dim>(islands.elements, field);
  EXPECT_EQ(found.count, 2);
}

/// What is no number, or no stiffness, counts as nothing there, and infinity as a large number.
TYPED_TEST(StiffIslandsTest, WhatIsNoNumberDoesNoHarm) {
  constexpr int Dim = TypeParam::value;
  const auto islands = test::two_islands<Dim>();
  const auto found_with = [&](double value) {
    auto field = islands.field();
    for (std::size_t i = 0; i < field.size(); i += 11) field[i] = value;
    return find<Dim>(islands.elements, field, 100.0, static_cast<int>(field.size()));
  };
  const double infinity = std::numeric_limits<double>::infinity();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const auto& [spoiled, equivalent] :
       {std::pair(nan, 0.0), std::pair(-1.0, 0.0), std::pair(infinity, 1e300)}) {
    const Found found = found_with(spoiled), expected = found_with(equivalent);
    EXPECT_GE(expected.count, 2);
    EXPECT_EQ(found.count, expected.count) << spoiled;
    EXPECT_EQ(found.node_island, expected.node_island) << spoiled;
  }
}

}  // namespace
}  // namespace fabseq
