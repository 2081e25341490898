// SPDX-License-Identifier: MIT
#include "fabseq/mesh/mesh_interior.h"

#include "support/meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace fabseq {
namespace {

using test::append;
using test::box_mesh;

FillFractions fractions(const TriangleMesh& mesh, const ElementLattice& lattice, const IndexBox<3>& box) {
  return MeshInterior(mesh).fill_fractions(lattice, box);
}

/// n elements along each axis from -extent to extent, and a little more on one side.
ElementLattice around_origin(double extent, int n) {
  return {{-extent, -extent, -extent}, {2.01 * extent / n, 2.02 * extent / n, 2.03 * extent / n}};
}

double volume(const FillFractions& result, const ElementLattice& lattice) {
  return std::accumulate(result.of_element.begin(), result.of_element.end(), 0.0) * lattice.spacing[0] *
         lattice.spacing[1] * lattice.spacing[2];
}

double volume(const TriangleMesh& mesh, double extent, int n) {
  const ElementLattice lattice = around_origin(extent, n);
  return volume(fractions(mesh, lattice, {{0, 0, 0}, {n, n, n}}), lattice);
}

TEST(MeshInteriorTest, SphereConverges) {
  const TriangleMesh sphere = test::sphere_mesh(1, 60);
  const double exact = signed_volume(sphere);
  EXPECT_NEAR(volume(sphere, 1.1, 10), exact, 4e-3 * exact);
  EXPECT_NEAR(volume(sphere, 1.1, 20), exact, 1e-3 * exact);
  EXPECT_NEAR(volume(sphere, 1.1, 40), exact, 2.5e-4 * exact);
}

TEST(MeshInteriorTest, TorusConverges) {
  const TriangleMesh torus = test::torus_mesh(1, 0.3, 160, 60);
  const double exact = signed_volume(torus);
  // Whole circles of it touch planes of samples: samples of the exact torus have these errors, too.
  EXPECT_NEAR(volume(torus, 1.4, 20), exact, 6e-3 * exact);
  EXPECT_NEAR(volume(torus, 1.4, 40), exact, 2e-3 * exact);
  EXPECT_NEAR(volume(torus, 1.4, 80), exact, 1e-3 * exact);
}

TEST(MeshInteriorTest, AlignedBoxIsExact) {
  const ElementLattice lattice = {{-1, -2, -3}, {0.5, 0.25, 2}};
  const TriangleMesh box = box_mesh({0, -1, -1}, {2, 0.5, 5});  // elements 2 to 5, 4 to 9, 1 to 3
  const IndexBox<3> elements = {{0, 0, 0}, {8, 12, 6}}, inside = {{2, 4, 1}, {4, 6, 3}};
  const FillFractions result = fractions(box, lattice, elements);
  elements.for_each([&](const Index<3>& element, std::int64_t offset) {
    EXPECT_EQ(result.of_element[offset], inside.contains(element) ? 1.0 : 0.0) << to_text<3>(element);
  });
  EXPECT_EQ(result.clarity.unclear, 0);
}

/// Faces through the midpoints of samples: of two opposite ones, one gets them.
TEST(MeshInteriorTest, FacesThroughSamplesAreClear) {
  const ElementLattice lattice = {{0, 0, 0}, {1, 1, 1}};
  for (const double start : {0.125, 0.375, 0.625, 0.875}) {
    const double end = start + 3;
    const FillFractions result =
        fractions(box_mesh({start, start, start}, {end, end, end}), lattice, {{0, 0, 0}, {5, 5, 5}});
    EXPECT_NEAR(volume(result, lattice), 27.0, 1e-12) << start;
    EXPECT_EQ(result.clarity.unclear, 0) << start;
  }
}

TEST(MeshInteriorTest, MisalignedAndTurnedBox) {
  const ElementLattice lattice = {{0, 0, 0}, {1, 1, 1}};
  const FillFractions shifted =
      fractions(box_mesh({0.25, 1.5, 1}, {3.5, 3, 2.75}), lattice, {{0, 0, 0}, {4, 4, 4}});
  EXPECT_NEAR(volume(shifted, lattice), 3.25 * 1.5 * 1.75, 1e-12);  // multiples of samples
  EXPECT_EQ(shifted.of_element[0 + 4 * (1 + 4 * 1)], 0.75 * 0.5);
  const double c = std::cos(0.5), s = std::sin(0.5);
  const TriangleMesh turned = transformed(box_mesh({-1, -0.5, -0.7}, {1, 0.5, 0.7}),
                                          {{{c, -s * c, s * s}, {s, c * c, -c * s}, {0, s, c}}}, {});
  EXPECT_NEAR(volume(turned, 1.5, 20), 2.8, 0.003);
  EXPECT_NEAR(volume(turned, 1.5, 40), 2.8, 0.001);
}

TEST(MeshInteriorTest, OverlapCountsOnce) {
  TriangleMesh boxes = box_mesh({-1, -1, -1}, {0.5, 0.5, 0.5});
  append(boxes, box_mesh({0, 0, 0}, {1, 1, 1}));
  const double exact = 1.5 * 1.5 * 1.5 + 1 - 0.125;
  EXPECT_NEAR(volume(boxes, 1.2, 40), exact, 0.01 * exact);
}

TEST(MeshInteriorTest, InsideOutIsTheSame) {
  const TriangleMesh sphere = test::sphere_mesh(1, 10);
  const ElementLattice lattice = around_origin(1.2, 12);
  const IndexBox<3> box = {{0, 0, 0}, {12, 12, 12}};
  EXPECT_EQ(fractions(sphere, lattice, box).of_element,
            fractions(test::inside_out(sphere), lattice, box).of_element);
}

TEST(MeshInteriorTest, OpenBoxIsFilledUpToItsRim) {
  const TriangleMesh box = test::open_box_mesh({-0.5, -0.5, -1}, {0.5, 0.5, 1});
  const ElementLattice lattice = around_origin(1.2, 36);
  const IndexBox<3> elements = {{0, 0, 0}, {36, 36, 36}};
  const FillFractions result = fractions(box, lattice, elements);
  // The winding number is 1/2 on a surface that is stretched over the rim and sags: 11/12 at the middle of
  // the top, where a cube would have 5/6.
  EXPECT_NEAR(volume(result, lattice), 2.0, 0.2);
  EXPECT_GT(result.clarity.unclear, 0);
  EXPECT_NEAR(std::abs(result.clarity.least_winding), 0.5, 1e-3);
  EXPECT_GT(result.clarity.least_clear[2], 0.5);
  // Below the rim nothing is missing.
  const auto of = [&](const Point<3>& point) {
    const Point<3> there = lattice.in_elements(point);
    return result.of_element[elements.offset(
        {static_cast<int>(there[0]), static_cast<int>(there[1]), static_cast<int>(there[2])})];
  };
  for (const double z : {-0.9, -0.5, 0.0, 0.5}) EXPECT_EQ(of({0.1, 0.1, z}), 1.0) << z;
  for (const double z : {-1.1, 1.15}) EXPECT_EQ(of({0.1, 0.1, z}), 0.0) << z;
}

/// The half ball's missing base is where its winding number is 1/2: a plane that no triangle touches.
TEST(MeshInteriorTest, MissingPlaneGoesThroughElements) {
  const TriangleMesh half = test::hemisphere_mesh(1, 40);
  const double exact = 2 * M_PI / 3;
  EXPECT_NEAR(volume(half, 1.1, 20), exact, 0.02 * exact);
  EXPECT_NEAR(volume(half, 1.1, 40), exact, 0.01 * exact);
}

void expect_independent_of_boxes(const TriangleMesh& mesh, double exact) {
  const ElementLattice lattice = {{0, 0, 0}, around_origin(1.2, 15).spacing};
  const IndexBox<3> whole = {{-7, -7, -7}, {15, 15, 15}};
  const FillFractions all = fractions(mesh, lattice, whole);
  EXPECT_NEAR(volume(all, lattice), exact, 0.02 * exact);
  Clarity sum;
  for (const IndexBox<3>& part : {IndexBox<3>{{-7, -7, -7}, {7, 15, 15}},
                                  {{0, -7, -7}, {8, 6, 15}},
                                  {{0, -1, -7}, {8, 9, 3}},
                                  {{0, -1, -4}, {5, 9, 12}},
                                  {{5, -1, -4}, {3, 9, 12}}}) {
    const FillFractions some = fractions(mesh, lattice, part);
    part.for_each([&](const Index<3>& element, std::int64_t offset) {
      EXPECT_EQ(some.of_element[offset], all.of_element[whole.offset(element)]) << to_text<3>(element);
    });
    sum.asked += some.clarity.asked;
    sum.unclear += some.clarity.unclear;
  }
  EXPECT_EQ(sum.unclear, all.clarity.unclear);
  EXPECT_EQ(sum.asked, all.clarity.asked);
}

TEST(MeshInteriorTest, IndependentOfBoxesClosed) {
  expect_independent_of_boxes(test::sphere_mesh(1, 20), 4 * M_PI / 3);
}
TEST(MeshInteriorTest, IndependentOfBoxesOpen) {
  expect_independent_of_boxes(test::hemisphere_mesh(1, 20), 2 * M_PI / 3);
}

/// Lines of samples and winding numbers of the tree are two ways to the same answer.
TEST(MeshInteriorTest, ClosedMeshesTakenForOpenOnes) {
  TriangleMesh boxes = box_mesh({-0.9, -0.7, -0.8}, {0.3, 0.5, 0.4});
  append(boxes, transformed(test::inside_out(box_mesh({-0.2, -0.3, -0.4}, {0.8, 0.7, 0.6})),
                            {{{0.8, -0.6, 0}, {0.48, 0.64, -0.6}, {0.36, 0.48, 0.8}}}, {}));
  const ElementLattice lattice = around_origin(1.4, 24);
  const IndexBox<3> box = {{0, 0, 0}, {24, 24, 24}};
  for (const TriangleMesh& mesh : {test::torus_mesh(1, 0.3, 40, 20), test::sphere_mesh(1.3, 7), boxes}) {
    ASSERT_TRUE(MeshInterior(mesh).closed());
    EXPECT_EQ(fractions(mesh, lattice, box).of_element,
              open_fractions(mesh, WindingNumber(mesh), lattice, box).of_element);
  }
}

/// Corners and edges of this mesh, too, lie exactly on lines of samples.
TEST(MeshInteriorTest, LinesThroughEdgesAndCorners) {
  const Point<3>& shift = sample_shift;
  const ElementLattice lattice = {{-shift[0], -shift[1], -shift[2]}, {1, 1, 1}};
  const TriangleMesh octahedron = {
      {{0.125, 2.125, 2.125},
       {4.125, 2.125, 2.125},
       {2.125, 0.125, 2.125},
       {2.125, 4.125, 2.125},
       {2.125, 2.125, 0.125},
       {2.125, 2.125, 4.125}},
      {{0, 4, 2}, {2, 4, 1}, {1, 4, 3}, {3, 4, 0}, {2, 5, 0}, {1, 5, 2}, {3, 5, 1}, {0, 5, 3}}};
  ASSERT_TRUE(is_closed(octahedron));
  const FillFractions result = fractions(octahedron, lattice, {{-1, -1, -1}, {7, 7, 7}});
  EXPECT_NEAR(volume(result, lattice), 4.0 / 3 * 8, 0.1);
  // Behind it, every line is outside again.
  const FillFractions behind = fractions(octahedron, lattice, {{5, -1, -1}, {2, 7, 7}});
  for (const double fraction : behind.of_element) EXPECT_EQ(fraction, 0.0);
}

/// The diagonals of these cubes' faces run through samples, but for rounding: a line through one must neither
/// miss both triangles nor cross both.
TEST(MeshInteriorTest, LinesThroughDiagonals) {
  const ElementLattice lattice = {
      {-0.5 - 4 * sample_shift[0], -0.5 - 4 * sample_shift[1], -0.5 - 4 * sample_shift[2]}, {4, 4, 4}};
  for (const double start : {0.1, 0.3, 0.7, 1.3, 2.9}) {
    const double end = start + 50.0 / 3;
    const TriangleMesh cube = box_mesh({start, start, start}, {end, end, end});
    const FillFractions result = fractions(cube, lattice, {{0, 0, 0}, {7, 7, 7}});
    const double samples = std::floor(end) - std::floor(start);
    EXPECT_NEAR(volume(result, lattice), samples * samples * samples, 1e-9) << start;
  }
}

TEST(MeshInteriorTest, ClarityNamesTheLeastClearPoint) {
  const TriangleMesh box = box_mesh({0, 0, 0}, {2, 2, 2});
  const FillFractions clear =
      open_fractions(box, WindingNumber(box), {{-1, -1, -1}, {1, 1, 1}}, {{0, 0, 0}, {4, 4, 4}});
  EXPECT_EQ(clear.clarity.unclear, 0);
  EXPECT_GT(clear.clarity.asked, 0);
  EXPECT_GT(std::abs(std::abs(clear.clarity.least_winding) - 0.5), 0.48);
}

TEST(MeshInteriorTest, NoElements) {
  for (const TriangleMesh& mesh : {test::sphere_mesh(1, 5), test::hemisphere_mesh(1, 5), TriangleMesh{}}) {
    const FillFractions empty = fractions(mesh, {{0, 0, 0}, {1, 1, 1}}, {{0, 0, 0}, {0, 4, 4}});
    EXPECT_TRUE(empty.of_element.empty());
    EXPECT_EQ(empty.clarity.asked, 0);
  }
}

}  // namespace
}  // namespace fabseq
