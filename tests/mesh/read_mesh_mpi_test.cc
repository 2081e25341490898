// SPDX-License-Identifier: MIT
#include "fabseq/mesh/read_mesh.h"
#include "support/io_support.h"
#include "support/mesh_files.h"
#include "support/meshes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <sys/stat.h>
#include <utility>

namespace fabseq {
namespace {

using test::ascii_stl;
using test::binary_stl;
using test::box_mesh;
using test::contains;
using test::is_first;
using test::obj;
using test::ply;
using test::three_mf;
using test::three_mf_item;
using test::three_mf_object;

const TriangleMesh box = box_mesh({1, 2, 3}, {2, 4, 7});

class ReadMeshTest : public testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& text) const {
    if (is_first()) std::ofstream(scratch_.file(name), std::ios::binary) << text;
    MPI_Barrier(PETSC_COMM_WORLD);
    return scratch_.file(name);
  }
  TriangleMesh read(const std::string& name, const std::string& text) const {
    return read_mesh(PETSC_COMM_WORLD, write(name, text), "/part/mesh/file").mesh;
  }
  static std::string refusal_of(const std::string& path) {
    std::string text =
        test::error_text<InputError>([&] { (void)read_mesh(PETSC_COMM_WORLD, path, "/part/mesh/file"); });
    EXPECT_EQ(text.rfind("/part/mesh/file: '" + path + "': ", 0), 0u) << text;
    return text;
  }
  std::string refusal_of(const std::string& name, const std::string& text) const {
    return refusal_of(write(name, text));
  }
  std::string file(const std::string& name) const { return scratch_.file(name); }

 private:
  test::ScratchDirectory scratch_;
};

void expect_box(const TriangleMesh& found, double shift = 0.0) {
  EXPECT_EQ(found.points.size(), 8u);
  EXPECT_EQ(found.triangles.size(), 12u);
  EXPECT_TRUE(is_closed(found));
  EXPECT_NEAR(signed_volume(found), 8.0, 1e-12);
  EXPECT_EQ(bounds(found).low, (Point<3>{1 + shift, 2, 3}));
  EXPECT_EQ(bounds(found).high, (Point<3>{2 + shift, 4, 7}));
}

TEST_F(ReadMeshTest, EachFormat) {
  expect_box(read("ascii.stl", ascii_stl(box)));
  expect_box(read("binary.stl", binary_stl(box)));
  expect_box(read("upper case.STL", binary_stl(box)));
  expect_box(read("part.obj", obj(box)));
  expect_box(read("part.ply", ply(box)));
  const std::string shifted = three_mf_item(1, "1 0 0 0 1 0 0 0 1 10 0 0");
  expect_box(read("part.3mf", three_mf(three_mf_object(1, box), shifted)), 10.0);
}

TEST_F(ReadMeshTest, JoinsSeveralSolids) {
  const TriangleMesh other = box_mesh({5, 5, 5}, {6, 6, 6});
  const TriangleMesh found = read("two.stl", ascii_stl(box) + ascii_stl(other));
  EXPECT_EQ(found.points.size(), 16u);
  EXPECT_NEAR(signed_volume(found), 9.0, 1e-12);
  EXPECT_TRUE(is_closed(found));
}

TEST_F(ReadMeshTest, ManyPointsAreJoined) {
  const TriangleMesh torus = test::torus_mesh(2, 1, 100, 60);
  const TriangleMesh found = read("torus.stl", binary_stl(torus));
  EXPECT_EQ(found.points.size(), torus.points.size());
  EXPECT_EQ(found.triangles.size(), torus.triangles.size());
  EXPECT_TRUE(is_closed(found));
  EXPECT_NEAR(signed_volume(found), signed_volume(torus), 1e-5);
}

/// A prism over an L, its faces polygons, among lines, points and points that nothing uses.
TEST_F(ReadMeshTest, PolygonsLinesAndPoints) {
  const std::string prism =
      "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\n"
      "v 0 0 1\nv 2 0 1\nv 2 1 1\nv 1 1 1\nv 1 2 1\nv 0 2 1\nv 9 9 9\n"
      "f 6 5 4 3 2 1\nf 7 8 9 10 11 12\nf 1 2 8 7\nf 2 3 9 8\nf 3 4 10 9\nf 4 5 11 10\nf 5 6 12 11\n"
      "f 6 1 7 12\nl 1 9\np 2\n";
  const TriangleMesh found = read("l.obj", prism);
  EXPECT_EQ(found.points.size(), 12u);
  EXPECT_EQ(found.triangles.size(), 20u);
  EXPECT_TRUE(is_closed(found));
  EXPECT_NEAR(signed_volume(found), 3.0, 1e-12);
  EXPECT_EQ(bounds(found).high, (Point<3>{2, 2, 1}));
}

