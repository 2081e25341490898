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
  TriangleMesh read(const std::string& content, ThreeMfObjects wanted = ThreeMfObjects::bodies) {
    notes_.clear();
    return read_three_mf(content, wanted, notes_, unit_);
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

/// What PrusaSlicer says of an object with these types of volumes, of 12 triangles each.
std::string prusa_config(const std::vector<std::string>& types) {
  std::string text = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<config><object id=\"1\">";
  for (std::size_t i = 0; i < types.size(); ++i)
    text += "<volume firstid=\"" + std::to_string(12 * i) + "\" lastid=\"" + std::to_string(12 * i + 11) +
            "\"><metadata type=\"volume\" key=\"name\" value=\"a.stl\"/><metadata type=\"volume\" " +
            types[i] + "/></volume>";
  return text + "</object></config>";
}

std::string of_type(const std::string& type) { return "key=\"volume_type\" value=\"" + type + "\""; }

const TriangleMesh block = box_mesh({0, 0, 0}, {6, 4, 2}), through = box_mesh({2, 1, -1}, {4, 3, 5}),
                   beside = box_mesh({7, 0, 0}, {8, 4, 9});

/// An object made of these meshes, one after the other.
std::string object_of(const std::vector<TriangleMesh>& meshes) {
  TriangleMesh all;
  for (const TriangleMesh& mesh : meshes) test::append(all, mesh);
  return three_mf_object(1, all);
}

TEST_F(ReadThreeMfTest, VolumesOfPrusaSlicer) {
  const std::vector<std::string> types = {of_type("ModelPart"), of_type("NegativeVolume"),
                                          of_type("SupportBlocker"), of_type("SupportEnforcer"),
                                          of_type("ParameterModifier")};
  const std::string objects = object_of({block, through, beside, beside, beside});
  for (const char* name : {"Metadata/Slic3r_PE_model.config", "Metadata/SuperSlicer_model.config",
                           "Metadata/Slic3r_model.config"}) {
    const TriangleMesh found = read(three_mf(objects, three_mf_item(1), {{name, prusa_config(types)}}));
    EXPECT_TRUE(is_closed(found));
    EXPECT_NEAR(signed_volume(found), 48 - 8, 1e-9);
    EXPECT_EQ(bounds(found).high, (Point<3>{6, 4, 2}));
    EXPECT_EQ(notes_,
              (std::vector<std::string>{
                  "1 negative volume cut out of the part", "1 modifier left out of the part",
                  "1 support blocker left out of the part", "1 support enforcer left out of the part"}));
  }
}

/// As PrusaSlicer 2.5 slices them.
TEST_F(ReadThreeMfTest, NegativeVolumesCutWhatComesBeforeThem) {
  const auto volume_of = [&](const std::vector<TriangleMesh>& meshes, const std::vector<std::string>& types) {
    return signed_volume(read(three_mf(object_of(meshes), three_mf_item(1),
                                       {{"Metadata/Slic3r_PE_model.config", prusa_config(types)}})));
  };
  const std::string part = of_type("ModelPart"), negative = of_type("NegativeVolume");
  EXPECT_NEAR(volume_of({through, block}, {negative, part}), 48, 1e-9);
  EXPECT_EQ(notes_.front(), "1 negative volume cuts nothing, as in the slicer: no body comes before it");
  const TriangleMesh pin = box_mesh({2.5, 1.5, 0}, {3.5, 2.5, 2});
  EXPECT_NEAR(volume_of({block, through, pin}, {part, negative, part}), 48 - 8 + 2, 1e-9);
  EXPECT_NEAR(volume_of({block, pin, through}, {part, part, negative}), 48 - 8, 1e-9);
}

TEST_F(ReadThreeMfTest, OlderAndLaterTypesOfVolumes) {
  const auto notes_for = [&](const std::string& type) {
    (void)read(three_mf(object_of({block, beside}), three_mf_item(1),
                        {{"Metadata/Slic3r_PE_model.config", prusa_config({of_type("ModelPart"), type})}}));
    return notes_;
  };
  EXPECT_EQ(notes_for("key=\"modifier\" value=\"1\""),
            (std::vector<std::string>{"1 modifier left out of the part"}));
  EXPECT_EQ(notes_for(of_type("SeamPosition")),
            (std::vector<std::string>{"1 volume of type \"SeamPosition\" left out of the part"}));
  EXPECT_EQ(notes_for("key=\"extruder\" value=\"1\""), std::vector<std::string>{});
}

TEST_F(ReadThreeMfTest, VolumesThatAreNotThere) {
  const std::string config = prusa_config({of_type("ModelPart"), of_type("SupportBlocker")});
  EXPECT_TRUE(contains(refusal_of(three_mf(object_of({block}), three_mf_item(1),
                                           {{"Metadata/Slic3r_PE_model.config", config}})),
                       "has a volume of the triangles 12 to 23 in object 1, which has 12"));
  const TriangleMesh found = read(three_mf(object_of({block, beside, beside}), three_mf_item(1),
                                           {{"Metadata/Slic3r_PE_model.config", config}}));
  EXPECT_EQ(found.triangles.size(), 12u);
  EXPECT_EQ(notes_, (std::vector<std::string>{"1 support blocker left out of the part",
                                              "12 triangles of no volume left out of the part"}));
  std::string damaged = config;
  damaged.replace(damaged.find("firstid=\"12\""), 12, "firstid=\"1x\"");
  EXPECT_TRUE(contains(refusal_of(three_mf(object_of({block, beside}), three_mf_item(1),
                                           {{"Metadata/Slic3r_PE_model.config", damaged}})),
                       "has the number \"1x\" of a triangle, needs one from 0 on of "
                       "\"Metadata/Slic3r_PE_model.config\" in its archive"));
}

/// Parts are components; each of a mesh in another file.
TEST_F(ReadThreeMfTest, PartsOfOrcaSlicerAndBambuStudio) {
  const std::string model = "<model xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\">";
  const std::string meshes = model + "<resources>" + three_mf_object(1, block) + three_mf_object(2, through) +
                             three_mf_object(3, beside) + "</resources><build/></model>";
  std::string whole = "<object id=\"8\" type=\"model\"><components>";
  for (const char* number : {"1", "2", "3"})
    whole +=
        "<component xmlns:p=\"http://schemas.microsoft.com/3dmanufacturing/production/2015/06\" "
        "p:path=\"/3D/Objects/object_1.model\" objectid=\"" +
        std::string(number) + "\" transform=\"1 0 0 0 1 0 0 0 1 10 0 0\"/>";
  whole += "</components></object>";
  const auto settings = [](const std::string& third) {
    return "<config><object id=\"8\"><metadata key=\"name\" value=\"a\"/>"
           "<part id=\"1\" subtype=\"normal_part\"><metadata key=\"name\" value=\"b\"/></part>"
           "<part id=\"2\" subtype=\"negative_part\"/><part id=\"3\" subtype=\"" +
           third +
           "\"/></object><plate><metadata key=\"volume_type\" value=\"NegativeVolume\"/></plate></config>";
  };
  const auto file = [&](const std::string& third) {
    return three_mf(
        whole, three_mf_item(8) + three_mf_item(8, "1 0 0 0 1 0 0 0 1 0 20 0"),
        {{"3D/Objects/object_1.model", meshes}, {"Metadata/model_settings.config", settings(third)}});
  };
  for (const char* third : {"modifier_part", "support_blocker", "support_enforcer"}) {
    const TriangleMesh found = read(file(third));
    EXPECT_NEAR(signed_volume(found), 2 * (48 - 8), 1e-9);
    EXPECT_EQ(bounds(found).low, (Point<3>{10, 0, 0}));
    EXPECT_EQ(bounds(found).high, (Point<3>{16, 24, 2}));
    EXPECT_EQ(notes_.size(), 3u);
  }
  EXPECT_NEAR(signed_volume(read(file("normal_part"))), 2 * (48 - 8 + 36), 1e-9);
}

TEST_F(ReadThreeMfTest, TypesCountAtEveryLevel) {
  for (const std::string type : {"other", "support", "solidsupport", "surface"}) {
    const std::string objects =
        three_mf_object(1, box) + three_mf_object(2, beside, type) + three_mf_components(3, {1, 2});
    const TriangleMesh found = read(three_mf(objects, three_mf_item(3)));
    EXPECT_EQ(found.triangles.size(), 12u);
    EXPECT_EQ(notes_, (std::vector<std::string>{"1 object of type \"" + type + "\" left out of the part"}));
    EXPECT_TRUE(contains(refusal_of(three_mf(objects, three_mf_item(2))),
                         "has nothing but 1 object of type \"" + type + "\"; needs a body"));
    const TriangleMesh all = read(three_mf(objects, three_mf_item(3)), ThreeMfObjects::surfaces_too);
    EXPECT_EQ(all.triangles.size(), type == "surface" ? 24u : 12u);
  }
}

TEST_F(ReadThreeMfTest, RequiredExtensions) {
  const auto file = [](const std::string& required, const std::string& more = "") {
    const std::string spaces =
        " xmlns:b=\"http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02\""
        " xmlns:m=\"http://schemas.microsoft.com/3dmanufacturing/material/2015/02\""
        " xmlns:x=\"http://somewhere.else/2020";
    return three_mf(three_mf_object(1, box) + more, three_mf_item(1), {}, false,
                    "millimeter\" requiredextensions=\"" + required + "\"" + spaces);
  };
  EXPECT_EQ(read(file("")).triangles.size(), 12u);
  EXPECT_EQ(read(file("m")).triangles.size(), 12u);
  EXPECT_TRUE(contains(refusal_of(file(" m  b")),
                       "requires the extension \"beamlattice\" of 3MF, which is not read"));
  EXPECT_TRUE(contains(refusal_of(file("x")), "requires the extension \"http://somewhere.else/2020\""));
  EXPECT_TRUE(contains(refusal_of(file("y")), "requires the extension \"y\""));
  const std::string lattice =
      "<b:beamlattice radius=\"1\" minlength=\"0.0001\"><b:beams/></b:beamlattice></mesh>";
  std::string beams = three_mf_object(2, box);
  beams.replace(beams.find("</mesh>"), 7, lattice);
  EXPECT_EQ(read(file("", beams)).triangles.size(), 12u);
  EXPECT_EQ(notes_, (std::vector<std::string>{"1 beam lattice, which is not read, left out of the part"}));
  EXPECT_TRUE(contains(refusal_of(file("", "<object id=\"2\"><x:booleanshape objectid=\"1\"/></object>")),
                       "has a \"booleanshape\" as object 2, which is not read"));
}

/// A slicer's command line names a picture and makes none.
TEST_F(ReadThreeMfTest, RelationsToWhatIsNotThere) {
  const TriangleMesh found =
      read(three_mf(three_mf_object(1, box), three_mf_item(1), {{"Metadata/thumbnail.png", ""}}));
  EXPECT_EQ(found.triangles.size(), 12u);
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
