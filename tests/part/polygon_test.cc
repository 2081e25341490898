// SPDX-License-Identifier: MIT
#include "fabseq/part/polygon.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace fabseq {
namespace {

using Point = Polygon::Point;

/// Looks at all edges.
bool holds(const std::vector<Point>& corners, const Point& point, double tolerance) {
  bool inside = false;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Point &a = corners[i], &b = corners[(i + 1) % corners.size()];
    const double dx = b[0] - a[0], dy = b[1] - a[1], square = dx * dx + dy * dy;
    const double along =
        square > 0.0 ? std::clamp(((point[0] - a[0]) * dx + (point[1] - a[1]) * dy) / square, 0.0, 1.0) : 0.0;
    if (std::hypot(point[0] - a[0] - along * dx, point[1] - a[1] - along * dy) <= tolerance) return true;
    if ((a[1] > point[1]) != (b[1] > point[1]) && point[0] < a[0] + (point[1] - a[1]) / dy * dx)
      inside = !inside;
  }
  return inside;
}

/// Points anywhere, at the height of corners, and on edges.
void compare(const std::vector<Point>& corners, double tolerance) {
  const Polygon polygon(corners);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> anywhere(-1.2, 1.2);
  std::uniform_int_distribution<std::size_t> any(0, corners.size() - 1);
  for (int i = 0; i < 2000; ++i) {
    const Point& corner = corners[any(random)];
    const Point& next = corners[any(random)];
    for (const Point point : {Point{anywhere(random), anywhere(random)}, Point{anywhere(random), corner[1]},
                              Point{(corner[0] + next[0]) / 2, (corner[1] + next[1]) / 2}})
      EXPECT_EQ(polygon.contains(point, tolerance), holds(corners, point, tolerance))
          << point[0] << ' ' << point[1];
  }
}

TEST(PolygonTest, AllEdgesOrFew) {
  std::vector<Point> circle, comb, tangle, flat;
  for (int i = 0; i < 500; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / 500;
    circle.push_back({std::cos(angle), std::sin(angle)});
    comb.push_back({i / 250.0 - 1.0, i % 2 == 0 ? -1.0 : 1.0});
    tangle.push_back({std::cos(7 * angle + 1), std::sin(11 * angle)});
    flat.push_back({std::cos(angle), 0.5});
  }
  for (const auto& corners : {circle, comb, tangle, flat, std::vector<Point>{{0, 0}, {1, 0}, {0, 1}}})
    for (const double tolerance : {1e-9, 0.01, 0.5, 5.0}) compare(corners, tolerance);
}

TEST(PolygonTest, None) { EXPECT_FALSE(Polygon().contains({0.0, 0.0}, 1.0)); }

}  // namespace
}  // namespace fabseq