TEST_F(ReadMeshTest, DegenerateTrianglesAreLeftOut) {
  TriangleMesh mesh = box;
  mesh.triangles.push_back({3, 3, 5});
  mesh.triangles.push_back({7, 7, 7});
  mesh.points.push_back({-0.0, 0, 0});
  mesh.points.push_back({0, -0.0, 0});
  mesh.triangles.push_back({8, 1, 9});  // zeros of either sign are the same point
  for (const TriangleMesh& found : {read("a.stl", binary_stl(mesh)), read("a.ply", ply(mesh))}) {
    EXPECT_EQ(found.triangles.size(), 12u);
    EXPECT_TRUE(is_closed(found));
  }
}

/// Without the flat triangle in the seam, the surface would have a slit.
TEST_F(ReadMeshTest, TrianglesOfNoAreaStay) {
  const std::string seam = "v 0 0 0\nv 2 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\nf 1 3 4\nf 3 2 4\nf 1 4 2\n";
  const TriangleMesh found = read("seam.obj", seam);
  EXPECT_EQ(found.triangles.size(), 4u);
  EXPECT_TRUE(is_closed(found));
}

TEST_F(ReadMeshTest, RefusesWhatIsNoRegularFile) {
  EXPECT_TRUE(
      contains(refusal_of(file("missing.stl")), "(No such file or directory), needs a readable file"));
  EXPECT_TRUE(contains(refusal_of("/dev/zero"), "is a directory, pipe or device, needs a regular file"));
  if (is_first()) {
    std::filesystem::create_directory(file("folder.stl"));
    EXPECT_EQ(mkfifo(file("pipe.stl").c_str(), 0600), 0);
  }
  MPI_Barrier(PETSC_COMM_WORLD);
  EXPECT_TRUE(contains(refusal_of(file("folder.stl")), "needs a regular file"));
  EXPECT_TRUE(contains(refusal_of(file("pipe.stl")), "needs a regular file"));
}

TEST_F(ReadMeshTest, RefusesOtherFormatsAndDamage) {
  const std::string needs = "needs an intact STL, OBJ, PLY or 3MF file";
  EXPECT_TRUE(contains(refusal_of("part.step", "ISO-10303-21;\nHEADER;\n"), needs));
  EXPECT_TRUE(contains(refusal_of("empty.stl", ""), needs));
  EXPECT_TRUE(contains(refusal_of("noise.3mf", "PK no archive"), needs));
  EXPECT_TRUE(contains(refusal_of("short.stl", binary_stl(box).substr(0, 300)), needs));
  EXPECT_TRUE(contains(refusal_of("short.ply", ply(box).substr(0, 100)), "needs an intact PLY file"));
}

