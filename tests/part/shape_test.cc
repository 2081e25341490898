// SPDX-License-Identifier: MIT
#include "fabseq/part/shape.h"

#include "support/shapes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace fabseq {
namespace {

using test::box;
using test::combine;
using Point = std::vector<double>;

constexpr double tolerance = 1e-3;
constexpr double within = 0.9e-3, beyond = 1.1e-3;  ///< distances from the surface

Shape half_space(Point point, Point normal) {
  Shape shape;
  shape.kind = Shape::Kind::half_space;
  shape.first = std::move(point);
  shape.second = std::move(normal);
  return shape;
}

Shape cylinder(Point from, Point to, double radius) {
  Shape shape;
  shape.kind = Shape::Kind::cylinder;
  shape.first = std::move(from);
  shape.second = std::move(to);
  shape.radius = radius;
  return shape;
}

Shape sphere(Point center, double radius) {
  Shape shape;
  shape.kind = Shape::Kind::sphere;
  shape.first = std::move(center);
  shape.radius = radius;
  return shape;
}

Shape polygon(std::vector<std::array<double, 2>> points, int axis = 2) {
  Shape shape;
  shape.kind = Shape::Kind::polygon;
  shape.polygon = Polygon(std::move(points));
  shape.axis = axis;
  return shape;
}

bool holds(const Shape& shape, const Point& point, double slack = tolerance) {
  return shape.contains(point, slack);
}

/// Measure of the shape in a box, from the midpoints of a grid of cells.
double measure(const Shape& shape, const Point& low, const Point& high, int cells) {
  const std::size_t dimension = low.size();
  double cell = 1.0;
  std::int64_t total = 1, inside = 0;
  for (std::size_t i = 0; i < dimension; ++i) {
    cell *= (high[i] - low[i]) / cells;
    total *= cells;
  }
  Point point(dimension);
  for (std::int64_t number = 0; number < total; ++number) {
    std::int64_t rest = number;
    for (std::size_t i = 0; i < dimension; ++i, rest /= cells) {
      point[i] = low[i] + (static_cast<double>(rest % cells) + 0.5) * (high[i] - low[i]) / cells;
    }
    if (shape.contains(point, 0.0)) ++inside;
  }
  return static_cast<double>(inside) * cell;
}

TEST(ShapeTest, BoxIn2dAnd3d) {
  const Shape flat = box({1, 2}, {3, 2});  // an edge, as node sets have it
  EXPECT_TRUE(holds(flat, {1, 2}));
  EXPECT_TRUE(holds(flat, {2, 2 + within}));
  EXPECT_FALSE(holds(flat, {2, 2 + beyond}));
  EXPECT_TRUE(holds(flat, {3 + within, 2}));
  EXPECT_FALSE(holds(flat, {1 - beyond, 2}));
  const Shape solid = box({0, 0, 0}, {1, 2, 3});
  EXPECT_TRUE(holds(solid, {0.5, 1, 1.5}));
  EXPECT_TRUE(holds(solid, {1 + within, 2, 3 + within}));
  for (int axis = 0; axis < 3; ++axis) {
    Point point = {0.5, 1, 1.5};
    point[axis] = -beyond;
    EXPECT_FALSE(holds(solid, point)) << axis;
    point[axis] = axis + 1 + beyond;
    EXPECT_FALSE(holds(solid, point)) << axis;
  }
}

TEST(ShapeTest, HalfSpaceMeasuresAlongTheUnitNormal) {
  const double root = std::sqrt(0.5);
  for (const double length : {1e-4, 1.0, 50.0}) {
    const Shape plane = half_space({1, 0}, {-length, length});  // keeps x - 1 >= y
    EXPECT_TRUE(holds(plane, {2, 0}));
    EXPECT_FALSE(holds(plane, {0, 0}));
    EXPECT_TRUE(holds(plane, {1 - within * root, within * root}));
    EXPECT_FALSE(holds(plane, {1 - beyond * root, beyond * root}));
  }
  const Shape solid = half_space({1, 0, 0}, {-1, 0, 1});
  EXPECT_TRUE(holds(solid, {1.5, 77, 0.5}));
  EXPECT_FALSE(holds(solid, {1.5, 77, 0.51}));
}

TEST(ShapeTest, SphereAndDisc) {
  const Shape disc = sphere({1, 1}, 0.5);
  EXPECT_TRUE(holds(disc, {1.3, 1.4}));  // 3-4-5
  EXPECT_TRUE(holds(disc, {1.5 + within, 1}));
  EXPECT_FALSE(holds(disc, {1.5 + beyond, 1}));
  EXPECT_NEAR(measure(disc, {0, 0}, {2, 2}, 1000), M_PI / 4, 1e-3);
  const Shape ball = sphere({0, 0, 0}, 1);
  EXPECT_TRUE(holds(ball, {2.0 / 3, -2.0 / 3, 1.0 / 3}));
  EXPECT_FALSE(holds(ball, {2.0 / 3, -2.0 / 3, 1.0 / 3 + 4e-3}));
  EXPECT_NEAR(measure(ball, {-1, -1, -1}, {1, 1, 1}, 100), 4 * M_PI / 3, 5e-3);
}

TEST(ShapeTest, CylinderHasFlatEnds) {
  const Shape upright = cylinder({1, 1, 0}, {1, 1, 2}, 0.5);
  EXPECT_TRUE(holds(upright, {1.3, 1.4, 1}));
  EXPECT_TRUE(holds(upright, {1.3, 1.4, -within}));
  EXPECT_FALSE(holds(upright, {1, 1, -beyond}));
  EXPECT_FALSE(holds(upright, {1, 1, 2 + beyond}));
  EXPECT_TRUE(holds(upright, {1.5 + within, 1, 1}));
  EXPECT_FALSE(holds(upright, {1.5 + beyond, 1, 1}));
  const Shape slanted = cylinder({0.3, 0.2, 0.1}, {1.5, 1.1, 1.6}, 0.4);
  const double length = std::sqrt(1.2 * 1.2 + 0.9 * 0.9 + 1.5 * 1.5);
  EXPECT_NEAR(measure(slanted, {-0.5, -0.5, -0.5}, {2, 2, 2}, 120), M_PI * 0.16 * length, 5e-3);
}

TEST(ShapeTest, PolygonFollowsTheEvenOddRule) {
  const Shape triangle = polygon({{0, 0}, {2, 0}, {0, 1}});
  EXPECT_TRUE(holds(triangle, {0.5, 0.5}));
  EXPECT_TRUE(holds(triangle, {1, 0.5}, 0.0));  // exactly on an edge
  EXPECT_TRUE(holds(triangle, {1, -within}));
  EXPECT_FALSE(holds(triangle, {1, -beyond}));
  const double a = 1 / std::sqrt(5.0), b = 2 / std::sqrt(5.0);
  EXPECT_TRUE(holds(triangle, {1 + within * a, 0.5 + within * b}));
  EXPECT_FALSE(holds(triangle, {1 + beyond * a, 0.5 + beyond * b}));
  EXPECT_TRUE(holds(triangle, {2 + within, 0}));  // beyond a corner
  EXPECT_FALSE(holds(triangle, {2 + within, within}));
  EXPECT_NEAR(measure(triangle, {-1, -1}, {3, 2}, 800), 1.0, 5e-3);
  const Shape l_shape = polygon({{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 2}, {0, 2}});
  EXPECT_NEAR(measure(l_shape, {-0.5, -0.5}, {3.5, 2.5}, 400), 4.0, 0.03);
  EXPECT_FALSE(holds(l_shape, {2, 1.5}));
  // A pentagram's core is wound around twice and so outside.
  std::vector<std::array<double, 2>> star;
  for (int i = 0; i < 5; ++i) star.push_back({std::sin(0.8 * M_PI * i), std::cos(0.8 * M_PI * i)});
  EXPECT_FALSE(holds(polygon(star), {0, 0}));
  EXPECT_TRUE(holds(polygon(star), {0, 0.7}));
}

TEST(ShapeTest, PolygonIsExtrudedAlongItsAxis) {
  const std::vector<std::array<double, 2>> triangle = {{0, 0}, {2, 0}, {0, 1}};
  EXPECT_TRUE(holds(polygon(triangle, 0), {55, 1.5, 0.1}));  // [y, z]
  EXPECT_FALSE(holds(polygon(triangle, 0), {55, 0.1, 1.5}));
  EXPECT_TRUE(holds(polygon(triangle, 1), {1.5, 55, 0.1}));  // [x, z]
  EXPECT_FALSE(holds(polygon(triangle, 1), {0.1, 55, 1.5}));
  EXPECT_TRUE(holds(polygon(triangle, 2), {1.5, 0.1, 55}));  // [x, y]
  EXPECT_FALSE(holds(polygon(triangle, 2), {0.1, 1.5, 55}));
}

TEST(ShapeTest, BooleanCombinations) {
  const Shape left = box({0, 0}, {2, 2}), right = box({1, 0}, {3, 2}), disc = sphere({1.5, 1}, 0.25);
  const Shape both = combine(Shape::Kind::union_of, {left, right});
  const Shape shared = combine(Shape::Kind::intersection, {left, right});
  const Shape holed = combine(Shape::Kind::difference, {both, disc, box({0, 0}, {0.5, 0.5})});
  EXPECT_NEAR(measure(both, {-1, -1}, {4, 4}, 500), 6.0, 1e-9);
  EXPECT_NEAR(measure(shared, {-1, -1}, {4, 4}, 500), 2.0, 1e-9);
  EXPECT_NEAR(measure(holed, {-1, -1}, {4, 4}, 1000), 6.0 - M_PI / 16 - 0.25, 2e-3);
}

TEST(ShapeTest, CombinationsAreBooleanAfterTheTolerance) {
  const Shape block = box({0, 0}, {2, 2}), cut = box({1, 0}, {2, 2});
  const Shape rest = combine(Shape::Kind::difference, {block, cut});
  EXPECT_FALSE(holds(rest, {1, 1}));           // the cut's surface goes with the cut
  EXPECT_FALSE(holds(rest, {1 - within, 1}));  // and what is within its tolerance
  EXPECT_TRUE(holds(rest, {1 - beyond, 1}));
  const Shape touching =
      combine(Shape::Kind::intersection, {box({0, 0}, {1, 1}), box({1 + within, 0}, {2, 1})});
  EXPECT_TRUE(holds(touching, {1 + within / 2, 0.5}));
}

}  // namespace
}  // namespace fabseq
