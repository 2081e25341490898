// SPDX-License-Identifier: MIT
#include "mesh/cut_elements.h"

#include "support/meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

namespace fabseq {
namespace {

const ElementLattice lattice = {{-1.0, 0.5, 2.0}, {0.5, 0.25, 2.0}};

/// Whether a triangle and a box have a point in common: the triangle is cut off at the six planes.
bool zeros_if_empty(const std::array<Point<3>, 3>& corners, const Point<3>& low, const Point<3>& high) {
  std::vector<Point<3>> polygon(corners.begin(), corners.end());
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {1.0, -1.0}) {
      const auto inwards = [&](const Point<3>& p) {
        return side * (p[axis] - (side > 0 ? low : high)[axis]);
      };
      std::vector<Point<3>> kept;
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Point<3>&p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
        const double at_p = inwards(p), at_q = inwards(q);
        if (at_p >= 0) kept.push_back(p);
        if ((at_p >= 0) == (at_q >= 0)) continue;
        Point<3> cut;
        for (int a = 0; a < 3; ++a) cut[a] = p[a] + (q[a] - p[a]) * at_p / (at_p - at_q);
        kept.push_back(cut);
      }
      polygon = kept;
    }
  return !polygon.empty();
}

std::int64_t count(const std::vector<char>& marks) { return std::accumulate(marks.begin(), marks.end(), 0); }

TEST(CutElementsTest, RandomTrianglesAgainstClipping) {
  const IndexBox<3> box = {{-3, 2, -1}, {9, 10, 5}};
  std::mt19937 engine(3);
  std::uniform_real_distribution<double> place(-4, 12);
  for (int repeat = 0; repeat < 200; ++repeat) {
    const double size = repeat % 2 == 0 ? 1.0 : 0.1;
    TriangleMesh mesh;
    const Point<3> middle = {place(engine), place(engine), place(engine)};
    for (int corner = 0; corner < 3; ++corner) {
      Point<3> element;  // in elements
      for (int axis = 0; axis < 3; ++axis) element[axis] = middle[axis] + size * (place(engine) - 4);
      mesh.points.push_back(lattice.point_of({0, 0, 0}, element));
    }
    mesh.triangles = {{0, 1, 2}};
    const std::vector<char> marks = cut_elements(mesh, lattice, box);
    box.for_each([&](const Index<3>& element, std::int64_t offset) {
      EXPECT_EQ(marks[offset] != 0, zeros_if_empty(mesh.corners(0), lattice.point_of(element, {0, 0, 0}),
                                                   lattice.point_of(element, {1, 1, 1})))
          << repeat << " " << to_text<3>(element);
    });
  }
}

TEST(CutElementsTest, FaceBetweenElementsMarksBoth) {
  // From the middles of elements to those two further, at the lower faces of the elements 3 along z.
  const TriangleMesh plate = {
      {lattice.point_of({1, 1, 3}, {0.5, 0.5, 0}), lattice.point_of({3, 1, 3}, {0.5, 0.5, 0}),
       lattice.point_of({3, 3, 3}, {0.5, 0.5, 0}), lattice.point_of({1, 3, 3}, {0.5, 0.5, 0})},
      {{0, 1, 2}, {0, 2, 3}}};
  const IndexBox<3> box = {{0, 0, 0}, {6, 6, 6}};
  const std::vector<char> marks = cut_elements(plate, lattice, box);
  EXPECT_EQ(count(marks), 2 * 3 * 3);
  EXPECT_TRUE(marks[box.offset({2, 2, 2})] != 0 && marks[box.offset({2, 2, 3})] != 0);
}

TEST(CutElementsTest, SubBoxesSeeTheSame) {
  const ElementLattice fine = {{-1.3, -1.3, -1.3}, {0.13, 0.17, 0.11}};
  const TriangleMesh sphere = test::sphere_mesh(1, 6);
  const IndexBox<3> whole = {{0, 0, 0}, {20, 16, 24}}, part = {{3, 5, 7}, {11, 4, 9}};
  const std::vector<char> all = cut_elements(sphere, fine, whole), some = cut_elements(sphere, fine, part);
  part.for_each([&](const Index<3>& element, std::int64_t offset) {
    EXPECT_EQ(some[offset], all[whole.offset(element)]) << to_text<3>(element);
  });
  EXPECT_GT(count(some), 0);
}

TEST(CutElementsTest, PointsLinesAndFarAwayTriangles) {
  const IndexBox<3> box = {{0, 0, 0}, {4, 4, 4}};
  const Point<3> inside = lattice.point_of({1, 2, 3}, {0.5, 0.5, 0.5});
  EXPECT_EQ(count(cut_elements({{inside}, {{0, 0, 0}}}, lattice, box)), 1);
  const Point<3> beside = lattice.point_of({3, 2, 3}, {0.5, 0.5, 0.5});
  EXPECT_EQ(count(cut_elements({{inside, beside}, {{0, 1, 1}}}, lattice, box)), 3);
  const TriangleMesh away = {{{1e30, 0, 0}, {2e30, 1e30, 0}, {1e30, 1e30, 1e30}}, {{0, 1, 2}}};
  EXPECT_EQ(count(cut_elements(away, lattice, box)), 0);
  EXPECT_TRUE(cut_elements(away, lattice, {{0, 0, 0}, {4, 0, 4}}).empty());
}

}  // namespace
}  // namespace fabseq
