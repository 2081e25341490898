// SPDX-License-Identifier: MIT
#include "mesh/mesh_formats.h"
#include "support/io_support.h"

#include <gtest/gtest.h>

namespace fabseq {
namespace {

using test::contains;

const std::string vertices =
    "v 0 0 0\nv 2 0 0 1 0.5 0.5\nv 0 +2 0\nv 0 0 4 2 # half of it\nvt 0 0\nvn nan 0 0\n";

TriangleMesh read(const std::string& faces) { return read_obj(vertices + faces); }
std::string refusal_of(const std::string& faces) {
  return test::error_text<InputError>([&] { (void)read(faces); });
}

void expect_corner(const TriangleMesh& found) {
  EXPECT_EQ(found.triangles.size(), 4u);
  EXPECT_TRUE(is_closed(found));
  EXPECT_NEAR(signed_volume(found), 8.0 / 6, 1e-12);
}

TEST(ReadObjTest, CornersOfFaces) {
  expect_corner(read("f 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"));
  expect_corner(read("f 1/9/1 3/7 2//8\nf 1// 2/ 4/55/1\r\nf 2 3 4 # slanted\rf -4 -1 -2"));
  expect_corner(
      read("g a\nusemtl b\nmtllib c.mtl\ns off\nf 1 3 \\\n 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\nl 1 2\np 1"));
}

TEST(ReadObjTest, FacesBeforeVertices) {
  expect_corner(read_obj("f 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n" + vertices));
}

TEST(ReadObjTest, DecimalCommas) {
  const TriangleMesh found = read_obj("v 0,5 0 0\nv 1,5 0 0\nv 0 1,25 0\nf 1 2 3\n");
  EXPECT_EQ(found.points[0], (Point<3>{0.5, 0, 0}));
}

TEST(ReadObjTest, Refusals) {
  EXPECT_TRUE(
      contains(refusal_of("f 1 2 3\nf 1 2 5\n"), "has vertex 5 in a face in line 8, allowed: 1 to 4"));
  EXPECT_TRUE(contains(refusal_of("f 1 2 -5\n"), "has vertex 0 in a face in line 7"));
  EXPECT_TRUE(contains(refusal_of("f 1 2 0\n"), "has vertex 0"));
  EXPECT_TRUE(contains(refusal_of("f 1 2 99999999999999999999\n"), "in line 7, needs an intact OBJ file"));
  EXPECT_TRUE(contains(refusal_of("f 1 2 -9223372036854775808\n"), "has vertex 0"));
  EXPECT_TRUE(contains(refusal_of("f 1 b 2\n"), "has \"f 1 b 2\" in line 7"));
  EXPECT_TRUE(contains(refusal_of("v 1 2\n"), "has \"v 1 2\" in line 7"));
}

}  // namespace
}  // namespace fabseq
