// SPDX-License-Identifier: MIT
#include "mesh/mesh_formats.h"
#include "support/io_support.h"
#include "support/mesh_files.h"
#include "support/meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>

namespace fabseq {
namespace {

using test::ascii_stl;
using test::binary_stl;
using test::box_mesh;
using test::contains;

const TriangleMesh box = box_mesh({1, 2, 3}, {2, 4, 7});

class ReadStlTest : public testing::Test {
 protected:
  TriangleMesh read(const std::string& content) {
    notes_.clear();
    EXPECT_TRUE(looks_like_stl(content, true));
    return read_stl(content, notes_);
  }
  void expect_box(const std::string& content, const std::string& note = "") {
    const TriangleMesh found = read(content);
    EXPECT_EQ(found.triangles.size(), 12u);
    EXPECT_TRUE(is_closed(found));
    EXPECT_NEAR(signed_volume(found), 8.0, 1e-12);
    ASSERT_EQ(notes_.size(), note.empty() ? 0u : 1u);
    if (!note.empty()) {
      EXPECT_EQ(notes_[0], note);
    }
  }
  std::string refusal_of(const std::string& content) {
    return test::error_text<InputError>([&] { (void)read(content); });
  }

  std::vector<std::string> notes_;
};

std::string replaced(std::string text, const std::string& old, const std::string& by) {
  for (std::size_t at = 0; (at = text.find(old, at)) != std::string::npos; at += by.size())
    text.replace(at, old.size(), by);
  return text;
}

/// A binary file that states another number of triangles.
std::string with_count(std::string binary, std::uint32_t count) {
  return binary.replace(80, 4, test::bytes(count));
}

TEST_F(ReadStlTest, TextInManyHands) {
  const std::string text = ascii_stl(box);
  std::string upper = text;
  std::transform(upper.begin(), upper.end(), upper.begin(), [](unsigned char c) { return std::toupper(c); });
  expect_box(upper);
  expect_box("\n\r\n  \t" + text);
  expect_box("\xef\xbb\xbf" + text);
  expect_box(replaced(text, "\n", "\r"));
  expect_box(replaced(text, "\n", "\r\n"));
  expect_box(replaced(text, ".000000", ",000000"));
  expect_box(replaced(text, "normal 0 0 0", "normal nan -nan 1.#IND"));
  expect_box(replaced(text, "solid part", "solid facet vertex of " + std::string(200, 'x')));
}

TEST_F(ReadStlTest, BinaryWithHeaderLikeText) {
  expect_box("solid" + binary_stl(box).substr(5));
  expect_box("%PDF-" + binary_stl(box).substr(5));
}

TEST_F(ReadStlTest, BytesBehindTheLastTriangle) {
  expect_box(binary_stl(box) + "0123456789", "10 bytes behind the last triangle are left out");
}

TEST_F(ReadStlTest, CountsThatDoNotFit) {
  for (const std::uint32_t count : {0u, 11u, 14u, 4000000000u})
    expect_box(with_count(binary_stl(box), count),
               "says that it has " + std::to_string(count) +
                   " triangles, but has 12, a closed surface: all are read");
  const TriangleMesh open = test::open_box_mesh({1, 2, 3}, {2, 4, 7});
  EXPECT_TRUE(contains(refusal_of(with_count(binary_stl(open), 12)),
                       "says that it has 12 triangles, but has bytes for 10: it is cut off"));
  EXPECT_TRUE(contains(refusal_of(binary_stl(box).substr(0, 300)), "cut off"));
}

TEST_F(ReadStlTest, TextThatIsCutOff) {
  const std::string text = ascii_stl(box);
  expect_box(text.substr(0, text.rfind("endsolid")), "has no \"endsolid\" at its end: it may be cut off");
  EXPECT_TRUE(contains(refusal_of(text.substr(0, text.rfind("endfacet"))), "ends within a facet"));
}

TEST_F(ReadStlTest, RefusesOtherWords) {
  const std::string text = ascii_stl(box);
  EXPECT_TRUE(contains(refusal_of(replaced(text, "vertex 2.000000 4", "vertex 2.0x 4")),
                       "has \"2.0x\" in line 6, needs a coordinate"));
  EXPECT_TRUE(contains(refusal_of(replaced(text, "endloop", "endlopp")), "has \"endlopp\" in line 7"));
}

/// Single precision has steps of 4 there.
TEST_F(ReadStlTest, FarFromTheOrigin) {
  std::string text = ascii_stl(box);
  for (const char* corner : {"1.000000 ", "2.000000 "})
    text = replaced(text, std::string("vertex ") + corner, std::string("vertex 5000000") + corner);
  const TriangleMesh found = read(text);
  EXPECT_EQ(found.triangles.size(), 12u);
  EXPECT_TRUE(is_closed(found));
  EXPECT_NEAR(signed_volume(found), 8.0, 1e-6);
  EXPECT_EQ(bounds(found).low[0], 50000001.0);
}

/// As programs write numbers of double precision.
TEST_F(ReadStlTest, LastDigitsThatDiffer) {
  std::string text = replaced(ascii_stl(box_mesh({0.3, 2, 3}, {1.3, 4, 7})), "0.300000", "0.3");
  text.replace(text.find("0.3"), 3, "0.30000000000000004");
  const TriangleMesh found = read(text);
  EXPECT_EQ(found.points.size(), 8u);
  EXPECT_TRUE(is_closed(found));
}

}  // namespace
}  // namespace fabseq
