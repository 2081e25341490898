// SPDX-License-Identifier: MIT
#include "mesh/stray_triangles.h"

#include "support/meshes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace fabseq {
namespace {

using test::box_mesh;

TriangleMesh box_and_triangle(const Point<3>& a, const Point<3>& b, const Point<3>& c) {
  TriangleMesh mesh = box_mesh({0, 0, 0}, {6, 2, 2});
  test::append(mesh, {{a, b, c}, {{0, 1, 2}}});
  return mesh;
}

TEST(StrayTrianglesTest, FarAway) {
  TriangleMesh mesh = box_and_triangle({10000, 0, 0}, {10000, 0, 0.1}, {10000, 0.1, 0});
  EXPECT_EQ(
      remove_stray_triangles(mesh),
      (std::vector<std::string>{
          "1 stray triangle at [10000,0,0] in the file, would make the box 1.67e+03 times as large: left "
          "out"}));
  EXPECT_EQ(mesh.triangles.size(), 12u);
  EXPECT_EQ(bounds(mesh).high, (Point<3>{6, 2, 2}));
}

TEST(StrayTrianglesTest, WithoutAreaSilently) {
  TriangleMesh mesh = box_and_triangle({7, 0, 0}, {8, 1, 0}, {9, 2, 0});
  EXPECT_TRUE(remove_stray_triangles(mesh).empty());
  EXPECT_EQ(mesh.triangles.size(), 12u);
}

TEST(StrayTrianglesTest, WhatIsNearStays) {
  TriangleMesh mesh = box_and_triangle({7, 0, 0}, {8, 1, 0}, {9, 0, 0});
  EXPECT_TRUE(remove_stray_triangles(mesh).empty());
  EXPECT_EQ(mesh.triangles.size(), 13u);
}

/// Nothing but open pieces, of which each might be stray.
TEST(StrayTrianglesTest, LooseTrianglesStay) {
  TriangleMesh soup;
  const TriangleMesh box = box_mesh({0, 0, 0}, {6, 2, 2});
  for (std::size_t t = 0; t < box.triangles.size(); ++t) {
    const auto [a, b, c] = box.corners(t);
    test::append(soup, {{a, b, c}, {{0, 1, 2}}});
  }
  EXPECT_TRUE(remove_stray_triangles(soup).empty());
  EXPECT_EQ(soup.triangles.size(), 12u);
}

/// A spike to a point on the line of its edge has no area, turned or not.
TEST(StrayTrianglesTest, SpikesCountInNoBound) {
  TriangleMesh mesh = box_mesh({0, 0, 0}, {6, 2, 2});
  mesh.points.push_back({1e6, 0, 0});
  mesh.triangles.push_back({0, 1, 8});
  mesh.triangles.push_back({1, 0, 8});
  const double c = std::cos(0.5), s = std::sin(0.5);
  const Bounds turned = bounds(transformed(mesh, {{{c, -s, 0}, {s, c, 0}, {0, 0, 1}}}, {0, 0, 0}));
  EXPECT_NEAR(turned.high[0], 6 * c, 1e-12);
}

}  // namespace
}  // namespace fabseq
