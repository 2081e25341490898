// SPDX-License-Identifier: MIT
#include "fabseq/mesh/triangle_mesh.h"

#include "mesh/mesh_pieces.h"
#include "mesh/vectors.h"

#include <algorithm>
#include <limits>

namespace fabseq {

namespace {

/// Triangles whose height is a smaller share of their longest edge have no area: single precision does not
/// hold more.
constexpr double least_height = 1e-7;

constexpr Bounds around_nothing() {
  constexpr double far = std::numeric_limits<double>::infinity();
  return {{far, far, far}, {-far, -far, -far}};
}

bool has_area(const std::array<Point<3>, 3>& corners) {
  const Point<3> a = difference(corners[1], corners[0]), b = difference(corners[2], corners[0]),
                 c = difference(corners[2], corners[1]), normal = cross(a, b);
  const double longest = std::max({dot(a, a), dot(b, b), dot(c, c)});
  return norm(normal) > least_height * longest;
}

void enlarge(Bounds& box, const std::array<Point<3>, 3>& corners) {
  if (!has_area(corners)) return;
  for (const Point<3>& point : corners) box = join(box, {point, point});
}

}  // namespace

Bounds bounds(const TriangleMesh& mesh) {
  Bounds result = around_nothing();
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) enlarge(result, mesh.corners(t));
  return result;
}

Bounds bounds(const TriangleMesh& mesh, std::span<const std::int32_t> triangles) {
  Bounds result = around_nothing();
  for (const std::int32_t t : triangles) enlarge(result, mesh.corners(static_cast<std::size_t>(t)));
  return result;
}

Bounds join(const Bounds& a, const Bounds& b) {
  Bounds result;
  for (int axis = 0; axis < 3; ++axis) {
    result.low[axis] = std::min(a.low[axis], b.low[axis]);
    result.high[axis] = std::max(a.high[axis], b.high[axis]);
  }
  return result;
}

bool overlap(const Bounds& a, const Bounds& b) {
  for (int axis = 0; axis < 3; ++axis)
    if (a.low[axis] > b.high[axis] || a.high[axis] < b.low[axis]) return false;
  return true;
}

double volume(const Bounds& box) {
  double product = 1.0;
  for (int axis = 0; axis < 3; ++axis) product *= std::max(0.0, box.high[axis] - box.low[axis]);
  return product;
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
