// SPDX-License-Identifier: MIT
#include "fabseq/mesh/triangle_mesh.h"

#include "mesh/vectors.h"

#include <algorithm>
#include <limits>

namespace fabseq {

Bounds bounds(const TriangleMesh& mesh) {
  Bounds result;
  result.low.fill(std::numeric_limits<double>::infinity());
  result.high.fill(-std::numeric_limits<double>::infinity());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto corners = mesh.corners(t);
    const Point<3> normal = cross(difference(corners[1], corners[0]), difference(corners[2], corners[0]));
    if (normal == Point<3>{}) continue;
    for (const Point<3>& point : corners)
      for (int axis = 0; axis < 3; ++axis) {
        result.low[axis] = std::min(result.low[axis], point[axis]);
        result.high[axis] = std::max(result.high[axis], point[axis]);
      }
  }
  return result;
}

TriangleMesh transformed(TriangleMesh mesh, const std::array<Point<3>, 3>& matrix, const Point<3>& shift) {
  for (Point<3>& point : mesh.points) {
    const Point<3> old = point;
    for (int axis = 0; axis < 3; ++axis) point[axis] = dot(matrix[axis], old) + shift[axis];
  }
  return mesh;
}

double signed_volume(const TriangleMesh& mesh) {
  double sum = 0.0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto [a, b, c] = mesh.corners(t);
    // Tetrahedra from a point of the mesh: from the origin, those of a small part far away would cancel.
    const Point<3>& apex = mesh.points.front();
    sum += dot(difference(a, apex), cross(difference(b, apex), difference(c, apex)));
  }
  return sum / 6.0;
}

bool is_closed(const TriangleMesh& mesh) {
  // An edge and its direction in 63 bits: lower point, higher point, whether it runs downwards.
  std::vector<std::uint64_t> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (const auto& triangle : mesh.triangles)
    for (int i = 0; i < 3; ++i) {
      const auto from = static_cast<std::uint64_t>(triangle[i]);
      const auto to = static_cast<std::uint64_t>(triangle[(i + 1) % 3]);
      edges.push_back(std::min(from, to) << 32 | std::max(from, to) << 1 | (from > to ? 1 : 0));
    }
  std::sort(edges.begin(), edges.end());
  std::int64_t balance = 0;
  for (std::size_t e = 0; e < edges.size(); ++e) {
    balance += (edges[e] & 1) != 0 ? -1 : 1;
    const bool last = e + 1 == edges.size() || edges[e] >> 1 != edges[e + 1] >> 1;
    if (last && balance != 0) return false;
  }
  return true;
}

}  // namespace fabseq
