// SPDX-License-Identifier: MIT
#include "mesh/crossing_lines.h"

#include "mesh/mesh_pieces.h"
#include "mesh/vectors.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace fabseq {

namespace {

using Triangle = std::array<Point<3>, 3>;

/// Returns the normal of length 1; 0 for a triangle without area.
Point<3> unit_normal(const Triangle& t) {
  Point<3> normal = cross(difference(t[1], t[0]), difference(t[2], t[0]));
  const double length = norm(normal);
  for (double& x : normal) x = length > 0.0 ? x / length : 0.0;
  return normal;
}

/// A triangle's plane, and how far a point lies above it: 0 within the tolerance.
struct Plane {
  Point<3> normal, origin;
  double tolerance;

  double height(const Point<3>& point) const {
    const double result = dot(normal, difference(point, origin));
    return std::abs(result) <= tolerance ? 0.0 : result;
  }
};

/// Whether a point of a triangle's plane lies in the triangle.
bool lies_in(const Point<3>& point, const Triangle& triangle, const Plane& plane) {
  for (int i = 0; i < 3; ++i) {
    const Point<3> inward = cross(plane.normal, difference(triangle[(i + 1) % 3], triangle[i]));
    if (dot(inward, difference(point, triangle[i])) < -plane.tolerance * norm(inward)) return false;
  }
  return true;
}

/// Adds the points in which edges of a triangle meet another one. Both triangles at an edge get the same one.
void add_points(const Triangle& triangle, const Triangle& other, const Plane& plane,
                std::vector<Point<3>>& points) {
  for (int i = 0; i < 3; ++i) {
    const auto& [start, end] = std::minmax(triangle[i], triangle[(i + 1) % 3]);
    const double from = plane.height(start), to = plane.height(end);
    if ((from == 0.0) == (to == 0.0) && from * to >= 0.0) continue;
    const Point<3> point = from == 0.0 ? start : to == 0.0 ? end : between(start, end, from / (from - to));
    if (lies_in(point, other, plane)) points.push_back(point);
  }
}

/// Where two triangles cross that do not lie on each other: the farthest two of the points in which edges of
/// one meet the other.
std::optional<Segment> crossing_of(const Triangle& a, const Plane& plane_of_a, const Triangle& b,
                                   const Plane& plane_of_b) {
  std::vector<Point<3>> points;
  add_points(a, b, plane_of_b, points);
  add_points(b, a, plane_of_a, points);
  Segment farthest{};
  double longest = plane_of_a.tolerance;
  for (const Point<3>& start : points)
    for (const Point<3>& end : points)
      if (const double length = norm(difference(end, start)); length > longest) {
        longest = length;
        farthest = {start, end};
      }
  if (longest == plane_of_a.tolerance) return std::nullopt;
  return farthest;
}

bool lies_on(const Triangle& triangle, const Plane& plane) {
  return std::all_of(triangle.begin(), triangle.end(),
                     [&](const Point<3>& corner) { return plane.height(corner) == 0.0; });
}

/// Adds where two triangles meet to the segments of both.
void add_crossing(const Triangle& a, const Triangle& b, double tolerance, std::vector<Segment>& of_a,
                  std::vector<Segment>& of_b) {
  const Plane plane_of_a{unit_normal(a), a[0], tolerance}, plane_of_b{unit_normal(b), b[0], tolerance};
  if (plane_of_a.normal == Point<3>{} || plane_of_b.normal == Point<3>{}) return;
  if (lies_on(a, plane_of_b) || lies_on(b, plane_of_a)) {
    for (int i = 0; i < 3; ++i) {
      of_a.push_back({b[i], b[(i + 1) % 3]});
      of_b.push_back({a[i], a[(i + 1) % 3]});
    }
  } else if (const auto crossing = crossing_of(a, plane_of_a, b, plane_of_b)) {
    of_a.push_back(*crossing);
    of_b.push_back(*crossing);
  }
}

struct BoxedTriangle {
  Bounds box;
  std::size_t number;
};

/// Returns those triangles of a mesh that come near a box, in the order of their lower ends along x.
std::vector<BoxedTriangle> triangles_near(const TriangleMesh& mesh, const Bounds& box) {
  std::vector<BoxedTriangle> result;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto [a, b, c] = mesh.corners(t);
    const Bounds own = join(join({a, a}, {b, b}), {c, c});
    if (overlap(own, box)) result.push_back({own, t});
  }
  std::sort(result.begin(), result.end(),
            [](const BoxedTriangle& a, const BoxedTriangle& b) { return a.box.low[0] < b.box.low[0]; });
  return result;
}

Bounds enlarged(Bounds box, double by) {
  for (int axis = 0; axis < 3; ++axis) {
    box.low[axis] -= by;
    box.high[axis] += by;
  }
  return box;
}

}  // namespace

CrossingLines find_crossing_lines(const TriangleMesh& first, const TriangleMesh& second, double tolerance) {
  CrossingLines result{std::vector<std::vector<Segment>>(first.triangles.size()),
                       std::vector<std::vector<Segment>>(second.triangles.size())};
  const std::vector<BoxedTriangle> ours = triangles_near(first, enlarged(bounds(second), tolerance)),
                                   theirs = triangles_near(second, enlarged(bounds(first), tolerance));
  std::vector<BoxedTriangle> open;  // of theirs: those that may reach the one in hand
  auto next = theirs.begin();
  for (const BoxedTriangle& own : ours) {
    for (; next != theirs.end() && next->box.low[0] <= own.box.high[0] + tolerance; ++next)
      open.push_back(*next);
    std::erase_if(open, [&](const BoxedTriangle& other) {
      return other.box.high[0] < own.box.low[0] - tolerance;  // and so than all that follow
    });
    const Bounds around = enlarged(own.box, tolerance);
    for (const BoxedTriangle& other : open)
      if (overlap(around, other.box))
        add_crossing(first.corners(own.number), second.corners(other.number), tolerance,
                     result.first[own.number], result.second[other.number]);
  }
  return result;
}

}  // namespace fabseq
