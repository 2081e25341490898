// SPDX-License-Identifier: MIT
#include "fabseq/mesh/near_surface.h"

#include "mesh/vectors.h"

#include <algorithm>
#include <cmath>

namespace fabseq {

namespace {

double distance_to_segment(const Point<3>& point, const Point<3>& start, const Point<3>& end) {
  const Point<3> edge = difference(end, start), offset = difference(point, start);
  const double square = dot(edge, edge);
  const double along = square > 0.0 ? std::clamp(dot(offset, edge) / square, 0.0, 1.0) : 0.0;
  return norm(difference(offset, {along * edge[0], along * edge[1], along * edge[2]}));
}

/// Indices of the nodes of `box` in the box around the triangle that is larger by `distance` on all sides.
IndexBox<3> nodes_around(const std::array<Point<3>, 3>& triangle, double distance, const Domain<3>& domain,
                         const IndexBox<3>& box) {
  IndexBox<3> result;
  for (int axis = 0; axis < 3; ++axis) {
    const auto [low, high] = std::minmax({triangle[0][axis], triangle[1][axis], triangle[2][axis]});
    const double spacing = domain.size[axis] / domain.elements[axis], first = box.start[axis],
                 end = first + box.size[axis];
    const double from = std::ceil((low - distance - domain.origin[axis]) / spacing),
                 to = std::floor((high + distance - domain.origin[axis]) / spacing) + 1.0;
    result.start[axis] = static_cast<int>(std::clamp(from, first, end));
    result.size[axis] = static_cast<int>(std::clamp(to, first, end)) - result.start[axis];
    if (result.size[axis] <= 0) return {};
  }
  return result;
}

/// Distance of a point from a triangle (Ericson 2005, "Real-time collision detection", 5.1.5).
double distance_to_triangle(const Point<3>& point, const std::array<Point<3>, 3>& triangle) {
  const Point<3> normal = cross(difference(triangle[1], triangle[0]), difference(triangle[2], triangle[0]));
  const double area = norm(normal);
  bool above = area > 0.0;  // the foot of the perpendicular lies in the triangle
  double nearest = INFINITY;
  for (int i = 0; i < 3; ++i) {
    const Point<3>&a = triangle[i], &b = triangle[(i + 1) % 3];
    above = above && dot(cross(difference(b, a), difference(point, a)), normal) >= 0.0;
    nearest = std::min(nearest, distance_to_segment(point, a, b));
  }
  return above ? std::abs(dot(difference(point, triangle[0]), normal)) / area : nearest;
}

}  // namespace

std::vector<char> nodes_near(const TriangleMesh& mesh, double distance, const Domain<3>& domain,
                             const IndexBox<3>& box) {
  std::vector<char> result(static_cast<std::size_t>(box.count()), 0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const std::array<Point<3>, 3> triangle = mesh.corners(t);
    nodes_around(triangle, distance, domain, box).for_each([&](const Index<3>& node, std::int64_t) {
      if (distance_to_triangle(domain.node_position(node), triangle) <= distance)
        result[box.offset(node)] = 1;
    });
  }
  return result;
}

}  // namespace fabseq
