// SPDX-License-Identifier: MIT
#include "mesh/shells.h"

#include "support/io_support.h"
#include "support/meshes.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace fabseq {
namespace {

using test::append;
using test::box_mesh;
using test::contains;
using test::inside_out;

TriangleMesh together(std::initializer_list<TriangleMesh> bodies) {
  TriangleMesh result;
  for (const TriangleMesh& body : bodies) append(result, body);
  return result;
}

/// Points at the same position become one, as SurfaceBuilder does.
TriangleMesh joined(TriangleMesh mesh) {
  const std::vector<Point<3>> old = mesh.points;
  for (auto& triangle : mesh.triangles)
    for (std::int32_t& corner : triangle)
      corner = static_cast<std::int32_t>(std::find(old.begin(), old.end(), old[corner]) - old.begin());
  return mesh;
}

const TriangleMesh left = box_mesh({0, 0, 0}, {3, 2, 2}), right = box_mesh({2, 0, 0}, {6, 2, 2});
const TriangleMesh outer = box_mesh({0, 0, 0}, {6, 6, 6}), inner = box_mesh({1, 1, 1}, {5, 5, 5}),
                   innermost = box_mesh({2, 2, 2}, {3, 3, 3});

TEST(ShellsTest, BodiesOfWhichOneIsInsideOut) {
  TriangleMesh mesh = together({left, inside_out(right)});
  const std::vector<std::string> notes = turn_shells(mesh);
  EXPECT_NEAR(signed_volume(mesh), 12 + 16, 1e-12);
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_EQ(notes[0],
            "1 closed surface, [2,0,0]..[6,2,2] in the file, not inside another, turned inside out: taken as "
            "solid");
}

TEST(ShellsTest, AllInsideOutIsNoMistake) {
  TriangleMesh mesh = together({inside_out(left), inside_out(right)});
  EXPECT_TRUE(turn_shells(mesh).empty());
  EXPECT_NEAR(signed_volume(mesh), 12 + 16, 1e-12);
}

/// Two boxes that share a face and its edges.
TEST(ShellsTest, BodiesThatTouchStayApart) {
  TriangleMesh mesh = joined(together({left, inside_out(box_mesh({3, 0, 0}, {6, 2, 2}))}));
  EXPECT_EQ(turn_shells(mesh).size(), 1u);
  EXPECT_NEAR(signed_volume(mesh), 24, 1e-12);
}

TEST(ShellsTest, CavitiesFaceTheOtherWay) {
  for (const bool whole_file_turned : {false, true}) {
    TriangleMesh mesh = together({inside_out(inner), outer});
    if (whole_file_turned) mesh = inside_out(mesh);
    const std::vector<std::string> notes = turn_shells(mesh);
    EXPECT_NEAR(signed_volume(mesh), 216 - 64, 1e-12);
    ASSERT_EQ(notes.size(), 1u);
    EXPECT_EQ(
        notes[0],
        "1 closed surface, [1,1,1]..[5,5,5] in the file, inside another, turned the other way: taken as "
        "a cavity, empty");
  }
}

TEST(ShellsTest, WhatIsTurnedLikeTheBodyAroundItIsFilled) {
  TriangleMesh mesh = together({outer, inner});
  const std::vector<std::string> notes = turn_shells(mesh);
  EXPECT_NEAR(signed_volume(mesh), 216 + 64, 1e-12);
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_TRUE(contains(notes[0], "taken as solid; if it is a cavity, turn it round"));
}

TEST(ShellsTest, BodiesInCavities) {
  for (const bool turned : {false, true}) {
    TriangleMesh mesh = together({outer, inside_out(inner), turned ? inside_out(innermost) : innermost});
    (void)turn_shells(mesh);
    EXPECT_NEAR(signed_volume(mesh), 216 - 64 + 1, 1e-12);
  }
}

/// A bar between the legs of a table lies in its box, but not in it.
TEST(ShellsTest, BetweenPartsOfABody) {
  const TriangleMesh ring = test::torus_mesh(3, 1, 60, 40);
  TriangleMesh mesh = together({ring, inside_out(test::sphere_mesh(0.5, 10))});
  (void)turn_shells(mesh);
  EXPECT_NEAR(signed_volume(mesh), signed_volume(ring) + signed_volume(test::sphere_mesh(0.5, 10)), 1e-9);
  mesh = together({ring, inside_out(box_mesh({-3, -0.2, -0.2}, {3, 0.2, 0.2}))});
  EXPECT_EQ(turn_shells(mesh).size(), 1u);
  EXPECT_NEAR(signed_volume(mesh), signed_volume(ring) + 0.96, 1e-9);
}

TEST(ShellsTest, OpenPiecesStay) {
  const TriangleMesh open = inside_out(test::open_box_mesh({9, 0, 0}, {10, 1, 1}));
  TriangleMesh mesh = together({open, inside_out(left)});
  EXPECT_TRUE(turn_shells(mesh).empty());
  for (std::size_t t = 0; t < open.triangles.size(); ++t) EXPECT_EQ(mesh.triangles[t], open.triangles[t]);
}

TEST(ShellsTest, ManyCavities) {
  TriangleMesh mesh = box_mesh({0, 0, 0}, {20, 20, 20});
  for (int i = 0; i < 1000; ++i) {
    const double x = 0.5 + i % 10 * 2, y = 0.5 + i / 10 % 10 * 2, z = 0.5 + i / 100 * 2;
    append(mesh, inside_out(box_mesh({x, y, z}, {x + 1, y + 1, z + 1})));
  }
  const std::vector<std::string> notes = turn_shells(mesh);
  EXPECT_NEAR(signed_volume(mesh), 8000 - 1000, 1e-9);
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_EQ(notes[0].rfind("1000 closed surfaces, the largest [", 0), 0u) << notes[0];
}

}  // namespace
}  // namespace fabseq
