// SPDX-License-Identifier: MIT
/// \file
/// Closed surfaces of triangles for tests.
#pragma once

#include "fabseq/mesh/triangle_mesh.h"

#include <cmath>
#include <functional>
#include <utility>

namespace fabseq::test {

/// Adds the triangles of `other`.
inline void append(TriangleMesh& mesh, const TriangleMesh& other) {
  const auto first = static_cast<std::int32_t>(mesh.points.size());
  mesh.points.insert(mesh.points.end(), other.points.begin(), other.points.end());
  for (const auto& [a, b, c] : other.triangles) mesh.triangles.push_back({first + a, first + b, first + c});
}

inline TriangleMesh inside_out(TriangleMesh mesh) {
  for (auto& triangle : mesh.triangles) std::swap(triangle[0], triangle[1]);
  return mesh;
}

/// A box of 12 triangles, the last two of which are its top, at high[2].
inline TriangleMesh box_mesh(const Point<3>& low, const Point<3>& high) {
  TriangleMesh mesh;
  for (int corner = 0; corner < 8; ++corner)
    mesh.points.push_back({(corner & 1) != 0 ? high[0] : low[0], (corner & 2) != 0 ? high[1] : low[1],
                           (corner & 4) != 0 ? high[2] : low[2]});
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {0, 1, 5}, {0, 5, 4}, {1, 3, 7}, {1, 7, 5},
                    {3, 2, 6}, {3, 6, 7}, {2, 0, 4}, {2, 4, 6}, {4, 5, 7}, {4, 7, 6}};
  return mesh;
}

/// The same without its top.
inline TriangleMesh open_box_mesh(const Point<3>& low, const Point<3>& high) {
  TriangleMesh mesh = box_mesh(low, high);
  mesh.triangles.resize(10);
  return mesh;
}

/// A torus around the z axis: rings of `around` points, `through` of them.
inline TriangleMesh torus_mesh(double major, double minor, int around, int through) {
  TriangleMesh mesh;
  for (int i = 0; i < around; ++i)
    for (int j = 0; j < through; ++j) {
      const double u = 2 * M_PI * i / around, v = 2 * M_PI * j / through;
      const double distance = major + minor * std::cos(v);
      mesh.points.push_back({distance * std::cos(u), distance * std::sin(u), minor * std::sin(v)});
      const auto number = [&](int a, int b) { return a % around * through + b % through; };
      const int p = number(i, j), q = number(i + 1, j), r = number(i + 1, j + 1), s = number(i, j + 1);
      mesh.triangles.push_back({p, q, r});
      mesh.triangles.push_back({p, r, s});
    }
  return mesh;
}

/// Half a sphere around the origin, z >= 0, without its base: `rings` circles of 4 `rings` points each.
inline TriangleMesh hemisphere_mesh(double radius, int rings) {
  TriangleMesh mesh;
  const int around = 4 * rings;
  for (int ring = 0; ring < rings; ++ring)
    for (int i = 0; i < around; ++i) {
      const double height = 0.5 * M_PI * ring / rings, angle = 2 * M_PI * i / around;
      mesh.points.push_back({radius * std::cos(height) * std::cos(angle),
                             radius * std::cos(height) * std::sin(angle), radius * std::sin(height)});
    }
  const int pole = around * rings;
  mesh.points.push_back({0, 0, radius});
  for (int ring = 0; ring < rings; ++ring)
    for (int i = 0; i < around; ++i) {
      const int p = ring * around + i, q = ring * around + (i + 1) % around;
      if (ring + 1 == rings) {
        mesh.triangles.push_back({p, q, pole});
        continue;
      }
      mesh.triangles.push_back({p, q, q + around});
      mesh.triangles.push_back({p, q + around, p + around});
    }
  return mesh;
}

/// A sphere around the origin: two hemispheres that share the equator.
inline TriangleMesh sphere_mesh(double radius, int rings) {
  TriangleMesh mesh = hemisphere_mesh(radius, rings);
  const std::size_t upper = mesh.triangles.size(), points = mesh.points.size();
  const auto equator = static_cast<std::size_t>(4) * rings;
  for (std::size_t p = equator; p < points; ++p)
    mesh.points.push_back({mesh.points[p][0], mesh.points[p][1], -mesh.points[p][2]});
  const auto below = [&](std::int32_t p) {
    return p < static_cast<std::int32_t>(equator) ? p : p + static_cast<std::int32_t>(points - equator);
  };
  for (std::size_t t = 0; t < upper; ++t) {
    const auto [a, b, c] = mesh.triangles[t];
    mesh.triangles.push_back({below(b), below(a), below(c)});
  }
  return mesh;
}

}  // namespace fabseq::test
