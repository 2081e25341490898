// SPDX-License-Identifier: MIT
#include "fabseq/mesh/winding_number.h"

#include "mesh/vectors.h"
#include "support/meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace fabseq {
namespace {

using test::append;
using test::box_mesh;

/// The winding number around a point, from the tree.
double tree(const WindingNumber& winding, const Point<3>& point) {
  double value = 0.0;
  winding.at({&point, 1}, point, 0.0, {&value, 1});
  return value;
}

/// The same as the sum over all triangles: half the solid angle of each is an arctangent (Van Oosterom &
/// Strackee 1983).
double exact(const TriangleMesh& mesh, const Point<3>& point) {
  double sum = 0.0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    std::array<Point<3>, 3> corners = mesh.corners(t);
    for (Point<3>& corner : corners) corner = difference(corner, point);
    const auto& [a, b, c] = corners;
    const double la = norm(a), lb = norm(b), lc = norm(c), volume = dot(a, cross(b, c));
    if (volume == 0.0) continue;  // in the triangle's plane no side is the right one
    sum += std::atan2(volume, la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
  }
  return sum / (2.0 * M_PI);
}

/// Points and triangles from a fixed seed.
class Random {
 public:
  Point<3> point(double low = -1.0, double high = 1.0) {
    std::uniform_real_distribution<double> coordinate(low, high);
    return {coordinate(engine_), coordinate(engine_), coordinate(engine_)};
  }
  /// Triangles that have nothing to do with each other, in the unit box.
  TriangleMesh soup(int triangles, double size) {
    TriangleMesh mesh;
    for (int t = 0; t < triangles; ++t) {
      const Point<3> middle = point();
      for (int corner = 0; corner < 3; ++corner) {
        const Point<3> offset = point(-size, size);
        mesh.points.push_back({middle[0] + offset[0], middle[1] + offset[1], middle[2] + offset[2]});
      }
      mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    }
    return mesh;
  }

