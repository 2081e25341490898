// SPDX-License-Identifier: MIT
#include "mesh/mesh_formats.h"
#include "support/io_support.h"
#include "support/mesh_files.h"
#include "support/meshes.h"

#include <gtest/gtest.h>

#include <fstream>

namespace fabseq {
namespace {

using test::box_mesh;
using test::contains;
using test::three_mf;
using test::three_mf_components;
using test::three_mf_item;
using test::three_mf_object;

const TriangleMesh box = box_mesh({1, 2, 3}, {2, 4, 7});

class ReadThreeMfTest : public testing::Test {
 protected:
  TriangleMesh read(const std::string& content) {
    const std::string path = scratch_.file("part.3mf");
    std::ofstream(path, std::ios::binary) << content;
    notes_.clear();
    return read_three_mf(path, notes_);
  }
  std::string refusal_of(const std::string& content) {
    return test::error_text<InputError>([&] { (void)read(content); });
  }

  std::vector<std::string> notes_;

 private:
  test::ScratchDirectory scratch_;
};

TEST_F(ReadThreeMfTest, PreviewImage) {
  const TriangleMesh found = read(
      three_mf(three_mf_object(1, box), three_mf_item(1), {{"Metadata/thumbnail.png", "\x89PNG no more"}}));
  EXPECT_EQ(found.triangles.size(), 12u);
  EXPECT_NEAR(signed_volume(found), 8.0, 1e-12);
}

TEST_F(ReadThreeMfTest, ComponentsStandWhereTheirItemsPutThem) {
  const TriangleMesh found = read(three_mf(three_mf_object(1, box) + three_mf_components(2, {1}),
                                           three_mf_item(1) + three_mf_item(2, "0 1 0 -1 0 0 0 0 1 20 0 0")));
  EXPECT_EQ(found.triangles.size(), 24u);
  EXPECT_NEAR(signed_volume(found), 16.0, 1e-12);
  EXPECT_EQ(bounds(found).low, (Point<3>{1, 1, 3}));
  EXPECT_EQ(bounds(found).high, (Point<3>{18, 4, 7}));  // (x, y) becomes (20 - y, x)
}

TEST_F(ReadThreeMfTest, MirroredItemsFaceOutward) {
  const TriangleMesh found = read(
      three_mf(three_mf_object(1, box), three_mf_item(1) + three_mf_item(1, "-1 0 0 0 1 0 0 0 1 0 0 0")));
  EXPECT_EQ(bounds(found).low, (Point<3>{-2, 2, 3}));
  EXPECT_NEAR(signed_volume(found), 16.0, 1e-12);
}

TEST_F(ReadThreeMfTest, SupportsAreLeftOut) {
  const std::string objects = three_mf_object(1, box) +
                              three_mf_object(2, box_mesh({5, 5, 5}, {9, 9, 9}), "support") +
                              three_mf_object(3, box_mesh({5, 5, 5}, {9, 9, 9}), "other");
  const TriangleMesh found = read(three_mf(objects, three_mf_item(1) + three_mf_item(2) + three_mf_item(3)));
  EXPECT_EQ(bounds(found).high, (Point<3>{2, 4, 7}));
  EXPECT_EQ(notes_, (std::vector<std::string>{"1 object of type \"other\" left out of the part",
                                              "1 object of type \"support\" left out of the part"}));
}

TEST_F(ReadThreeMfTest, IndexBeyondTheVertices) {
  TriangleMesh damaged = box;
  damaged.triangles[4][1] = 8;
  EXPECT_TRUE(
      contains(refusal_of(three_mf(three_mf_object(1, damaged), three_mf_item(1))), "intact 3MF file"));
  damaged.triangles[4][1] = 2000000000;
  EXPECT_TRUE(
      contains(refusal_of(three_mf(three_mf_object(1, damaged), three_mf_item(1))), "intact 3MF file"));
}

TEST_F(ReadThreeMfTest, ComponentsThatContainThemselves) {
  const std::string mesh = three_mf_object(1, box);
  EXPECT_TRUE(
      contains(refusal_of(three_mf(mesh + three_mf_components(2, {1, 2}), three_mf_item(2))), "intact"));
  EXPECT_TRUE(contains(refusal_of(three_mf(mesh + three_mf_components(2, {3}) + three_mf_components(3, {2}),
                                           three_mf_item(2))),
                       "intact"));
}

/// Each object has the one before twice: a million million bodies in all.
TEST_F(ReadThreeMfTest, ComponentsThatUnfoldWithoutEnd) {
  std::string objects = three_mf_object(1, box);
  for (int object = 2; object <= 40; ++object)
    objects += three_mf_components(object, {object - 1, object - 1});
  EXPECT_TRUE(contains(refusal_of(three_mf(objects, three_mf_item(40))), "more than 10000 bodies"));
  std::string chain = three_mf_object(1, box);
  for (int object = 2; object <= 102; ++object) chain += three_mf_components(object, {object - 1});
  EXPECT_TRUE(contains(refusal_of(three_mf(chain, three_mf_item(102))), "or 100 levels"));
}

TEST_F(ReadThreeMfTest, NoArchive) {
  EXPECT_TRUE(contains(refusal_of("PK\3\4 and nothing more"), "needs an intact 3MF file"));
}

}  // namespace
}  // namespace fabseq
