// SPDX-License-Identifier: MIT
#include "mesh/mesh_formats.h"
#include "support/io_support.h"
#include "support/mesh_files.h"
#include "support/meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstdint>

namespace fabseq {
namespace {

using test::box_mesh;
using test::contains;
using test::ply;

const TriangleMesh box = box_mesh({1, 2, 3}, {2, 4, 7});

template <class T>
std::string ordered(T value, bool big_endian) {
  std::string text = test::bytes(value);
  if (big_endian) std::reverse(text.begin(), text.end());
  return text;
}

std::string header(const std::string& form, const std::string& elements) {
  return "ply\nformat " + form + " 1.0\ncomment by hand\n" + elements + "end_header\n";
}
std::string points_and_faces(std::size_t points, std::size_t faces, const std::string& coordinate = "float") {
  std::string text = "element vertex " + std::to_string(points) + "\n";
  for (const char* axis : {"x", "y", "z"}) text += "property " + coordinate + " " + axis + "\n";
  return text + "property uchar red\nelement face " + std::to_string(faces) +
         "\nproperty uchar flags\nproperty list uchar uint vertex_index\n";
}

/// With a colour a vertex and flags a face.
template <class Coordinate>
std::string binary_ply(const TriangleMesh& mesh, bool big_endian, const std::string& coordinate) {
  std::string text = header(big_endian ? "binary_big_endian" : "binary_little_endian",
                            points_and_faces(mesh.points.size(), mesh.triangles.size(), coordinate));
  for (const Point<3>& point : mesh.points) {
    for (const double value : point) text += ordered(static_cast<Coordinate>(value), big_endian);
    text += '\xff';
  }
  for (const auto& triangle : mesh.triangles) {
    text += std::string(1, '\0') + '\3';
    for (const std::int32_t corner : triangle)
      text += ordered(static_cast<std::uint32_t>(corner), big_endian);
  }
  return text;
}

class ReadPlyTest : public testing::Test {
 protected:
  static TriangleMesh read(const std::string& content) { return read_ply(content); }
  static std::string refusal_of(const std::string& content) {
    return test::error_text<InputError>([&] { (void)read(content); });
  }
};

void expect_equal(const TriangleMesh& found, const TriangleMesh& expected) {
  EXPECT_EQ(found.triangles.size(), expected.triangles.size());
  EXPECT_NEAR(signed_volume(found), signed_volume(expected), 1e-12);
  EXPECT_EQ(bounds(found).low, bounds(expected).low);
  EXPECT_EQ(bounds(found).high, bounds(expected).high);
}

TEST_F(ReadPlyTest, BinaryInBothOrders) {
  for (const bool big_endian : {false, true}) {
    expect_equal(read(binary_ply<float>(box, big_endian, "float")), box);
    expect_equal(read(binary_ply<double>(box, big_endian, "float64")), box);
  }
}

/// The lowest byte of the first coordinate is one.
TEST_F(ReadPlyTest, BinaryDataThatBeginWithALineFeed) {
  const auto first = std::bit_cast<float>(std::uint32_t{0x3f80000a});
  const TriangleMesh shifted = box_mesh({first, 2, 3}, {2, 4, 7});
  expect_equal(read(binary_ply<float>(shifted, false, "float")), shifted);
}

TEST_F(ReadPlyTest, LineEndsOfOtherSystems) {
  for (const std::string end : {"\r\n", "\r"}) {
    std::string text;
    for (const char c : ply(box)) text += c == '\n' ? end : std::string(1, c);
    expect_equal(read(text), box);
  }
}

TEST_F(ReadPlyTest, DigitsOfDoublePrecision) {
  const TriangleMesh far = box_mesh({50000001.25, 2, 3}, {50000002.25, 4, 7});
  expect_equal(read(binary_ply<double>(far, false, "double")), far);
}

/// A tetrahedron as one strip, and as two of which the second is begun by -1.
TEST_F(ReadPlyTest, Strips) {
  const std::string points =
      "element vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement tristrips 1\n"
      "property list int int vertex_indices\n";
  const std::string corners = "0 0 0\n3 0 0\n0 3 0\n0 0 3\n";
  for (const std::string strips : {"6 0 2 1 3 0 2\n", "9 0 2 1 3 -1 1 3 0 2\n"}) {
    const TriangleMesh found = read(header("ascii", points) + corners + strips);
    EXPECT_EQ(found.triangles.size(), 4u) << strips;
    EXPECT_TRUE(is_closed(found)) << strips;
    EXPECT_NEAR(signed_volume(found), 4.5, 1e-12) << strips;
  }
}

TEST_F(ReadPlyTest, IndexThatIsNone) {
  const std::string corners = "0 0 0 1\n3 0 0 1\n0 3 0 1\n",
                    start = header("ascii", points_and_faces(3, 1)) + corners;
  EXPECT_EQ(read(start + "0 3 0 1 2\n").triangles.size(), 1u);
  for (const std::string index : {"3", "-1", "4294967295", "1e300", "nan", "-inf"})
    EXPECT_TRUE(
        contains(refusal_of(start + "0 3 0 1 " + index + "\n"), "in triangle or polygon 1 of a surface"))
        << index;
}

TEST_F(ReadPlyTest, Damage) {
  const std::string whole = ply(box), binary = binary_ply<float>(box, false, "float");
  EXPECT_TRUE(contains(refusal_of(whole.substr(0, 60)), "ends before its header does"));
  EXPECT_TRUE(contains(refusal_of(whole.substr(0, whole.size() - 9)), "ends before its data do"));
  EXPECT_TRUE(contains(refusal_of(binary.substr(0, binary.size() - 1)), "ends before its data do"));
  EXPECT_TRUE(
      contains(refusal_of(header("ascii", "element vertex -1\n")), "\"element vertex -1\" in its header"));
  EXPECT_TRUE(contains(refusal_of(header("ascii", "property float x\n")), "in its header"));
  EXPECT_TRUE(contains(refusal_of(header("ascii", "element vertex 1\nproperty word x\n")), "in its header"));
  EXPECT_TRUE(contains(refusal_of(header("middle_endian", "")), "in its header"));
  EXPECT_TRUE(
      contains(refusal_of(header("ascii", "element vertex 1\nproperty float x\n") + "0\n"), "no property y"));
  EXPECT_TRUE(contains(refusal_of(header("ascii", points_and_faces(1, 0)) + "0 zero 0 1\n"),
                       "where a number belongs"));
  EXPECT_TRUE(contains(refusal_of(header("ascii", points_and_faces(1, 1)) + "0 0 0 1\n0 -3 0 0 0\n"), "-3"));
  EXPECT_TRUE(contains(refusal_of(header("ascii", points_and_faces(1, 1)) + "0 0 0 1\n0 1e9 0 0 0\n"),
                       "ends before"));
  EXPECT_TRUE(contains(
      refusal_of(header("ascii", "element face 1\nproperty list uchar int vertex_index\n") + "3 0 1 2\n"),
      "vertices first"));
}

}  // namespace
}  // namespace fabseq