TEST_F(ReadMeshTest, NamesOtherFormats) {
  const std::string iges = std::string(72, ' ') + "S      1\n" + std::string(72, ' ') + "G      1\n";
  const std::pair<std::string, std::string> files[] = {
      {"version https://git-lfs.github.com/spec/v1\noid sha256:4d\nsize 12345\n", "a pointer of Git LFS"},
      {"\n<!DOCTYPE html><html></html>", "an HTML page"},
      {"\x1f\x8b\b" + std::string(100, '\1'), "a gzip archive"},
      {"ISO-10303-21;\nHEADER;\n", "a STEP file, which has no triangles"},
      {iges, "an IGES file, which has no triangles"},
      {"%PDF-1.4", "a PDF document"},
      {"# corners\nOFF\n8 12 0\n0 0 0\n", "an OFF file: export its surface as STL, OBJ, PLY or 3MF; needs"},
      {"COFF 8 12 0\n", "an OFF file"},
      {"    -1\n  2411\n         1         1\n", "an I-DEAS file (UNV): export its surface"},
      {"$ from a mesher\nSOL 101\nCEND\nBEGIN BULK\n", "a Nastran file (BDF)"},
      {"GRID           1          0.00    0.00    0.00\n", "a Nastran file (BDF)"},
      {"** from a mesher\n*Heading\n*NODE\n1, 0., 0., 0.\n", "an Abaqus or CalculiX file (INP)"},
      {"# vtk DataFile Version 3.0\n", "a VTK file"},
      {"<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\">", "a VTK file: export its surface"},
      {"<?xml version=\"1.0\"?><amf unit=\"mm\">", "an AMF file"},
      {"<?xml version=\"1.0\"?><cats/>", "an XML file outside a ZIP archive: no format that is known; needs"},
      {"3D Geometry File Format        5", "a Rhino file (3DM), which has no triangles"},
      {"$MeshFormat\n4.1 0 8\n", "a Gmsh file (MSH)"},
      {"", "is empty"},
      {" \n", "is empty"},
      {"no surface", "no surface that can be read"}};
  for (const auto& [content, words] : files)
    EXPECT_TRUE(contains(refusal_of("part.stl", content), words)) << words;
  EXPECT_TRUE(contains(refusal_of("part.SAT", "400 0 1 0\n"), "an ACIS file (SAT), which has no triangles"));
  EXPECT_TRUE(contains(refusal_of("part.unv", "no surface"), "an I-DEAS file (UNV)"));
  EXPECT_TRUE(contains(refusal_of("part.zip", test::zip({{"a/b.STL", "solid"}})),
                       "a ZIP archive with \"a/b.STL\" in it: unpack it first"));
  EXPECT_TRUE(contains(refusal_of("part.FCStd", test::zip({{"Document.xml", "<x/>"}})), "a FreeCAD file"));
}

/// 3MF names its unit.
TEST_F(ReadMeshTest, Units) {
  const std::string content = three_mf(three_mf_object(1, box), three_mf_item(1));
  const std::string path = write("part.3mf", content);
  for (const auto& [unit, factor] : std::vector<std::pair<std::string, double>>{{"mm", 1},
                                                                                {"Millimetres", 1},
                                                                                {"", 1},
                                                                                {"rod", 1},
                                                                                {"cm", 0.1},
                                                                                {"m", 1e-3},
                                                                                {"um", 1e3},
                                                                                {"inch", 1 / 25.4},
                                                                                {"in", 1 / 25.4},
                                                                                {"feet", 1 / 304.8}}) {
    const ReadMesh found = read_mesh(PETSC_COMM_WORLD, path, "/part/mesh/file", unit);
    EXPECT_NEAR(found.unit_factor / factor, 1.0, 1e-12) << unit;
    EXPECT_NEAR(bounds(found.mesh).high[2], 7 * found.unit_factor, 1e-9) << unit;
  }
}

TEST_F(ReadMeshTest, FormatsUnderOtherNames) {
  expect_box(read("part.obj", ascii_stl(box)));
  expect_box(read("part.obj", binary_stl(box)));
  expect_box(read("part.stl", obj(box)));
  expect_box(read("part", ply(box)));
}

/// With a count that no longer fits.
TEST_F(ReadMeshTest, ToldWhatIsDone) {
  testing::internal::CaptureStderr();
  expect_box(read("more.stl", binary_stl(box) + "more"));
  const std::string told = testing::internal::GetCapturedStderr();
  if (is_first()) {
    EXPECT_TRUE(contains(told, "more.stl': 4 bytes behind the last triangle are left out")) << told;
  }
}

TEST_F(ReadMeshTest, RefusesFilesWithoutTriangles) {
  const std::string needs = "needs a surface";
  EXPECT_TRUE(contains(refusal_of("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\np 1\nl 1 2\n"), needs));
  EXPECT_TRUE(contains(refusal_of("flat.obj", "v 0 0 0\nv 1 0 0\nf 1 2 1\n"), needs));
}

TEST_F(ReadMeshTest, RefusesCoordinatesThatAreNotFinite) {
  for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    TriangleMesh mesh = box;
    mesh.points[3][1] = bad;
    EXPECT_TRUE(contains(refusal_of("bad.stl", binary_stl(mesh)), "needs coordinates up to 1e+30")) << bad;
  }
}

/// The file of materials is a pipe in which nobody writes.
TEST_F(ReadMeshTest, DoesNotWaitForOtherFiles) {
  if (is_first()) {
    EXPECT_EQ(mkfifo(file("pipe.mtl").c_str(), 0600), 0);
  }
  expect_box(read("part.obj", "mtllib pipe.mtl\n" + obj(box)));
}

}  // namespace
}  // namespace fabseq
