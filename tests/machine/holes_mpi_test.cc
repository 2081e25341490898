// SPDX-License-Identifier: MIT
/// What no sequence within the tilt can carry (docs/formulation.md 13.6), on 1 to 4 ranks.
#include "fabseq/machine/footing.h"
#include "fabseq/machine/holes.h"
#include "support/small_parts.h"
#include "support/whole_field.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace fabseq {
namespace {

using test::box;
using test::PartOnGrid;

/// Two legs and a beam across them, 2 high, of unit cubes: a portal with that much room below.
Shape portal(double room) {
  return test::union_of(
      {box({0, 0, 0}, {3, 4, 8}), box({3 + room, 0, 0}, {6 + room, 4, 8}), box({0, 0, 6}, {6 + room, 4, 8})});
}
PartOnGrid<3> portal_on_grid(int room) {
  return PartOnGrid<3>({{6.0 + room, 4.0, 8.0}, {6 + room, 4, 8}, 1.0}, portal(room));
}

/// What nothing within 20 degrees carries, the only such place.
UncarriedPlace<3> only_place(const Part<3>& part, double bridge) {
  ToolSettings tool;
  tool.max_tilt = 20.0;
  tool.bridge = bridge;
  const auto found = find_uncarried(part, tool);
  EXPECT_EQ(found.size(), 1U);
  return found.empty() ? UncarriedPlace<3>{} : found.front();
}

TEST(HolesTest, ARoofWiderThanABeadBridgesIsNamedWithWhatItCloses) {
  const PartOnGrid<3> on_grid = portal_on_grid(8);
  const UncarriedPlace<3> found = only_place(on_grid.part, 3.0);
  EXPECT_TRUE(found.is_roof);
  // An element at either end leans out from its leg, one more in the row above.
  EXPECT_EQ(found.elements, 4 * (6 + 4));
  EXPECT_EQ(found.lower, (Point<3>{4, 0, 6}));
  EXPECT_EQ(found.upper, (Point<3>{10, 4, 8}));
  EXPECT_DOUBLE_EQ(found.span, 4.0);  // along y, which is shorter
  EXPECT_EQ(found.hole_lower, (Point<3>{3, 0, 0}));
  EXPECT_EQ(found.hole_upper, (Point<3>{11, 4, 6}));
}

TEST(HolesTest, NarrowRoofsAreBridgedAndTiltedLayersCarryAll) {
  ToolSettings tool;
  tool.max_tilt = 20.0;
  tool.bridge = 4.0;
  EXPECT_TRUE(find_uncarried(portal_on_grid(8).part, tool).empty());
  tool.bridge = 3.9;
  EXPECT_EQ(find_uncarried(portal_on_grid(8).part, tool).size(), 1U);
  tool.bridge.reset();
  tool.bead_width = 1.0;
  EXPECT_DOUBLE_EQ(bridged_span(portal_on_grid(8).part, tool), 2.0);
  tool.max_tilt = 60.0;
  EXPECT_TRUE(find_uncarried(portal_on_grid(8).part, tool).empty());
  tool.max_tilt = 20.0;
  tool.axis = {0, 0, 1};
  EXPECT_TRUE(find_uncarried(portal_on_grid(8).part, tool).empty());
}

TEST(HolesTest, WhatHangsOutIsNoRoof) {
  const PartOnGrid<3> on_grid({{9.0, 4.0, 6.0}, {9, 4, 6}, 1.0},
                              test::union_of({box({0, 0, 0}, {3, 4, 6}), box({3, 0, 4}, {9, 4, 6})}));
  const UncarriedPlace<3> found = only_place(on_grid.part, 1.0);
  EXPECT_FALSE(found.is_roof);
}

TEST(HolesTest, CountsWhatASearchOfTheWholeGridCounts) {
  // Random cubes on a plate: what chains of feet within the tilt join to it, step by step on every rank.
  const Index<3> size{9, 8, 7};
  std::mt19937 random(7);
  std::vector<Shape> cubes = {box({0, 0, 0}, {9, 8, 1})};
  for (int i = 0; i < 60; ++i) {
    const double x = random() % 8, y = random() % 7, z = random() % 6;
    cubes.push_back(box({x, y, z}, {x + 1 + random() % 2, y + 1, z + 1 + random() % 2}));
  }
  PartDescription description{test::union_of(cubes)};
  description.keep_connected = true;
  description.announce = false;
  const Grid<3> grid(PETSC_COMM_WORLD, {{9.0, 8.0, 7.0}, size, 1.0}, {});
  const Part<3> part(grid, description, {2, false});
  const std::vector<double> solid = test::whole_element_field(grid, part.density());
  ToolSettings tool;
  tool.bridge = 0.0;
  for (const double tilt : {5.0, 20.0, 35.0}) {
    tool.max_tilt = tilt;
    const Footing<3> footing(grid, 0.0);
    std::vector<Index<3>> steps;
    for (const Index<3>& step : footing.steps())
      for (int i = 0; i <= 40; ++i)
        for (int k = 0; k < 144; ++k) {
          const double lean = tilt * i / 40 * std::numbers::pi / 180.0, around = k * std::numbers::pi / 72;
          const Point<3> direction{std::sin(lean) * std::cos(around), std::sin(lean) * std::sin(around),
                                   std::cos(lean)};
          if (footing.holds(step, direction.data())) steps.push_back(step);
        }
    const IndexBox<3> all = grid.all_elements();
    std::vector<char> carried(solid.size(), 0);
    for (bool changed = true; changed;) {
      changed = false;
      all.for_each([&](const Index<3>& element, std::int64_t offset) {
        if (solid[offset] == 0.0 || carried[offset] != 0) return;
        for (const Index<3>& step : steps) {
          const Index<3> below{element[0] + step[0], element[1] + step[1], element[2] + step[2]};
          if (below[2] >= 0 && !(all.contains(below) && carried[all.offset(below)] != 0)) continue;
          carried[offset] = 1;
          changed = true;
          return;
        }
      });
    }
    std::int64_t expected = 0, counted = 0;
    for (std::size_t e = 0; e < solid.size(); ++e) expected += solid[e] > 0.0 && carried[e] == 0 ? 1 : 0;
    for (const auto& place : find_uncarried(part, tool)) counted += place.elements;
    EXPECT_EQ(counted, expected) << tilt;
    EXPECT_GT(expected, 0);
  }
}

TEST(HolesTest, StockFillsThem) {
  PartDescription description{portal(8)};
  description.stock = box({3, 0, 0}, {11, 4, 6});
  const Grid<3> grid(PETSC_COMM_WORLD, {{14.0, 4.0, 8.0}, {14, 4, 8}, 1.0}, {});
  const Part<3> part(grid, description, {2, false});
  EXPECT_EQ(part.count(), 14 * 4 * 8);
  EXPECT_DOUBLE_EQ(part.share_of_stock(), 8.0 * 6 / (14 * 8));
  ToolSettings tool;
  tool.max_tilt = 20.0;
  EXPECT_TRUE(find_uncarried(part, tool).empty());
}

}  // namespace
}  // namespace fabseq
