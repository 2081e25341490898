// SPDX-License-Identifier: MIT
/// Elements across the thinnest wall, on 1 to 4 ranks.
#include "fabseq/part/wall_thickness.h"
#include "support/small_parts.h"

#include <gtest/gtest.h>

#include <cmath>

namespace fabseq {
namespace {

using test::box;

/// 24 x 6 x 16 unit cubes from a corner that is not the origin.
const Domain<3> domain{{24.0, 6.0, 16.0}, {24, 6, 16}, 1.0, {100.0, 10.0, 0.0}};
const BuildPlate bottom{2, false};

Shape block(Point<3> low, Point<3> high) {
  for (int axis = 0; axis < 3; ++axis) {
    low[axis] += domain.origin[axis];
    high[axis] += domain.origin[axis];
  }
  return box({low.begin(), low.end()}, {high.begin(), high.end()});
}

Shape together(std::vector<Shape> shapes) {
  Shape result;
  result.kind = Shape::Kind::union_of;
  result.operands = std::move(shapes);
  return result;
}

ThinWall<3> thinnest(const Shape& shape) {
  const test::PartOnGrid<3> on_grid(domain, shape, bottom);
  return thinnest_wall(on_grid.part);
}

TEST(WallThicknessTest, SeesNoWallInABlock) {
  EXPECT_EQ(thinnest(block({0, 0, 0}, {24, 6, 16})).elements, thick_wall);
}

TEST(WallThicknessTest, CountsElementsOfAWall) {
  for (const int thickness : {3, 4}) {
    const Shape base = block({0, 0, 0}, {24, 6, 6}), wall = block({10, 0, 6}, {10.0 + thickness, 6, 16});
    const ThinWall<3> found = thinnest(together({base, wall}));
    EXPECT_EQ(found.elements, thickness);
    EXPECT_GT(found.at[2], 6.0);
    EXPECT_NEAR(found.at[0], 110.0 + 0.5 * thickness, 0.51);
  }
}

TEST(WallThicknessTest, SaysLessThanThreeOfThinnerOnes) {
  for (const int thickness : {1, 2}) {
    const ThinWall<3> found =
        thinnest(together({block({0, 0, 0}, {24, 6, 6}), block({10, 0, 6}, {10.0 + thickness, 6, 16})}));
    EXPECT_LE(found.elements, 1.01 * thickness);
    EXPECT_GE(found.elements, 0.99 * thickness);
    EXPECT_GT(found.at[2], 6.0);
  }
}

/// A wall that leans by 45 degrees: across it there are steps of the square root of two.
TEST(WallThicknessTest, MeasuresAcrossALeaningWall) {
  const auto half_space = [](double x, double sign) {
    Shape shape;
    shape.kind = Shape::Kind::half_space;
    shape.first = {x, 10.0, 0.0};
    shape.second = {sign, 0.0, -sign};
    return shape;
  };
  Shape wall;
  wall.kind = Shape::Kind::intersection;
  wall.operands = {half_space(104.2, -1.0), half_space(109.2, 1.0)};
  const double found = thinnest(wall).elements;
  EXPECT_NEAR(found, 5.0 / std::sqrt(2.0), 0.8);
}

TEST(WallThicknessTest, CountsTheSubstrateIn) {
  PartDescription description{block({0, 0, 1}, {24, 6, 3}), false};
  description.substrate = block({0, 0, 0}, {24, 6, 1});
  const test::PartOnGrid<3> on_grid(domain, description, bottom);
  EXPECT_EQ(thinnest_wall(on_grid.part).elements, 3.0);
}

}  // namespace
}  // namespace fabseq
