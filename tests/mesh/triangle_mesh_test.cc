// SPDX-License-Identifier: MIT
#include "fabseq/mesh/triangle_mesh.h"

#include "support/meshes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace fabseq {
namespace {

using test::box_mesh;

TEST(TriangleMeshTest, MeasuresOfABox) {
  const TriangleMesh box = box_mesh({1, 2, 3}, {2, 4, 7});
  EXPECT_NEAR(signed_volume(box), 8.0, 1e-12);
  EXPECT_EQ(bounds(box).low, (Point<3>{1, 2, 3}));
  EXPECT_EQ(bounds(box).high, (Point<3>{2, 4, 7}));
  EXPECT_NEAR(signed_volume(test::inside_out(box)), -8.0, 1e-12);
}

TEST(TriangleMeshTest, MeasuresOfNothing) {
  EXPECT_EQ(signed_volume({}), 0.0);
  EXPECT_GT(bounds({}).low[0], bounds({}).high[0]);
  EXPECT_TRUE(is_closed({}));
}

TEST(TriangleMeshTest, VolumeIsAccurateFarFromTheOrigin) {
  EXPECT_NEAR(signed_volume(box_mesh({1e6, 1e6, 1e6}, {1e6 + 1, 1e6 + 1, 1e6 + 1})), 1.0, 1e-12);
}

TEST(TriangleMeshTest, SphereAndTorusConverge) {
  for (const int n : {20, 40}) {
    const double error = 30.0 / (n * n);  // inscribed polygons: second order
    EXPECT_NEAR(signed_volume(test::sphere_mesh(1, n)), 4 * M_PI / 3, error);
    EXPECT_NEAR(signed_volume(test::torus_mesh(2, 0.5, 4 * n, 2 * n)), M_PI * M_PI, error);
  }
}

TEST(TriangleMeshTest, Transformation) {
  const std::array<Point<3>, 3> matrix = {{{0, -2, 0}, {3, 0, 0}, {0, 0, 4}}};
  const TriangleMesh box = transformed(box_mesh({0, 0, 0}, {1, 1, 1}), matrix, {10, 20, 30});
  EXPECT_EQ(bounds(box).low, (Point<3>{8, 20, 30}));
  EXPECT_EQ(bounds(box).high, (Point<3>{10, 23, 34}));
  EXPECT_NEAR(signed_volume(box), 24.0, 1e-12);
}

TEST(TriangleMeshTest, ClosedOrNot) {
  const TriangleMesh box = box_mesh({0, 0, 0}, {1, 1, 1});
  EXPECT_TRUE(is_closed(box));
  EXPECT_TRUE(is_closed(test::inside_out(box)));
  EXPECT_TRUE(is_closed(test::sphere_mesh(1, 5)));
  EXPECT_TRUE(is_closed(test::torus_mesh(2, 1, 7, 5)));
  EXPECT_FALSE(is_closed(test::open_box_mesh({0, 0, 0}, {1, 1, 1})));
  EXPECT_FALSE(is_closed(test::hemisphere_mesh(1, 5)));
  TriangleMesh turned = box;
  std::swap(turned.triangles[3][0], turned.triangles[3][1]);
  EXPECT_FALSE(is_closed(turned));
  TriangleMesh twice = box;  // four triangles at every edge
  twice.triangles.insert(twice.triangles.end(), box.triangles.begin(), box.triangles.end());
  EXPECT_TRUE(is_closed(twice));
  twice.triangles.pop_back();
  EXPECT_FALSE(is_closed(twice));
}

}  // namespace
}  // namespace fabseq
