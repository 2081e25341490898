// SPDX-License-Identifier: MIT
#include "mesh/normal_moments.h"

#include "mesh/vectors.h"

#include <gtest/gtest.h>

#include <vector>

namespace fabseq {
namespace {

const Point<3> a = {0.3, -0.2, 1.1}, b = {1.4, 0.5, 0.7}, c = {-0.1, 1.9, 2.3};

double value(const NormalMoments& moments, const Point<3>& d) {
  const auto& [x, y, z] = d;
  const auto& [xx, yy, zz, xy, yz, zx] = moments.first;
  const auto& [xxx, yyy, zzz, xxy, xxz, yyx, yyz, zzx, zzy, xyz] = moments.second;
  return dot(moments.normal, d) + xx * x * x + yy * y * y + zz * z * z + xy * x * y + yz * y * z +
         zx * z * x + xxx * x * x * x + yyy * y * y * y + zzz * z * z * z + xxy * x * x * y +
         xxz * x * x * z + yyx * y * y * x + yyz * y * y * z + zzx * z * z * x + zzy * z * z * y +
         xyz * x * y * z;
}

/// Moments of the triangle divided into 4^levels.
NormalMoments divided(const Point<3>& p, const Point<3>& q, const Point<3>& r, int levels) {
  if (levels == 0) return moments_of_triangle(p, q, r);
  const auto middle = [](const Point<3>& u, const Point<3>& v) {
    return Point<3>{0.5 * (u[0] + v[0]), 0.5 * (u[1] + v[1]), 0.5 * (u[2] + v[2])};
  };
  const Point<3> pq = middle(p, q), qr = middle(q, r), rp = middle(r, p);
  const std::vector<NormalMoments> parts = {divided(p, pq, rp, levels - 1), divided(pq, q, qr, levels - 1),
                                            divided(rp, qr, r, levels - 1), divided(pq, qr, rp, levels - 1)};
  return join(parts);
}

TEST(NormalMomentsTest, AreThoseOfSmallPiecesJoined) {
  const NormalMoments whole = moments_of_triangle(a, b, c);
  for (const int levels : {1, 3}) {
    const NormalMoments joined = divided(a, b, c, levels);
    EXPECT_NEAR(joined.area, whole.area, 1e-12);
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(joined.center[axis], whole.center[axis], 1e-12);
    for (const Point<3>& d : {Point<3>{1, 2, 3}, Point<3>{-1, 0.5, 2}, Point<3>{3, -1, -1}})
      EXPECT_NEAR(value(joined, d), value(whole, d), 1e-12);
  }
}

/// Midpoint rule over small triangles, about the centre that the moments have.
TEST(NormalMomentsTest, AreIntegralsOverTheTriangles) {
  const std::vector<NormalMoments> triangles = {moments_of_triangle(a, b, c),
                                                moments_of_triangle(b, a, {2, 2, -1})};
  const NormalMoments moments = join(triangles);
  const Point<3> d = {0.7, -1.2, 0.4};
  double sum = 0.0;
  constexpr int n = 200;
  for (const auto& [p, q, r] : {std::array<Point<3>, 3>{a, b, c}, {b, a, {2, 2, -1}}}) {
    const double flux = 0.5 * dot(cross(difference(q, p), difference(r, p)), d) / (n * n);
    for (int i = 0; i < n; ++i)
      for (int j = 0; i + j < n; ++j)
        for (const double corner : {1.0 / 3, 2.0 / 3}) {
          if (corner > 0.5 && i + j == n - 1) continue;
          const double s = (i + corner) / n, t = (j + corner) / n;
          Point<3> u;
          for (int axis = 0; axis < 3; ++axis)
            u[axis] = p[axis] + s * (q[axis] - p[axis]) + t * (r[axis] - p[axis]) - moments.center[axis];
          sum += flux * (1 + dot(u, d) + dot(u, d) * dot(u, d));
        }
  }
  EXPECT_NEAR(value(moments, d), sum, 1e-4);
}

TEST(NormalMomentsTest, HarmonicPartHasNoLaplacian) {
  NormalMoments moments =
      join(std::vector{moments_of_triangle(a, b, c), moments_of_triangle(b, a, {2, 2, -1})});
  moments.make_harmonic();
  const Point<3> d = {0.7, -1.2, 0.4};
  double laplacian = -6 * value(moments, d);
  for (int axis = 0; axis < 3; ++axis)
    for (const double step : {-1.0, 1.0}) {
      Point<3> beside = d;
      beside[axis] += step;
      laplacian += value(moments, beside);  // exact for polynomials of third degree
    }
  EXPECT_NEAR(laplacian, 0.0, 1e-12);
}

TEST(NormalMomentsTest, TrianglesOfNoArea) {
  const NormalMoments nothing = join(std::vector{moments_of_triangle(a, a, a), moments_of_triangle(b, b, b)});
  EXPECT_EQ(nothing.area, 0.0);
  EXPECT_EQ(value(nothing, {1, 2, 3}), 0.0);
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(nothing.center[axis], 0.5 * (a[axis] + b[axis]), 1e-12);
}

}  // namespace
}  // namespace fabseq