 private:
  std::mt19937 engine_{5};
};

TEST(WindingNumberTest, TrianglesSeenFromTheOrigin) {
  const TriangleMesh octant = {{{1, 0, 0}, {0, 2, 0}, {0, 0, 3}}, {{0, 1, 2}}};
  EXPECT_NEAR(tree(WindingNumber(octant), {0, 0, 0}), 1.0 / 8, 1e-14);
  EXPECT_NEAR(exact(octant, {0, 0, 0}), 1.0 / 8, 1e-14);
  const TriangleMesh turned = test::inside_out(octant);
  EXPECT_NEAR(tree(WindingNumber(turned), {0, 0, 0}), -1.0 / 8, 1e-14);
  TriangleMesh face = box_mesh({-1, -1, -1}, {1, 1, 1});
  face.triangles.resize(2);
  EXPECT_NEAR(tree(WindingNumber(face), {0, 0, 0}), 1.0 / 6, 1e-14);
}

TEST(WindingNumberTest, BoxInsideAndOutside) {
  const TriangleMesh box = box_mesh({1, 2, 3}, {2, 4, 7});
  const WindingNumber winding(box);
  Random random;
  for (int i = 0; i < 1000; ++i) {
    const Point<3> point = random.point(0, 8);
    const bool inside =
        point[0] > 1 && point[0] < 2 && point[1] > 2 && point[1] < 4 && point[2] > 3 && point[2] < 7;
    EXPECT_NEAR(exact(box, point), inside ? 1.0 : 0.0, 1e-12) << to_text<3>(point);
    EXPECT_NEAR(tree(winding, point), inside ? 1.0 : 0.0, 1e-3) << to_text<3>(point);
  }
}

TEST(WindingNumberTest, SurfacePointsAreHalfInside) {
  const TriangleMesh box = box_mesh({0, 0, 0}, {1, 1, 1});
  const WindingNumber winding(box);
  for (const Point<3>& point : {Point<3>{0.3, 0.4, 0}, {0.3, 0.4, 1}, {0.3, 0, 0.2}, {1, 0.6, 0.2}})
    EXPECT_NEAR(tree(winding, point), 0.5, 1e-12) << to_text<3>(point);
  for (const Point<3>& point : {Point<3>{0.5, 0.5, 0}, {0, 0, 0}, {1, 0, 0.5}})  // on edges and corners
    EXPECT_TRUE(std::isfinite(tree(winding, point))) << to_text<3>(point);
  EXPECT_NEAR(tree(winding, {2, 0.5, 0}), 0.0, 1e-12);  // in the plane of a face, outside
}

TEST(WindingNumberTest, CountsFullTurns) {
  TriangleMesh spheres;
  for (int i = 0; i < 12; ++i) append(spheres, test::sphere_mesh(1 + 0.1 * i, 2));
  EXPECT_NEAR(exact(spheres, {0.1, 0.1, 0.1}), 12.0, 1e-12);
  EXPECT_NEAR(tree(WindingNumber(spheres), {0.1, 0.1, 0.1}), 12.0, 0.01);
  const TriangleMesh turned = test::inside_out(spheres);
  EXPECT_NEAR(tree(WindingNumber(turned), {0.1, 0.1, 0.1}), -12.0, 0.01);
}

/// A single leaf, nearly all of whose points are close by: product of complex numbers against arctangents.
TEST(WindingNumberTest, LeafSumsExactly) {
  Random random;
  for (int i = 0; i < 2000; ++i) {
    const TriangleMesh soup = random.soup(8, 1.5);
    const WindingNumber winding(soup);
    const Point<3> point = random.point();
    EXPECT_NEAR(tree(winding, point), exact(soup, point), 1e-12);
  }
}

/// On the axis of half a sphere without a base, with the height h: (1 + h / sqrt(h^2 + r^2)) / 2, less 1
/// above the pole.
TEST(WindingNumberTest, OpenHemisphere) {
  constexpr double radius = 3.0;
  const TriangleMesh mesh = test::hemisphere_mesh(radius, 64);
  const WindingNumber winding(mesh);
  for (const double height : {-10.0, -3.0, -1.0, 0.0, 0.5, 2.0, 2.9, 3.1, 5.0}) {
    const double expected = 0.5 * (1 + height / std::hypot(height, radius)) - (height > radius ? 1 : 0);
    EXPECT_NEAR(exact(mesh, {0, 0, height}), expected, 1e-4) << height;
    EXPECT_NEAR(tree(winding, {0, 0, height}), expected, 0.005) << height;
  }
}

TEST(WindingNumberTest, OverlappingBoxesAddUp) {
  TriangleMesh mesh = box_mesh({0, 0, 0}, {2, 2, 2});
  append(mesh, box_mesh({1, 1, 1}, {3, 3, 3}));
  append(mesh, test::inside_out(box_mesh({0, 0, 10}, {2, 2, 12})));
  append(mesh, box_mesh({1, 0, 10}, {3, 2, 12}));
  const WindingNumber winding(mesh);
  const auto expect = [&](const Point<3>& point, double expected) {
    EXPECT_NEAR(exact(mesh, point), expected, 1e-12) << to_text<3>(point);
    EXPECT_NEAR(tree(winding, point), expected, 0.01) << to_text<3>(point);
  };
  expect({0.5, 0.5, 0.5}, 1.0);
  expect({1.5, 1.5, 1.5}, 2.0);
  expect({2.5, 2.5, 2.5}, 1.0);
  expect({2.5, 0.5, 0.5}, 0.0);
  expect({0.5, 1, 11}, -1.0);
  expect({1.5, 1, 11}, 0.0);
  expect({2.5, 1, 11}, 1.0);
}

/// A prism over a pentagram: its core is wound around twice.
TEST(WindingNumberTest, SelfIntersecting) {
  TriangleMesh star;
  for (int i = 0; i < 5; ++i)
    for (const double z : {0.0, 1.0})
      star.points.push_back({std::cos(0.8 * M_PI * i), std::sin(0.8 * M_PI * i), z});
  for (int i = 0; i < 5; ++i) {
    const int p = 2 * i, q = 2 * ((i + 1) % 5);
    star.triangles.insert(star.triangles.end(), {{p, q, q + 1}, {p, q + 1, p + 1}});
  }
  for (int i = 1; i < 4; ++i) {
    star.triangles.push_back({0, 2 * i + 2, 2 * i});
    star.triangles.push_back({1, 2 * i + 1, 2 * i + 3});
  }
  ASSERT_TRUE(is_closed(star));
  const WindingNumber winding(star);
  EXPECT_NEAR(exact(star, {0, 0, 0.5}), 2.0, 1e-12);
  EXPECT_NEAR(exact(star, {0.7, 0, 0.5}), 1.0, 1e-12);
  EXPECT_NEAR(exact(star, {-0.7, 0, 0.5}), 0.0, 1e-12);
  EXPECT_NEAR(tree(winding, {0, 0, 0.5}), 2.0, 0.01);
}

/// Far from its triangles the expansion lacks terms of the order (size / distance)^5; without the second
/// moments it would be the fourth power.
TEST(WindingNumberTest, ExpansionIsOfSecondOrder) {
  Random random;
  TriangleMesh soup = random.soup(40, 0.3);
  const WindingNumber winding(soup);
  const auto error = [&](double distance) {
    const Point<3> point = {0.6 * distance, -0.48 * distance, 0.64 * distance};
    return std::abs(tree(winding, point) - exact(soup, point));
  };
  EXPECT_NEAR(std::log2(error(8) / error(16)), 5.0, 0.4);
}

/// Largest error of the tree at random points.
double largest_error(const TriangleMesh& mesh, int points) {
  const WindingNumber winding(mesh);
  Random random;
  double largest = 0.0;
  for (int i = 0; i < points; ++i) {
    const Point<3> point = random.point(-1.2, 1.2);
    largest = std::max(largest, std::abs(tree(winding, point) - exact(mesh, point)));
  }
  return largest;
}

TEST(WindingNumberTest, LargestErrors) {
#if defined(__SANITIZE_ADDRESS__)
  constexpr int points = 20;  // the exact sums at 1000 points take minutes there
#else
  constexpr int points = 1000;
#endif
  Random random;
  const std::vector<double> found = {largest_error(random.soup(20000, 0.02), points),
                                     largest_error(random.soup(5000, 0.3), 2 * points),
                                     largest_error(test::sphere_mesh(1, 50), points),
                                     largest_error(test::torus_mesh(0.8, 0.2, 200, 60), points)};
  for (const double error : found) EXPECT_LT(error, 0.01) << testing::PrintToString(found);
}

TEST(WindingNumberTest, GroupsOfPoints) {
  const TriangleMesh mesh = test::sphere_mesh(1, 30);
  const WindingNumber winding(mesh);
  Random random;
  const double radius = 0.3 * std::sqrt(3.0);
  for (int i = 0; i < 50; ++i) {
    const Point<3> center = random.point();
    std::vector<Point<3>> points(WindingNumber::group_limit);
    for (Point<3>& point : points) {
      point = random.point(-0.3, 0.3);
      for (int axis = 0; axis < 3; ++axis) point[axis] += center[axis];
    }
    std::vector<double> together(points.size());
    winding.at(points, center, radius, together);
    for (std::size_t p = 0; p < points.size(); ++p) {
      EXPECT_NEAR(together[p], exact(mesh, points[p]), 0.01);
      double alone = 0.0;
      winding.at({&points[p], 1}, center, radius, {&alone, 1});
      EXPECT_NEAR(together[p], alone, 1e-14);
    }
  }
}

TEST(WindingNumberTest, NothingAndTrianglesOfNoArea) {
  const TriangleMesh nothing;
  EXPECT_EQ(tree(WindingNumber(nothing), {1, 2, 3}), 0.0);
  TriangleMesh box = box_mesh({0, 0, 0}, {1, 1, 1});
  for (int i = 0; i < 100; ++i) box.triangles.push_back({0, 7, 7});
  const WindingNumber winding(box);
  EXPECT_NEAR(tree(winding, {0.2, 0.3, 0.4}), 1.0, 1e-3);
  EXPECT_NEAR(tree(winding, {-0.2, 0.3, 0.4}), 0.0, 1e-3);
}

}  // namespace
}  // namespace fabseq
