// SPDX-License-Identifier: MIT
#include "mesh/cut_out.h"

#include "mesh/hole_groups.h"
#include "support/meshes.h"

#include <gtest/gtest.h>

namespace fabseq {
namespace {

using test::append;
using test::box_mesh;
using test::sphere_mesh;

TriangleMesh turned(TriangleMesh mesh, double angle, const Point<3>& shift) {
  const double c = std::cos(angle), s = std::sin(angle);
  const std::array<Point<3>, 3> about_z = {{{c, -s, 0}, {s, c, 0}, {0, 0, 1}}},
                                about_x = {{{1, 0, 0}, {0, c, -s}, {0, s, c}}};
  return transformed(transformed(std::move(mesh), about_z, {}), about_x, shift);
}

/// Checks that the cut is closed and encloses this much.
void expect_volume(const TriangleMesh& body, const TriangleMesh& hole, double volume, const char* what) {
  const TriangleMesh left = cut_out(body, hole);
  EXPECT_TRUE(is_closed(left)) << what;
  EXPECT_NEAR(signed_volume(left), volume, 1e-6 * signed_volume(body)) << what;
}

const TriangleMesh block = box_mesh({0, 0, 0}, {6, 4, 2});

TEST(CutOut, BoxesInAnyPlace) {
  expect_volume(block, box_mesh({2, 1.5, -1}, {4, 2.5, 5}), 48 - 4, "right through");
  expect_volume(block, box_mesh({2, 1.5, 1}, {4, 2.5, 5}), 48 - 2, "a pocket");
  expect_volume(block, box_mesh({2, 1.5, 0.5}, {4, 2.5, 1.5}), 48 - 2, "a cavity");
  expect_volume(block, box_mesh({5, 3, 1}, {7, 5, 3}), 48 - 1, "a corner");
  expect_volume(block, box_mesh({-1, -1, 1}, {7, 5, 3}), 24, "the upper half");
  expect_volume(block, box_mesh({8, 0, 0}, {9, 4, 2}), 48, "beside it");
}

TEST(CutOut, FacesThatLieOnEachOther) {
  expect_volume(block, box_mesh({2, 1.5, 0}, {4, 2.5, 2}), 48 - 4, "through, to both faces");
  expect_volume(block, box_mesh({2, 1.5, 1}, {4, 2.5, 2}), 48 - 2, "a pocket to the upper face");
  expect_volume(block, box_mesh({6, 0, 0}, {9, 4, 2}), 48, "touches a whole face");
  expect_volume(block, box_mesh({2, 4, 0.5}, {4, 6, 1}), 48, "touches a part of a face");
  expect_volume(block, box_mesh({0, 0, 1}, {6, 4, 2}), 24, "shares four faces and the top");
  expect_volume(block, box_mesh({3, 2, 0}, {6, 4, 2}), 36, "a quarter");
}

TEST(CutOut, SlantedSurfaces) {
  const double cut = signed_volume(sphere_mesh(1.0, 12));
  for (const double angle : {0.0, 0.3, 1.1}) {
    const TriangleMesh body = turned(block, angle, {10, -3, 4}),
                       ball = turned(sphere_mesh(1.0, 12), angle, {10, -3, 4});
    expect_volume(body, ball, 48 - cut / 8, "an eighth of a sphere");
  }
  const TriangleMesh ball = sphere_mesh(3.0, 16);
  const TriangleMesh left = cut_out(ball, turned(box_mesh({-5, -5, 0}, {5, 5, 5}), 0.7, {0, 0, 0}));
  EXPECT_TRUE(is_closed(left));
  EXPECT_NEAR(signed_volume(left), 0.5 * signed_volume(ball), 1e-2);
}

/// What one loses by the other, the other loses by it.
TEST(CutOut, BothWays) {
  for (int i = 0; i < 6; ++i) {
    const double angle = 0.1 + 0.37 * i;
    const TriangleMesh ball = turned(sphere_mesh(2.0 + 0.05 * i, 4 + i % 5), 0.2 * i, {3.1, 2.2, 0.4}),
                       bar = turned(box_mesh({-3, -1, -1}, {4, 1, 1.2}), angle, {2.5, 2.0, 1.0});
    for (const auto& [a, b] : {std::pair(block, ball), std::pair(ball, bar), std::pair(bar, block)}) {
      const TriangleMesh left_of_a = cut_out(a, b), left_of_b = cut_out(b, a);
      EXPECT_TRUE(is_closed(left_of_a)) << i;
      EXPECT_TRUE(is_closed(left_of_b)) << i;
      EXPECT_NEAR(signed_volume(a) - signed_volume(left_of_a), signed_volume(b) - signed_volume(left_of_b),
                  1e-6)
          << i;
      EXPECT_LT(signed_volume(left_of_a), signed_volume(a) - 0.1) << i;
    }
  }
}

TEST(CutOut, BodiesAndHolesThatOverlap) {
  TriangleMesh bodies = block;
  append(bodies, box_mesh({3, 1, 1}, {9, 3, 5}));
  TriangleMesh holes = box_mesh({4, 1.5, -1}, {5, 2.5, 8});
  append(holes, box_mesh({4.5, 1.5, -1}, {5.5, 2.5, 8}));
  const std::vector<TriangleMesh> groups = hole_groups({holes, box_mesh({0, 0, 0}, {1, 1, 1})});
  ASSERT_EQ(groups.size(), 2u);  // the third is apart from the first
  const TriangleMesh left = cut_out(cut_out(bodies, groups[0]), groups[1]);
  EXPECT_TRUE(is_closed(left));
  // What two bodies share counts twice, as it does before.
  EXPECT_NEAR(signed_volume(left), 48 + 48 - 1.5 * (2 + 4) - 1, 1e-6);
}

TEST(CutOut, HolesThatAreInsideOut) {
  expect_volume(block, test::inside_out(box_mesh({2, 1.5, 1}, {4, 2.5, 5})), 48 - 2, "a pocket");
}

TEST(CutOut, ManyPockets) {
  std::vector<TriangleMesh> pockets;
  for (int i = 0; i < 20; ++i)
    for (int j = 0; j < 20; ++j)
      pockets.push_back(box_mesh({4 * i + 0.5, 4 * j + 0.3, 9}, {4 * i + 3.0, 4 * j + 2.7, 11}));
  const std::vector<TriangleMesh> groups = hole_groups(pockets);
  ASSERT_EQ(groups.size(), 1u);
  expect_volume(box_mesh({0, 0, 0}, {80, 80, 10}), groups[0], 64000 - 400 * 6, "pockets");
}

TEST(CutOut, FineSphere) {
  const TriangleMesh left =
      cut_out(box_mesh({-50, -50, 0}, {50, 50, 10}), turned(sphere_mesh(20, 100), 0.7, {3, 1, 10}));
  EXPECT_TRUE(is_closed(left));
}

TEST(CutOut, NothingIsLeft) {
  EXPECT_TRUE(cut_out(block, box_mesh({-1, -1, -1}, {7, 5, 3})).triangles.empty());
}

TEST(CutOut, CavitiesStay) {
  TriangleMesh hollow = block;
  append(hollow, test::inside_out(box_mesh({1, 1, 0.5}, {3, 3, 1.5})));
  expect_volume(hollow, box_mesh({2, -1, -1}, {9, 5, 3}), 16 - 2, "through the cavity");
}

}  // namespace
}  // namespace fabseq
