// SPDX-License-Identifier: MIT
#include "mesh/mesh_formats.h"
#include "support/io_support.h"
#include "support/mesh_files.h"
#include "support/meshes.h"

#include <gtest/gtest.h>

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
    notes_.clear();
    return read_three_mf(content, notes_, unit_);
  }
  std::string refusal_of(const std::string& content) {
    return test::error_text<InputError>([&] { (void)read(content); });
  }

  std::vector<std::string> notes_;
  std::string unit_;
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

TEST_F(ReadThreeMfTest, WhatIsNotToBePrintedIsLeftOut) {
  const std::string apart = "<item objectid=\"2\" printable=\"0\"/>";
  const TriangleMesh found =
      read(three_mf(three_mf_object(1, box) + three_mf_object(2, box_mesh({5, 5, 5}, {9, 9, 9})),
                    "<item objectid=\"1\" printable=\"1\"/>" + apart));
  EXPECT_EQ(bounds(found).high, (Point<3>{2, 4, 7}));
  EXPECT_EQ(notes_, (std::vector<std::string>{"1 object not to be printed left out of the part"}));
}

/// Half of the part in a file of its own, which no relation names.
TEST_F(ReadThreeMfTest, ObjectsInOtherFiles) {
  const std::string model = "<model xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\">";
  const std::string other = model + "<resources>" + three_mf_object(1, box_mesh({2, 2, 3}, {3, 4, 7})) +
                            "</resources><build><item objectid=\"1\"/></build></model>";
  const std::string whole = three_mf_object(1, box) +
                            "<object id=\"2\"><components><component "
                            "xmlns:p=\"http://schemas.microsoft.com/3dmanufacturing/production/2015/06\" "
                            "p:path=\"/3D/Objects/half.model\" objectid=\"1\"/>"
                            "<component objectid=\"1\"/></components></object>";
  const TriangleMesh found = read(three_mf(whole, three_mf_item(2), {{"3D/Objects/half.model", other}}));
  EXPECT_EQ(found.triangles.size(), 24u);
  EXPECT_EQ(bounds(found).high, (Point<3>{3, 4, 7}));
  EXPECT_TRUE(contains(refusal_of(three_mf(whole, three_mf_item(2))),
                       "names the file \"3D/Objects/half.model\", which is not in its archive"));
}

TEST_F(ReadThreeMfTest, Packed) {
  const std::string packed = three_mf(three_mf_object(1, box), three_mf_item(1), {}, true);
  EXPECT_EQ(read(packed).triangles.size(), 12u);
  std::string damaged = packed;
  damaged[packed.find("<vertex") + 12] = '9';
  EXPECT_TRUE(contains(refusal_of(damaged), "\"3D/3dmodel.model\" in its archive: "));
}

TEST_F(ReadThreeMfTest, Unit) {
  std::string content = three_mf(three_mf_object(1, box), three_mf_item(1));
  (void)read(content);
  EXPECT_EQ(unit_, "millimeter");
  content = three_mf(three_mf_object(1, box), three_mf_item(1), {}, false, "inch");
  (void)read(content);
  EXPECT_EQ(unit_, "inch");
}

TEST_F(ReadThreeMfTest, IndexBeyondTheVertices) {
  TriangleMesh damaged = box;
  for (const std::int32_t bad : {8, 2000000000, -1}) {
    damaged.triangles[4][1] = bad;
    EXPECT_TRUE(
        contains(refusal_of(three_mf(three_mf_object(1, damaged), three_mf_item(1))),
                 " (allowed: 0 to 7) in triangle 5 of object 1 of \"3D/3dmodel.model\" in its archive"));
  }
}

TEST_F(ReadThreeMfTest, ComponentsThatContainThemselves) {
  const std::string mesh = three_mf_object(1, box);
  EXPECT_TRUE(
      contains(refusal_of(three_mf(mesh + three_mf_components(2, {1, 2}), three_mf_item(2))), "intact"));
  EXPECT_TRUE(contains(refusal_of(three_mf(mesh + three_mf_components(2, {3}) + three_mf_components(3, {2}),
                                           three_mf_item(2))),
                       "intact"));
  EXPECT_TRUE(contains(refusal_of(three_mf(mesh, three_mf_item(7))), "intact"));
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
  EXPECT_TRUE(contains(refusal_of(test::zip({{"readme.txt", "no model"}})), "a ZIP archive without a model"));
  const std::string whole = three_mf(three_mf_object(1, box), three_mf_item(1));
  for (std::size_t size = 0; size < whole.size(); size += 37)
    EXPECT_TRUE(contains(refusal_of(whole.substr(0, size)), "needs an intact 3MF file")) << size;
}

/// Whatever byte is wrong: the mesh, or a refusal.
TEST_F(ReadThreeMfTest, BytesThatAreWrong) {
  const std::string whole = three_mf(three_mf_object(1, box), three_mf_item(1));
  for (std::size_t at = 0; at < whole.size(); ++at)
    for (const char wrong : {'\0', '\xff'}) {
      std::string damaged = whole;
      damaged[at] = wrong;
      try {
        EXPECT_EQ(read(damaged).triangles.size(), 12u) << at;
      } catch (const InputError&) {
      }
    }
}

}  // namespace
}  // namespace fabseq
