// SPDX-License-Identifier: MIT
#include "mesh/crossing_lines.h"

#include "mesh/vectors.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace fabseq {

namespace {

using Triangle = std::array<Point<3>, 3>;

Point<3> between(const Point<3>& a, const Point<3>& b, double share) {
  Point<3> result;
  for (int axis = 0; axis < 3; ++axis) result[axis] = a[axis] + share * (b[axis] - a[axis]);
  return result;
}

/// Of length 1; 0 for a triangle without area.
Point<3> unit_normal(const Triangle& t) {
  Point<3> normal = cross(difference(t[1], t[0]), difference(t[2], t[0]));
  const double length = norm(normal);
  for (double& x : normal) x = length > 0.0 ? x / length : 0.0;
  return normal;
}

/// The part of a segment inside a triangle in whose plane it lies; none where it is no longer than the
/// tolerance.
std::optional<Segment> clipped(const Segment& segment, const Triangle& triangle, const Point<3>& normal,
                               double tolerance) {
  double low = 0.0, high = 1.0;
  for (int i = 0; i < 3; ++i) {
    const Point<3>& corner = triangle[i];
    const Point<3> edge = difference(triangle[(i + 1) % 3], corner);
    Point<3> inward = cross(normal, edge);
    const double length = norm(inward);
    if (!(length > 0.0)) return std::nullopt;
    const double start = dot(inward, difference(segment[0], corner)) / length,
                 end = dot(inward, difference(segment[1], corner)) / length;
    if (start < -tolerance && end < -tolerance) return std::nullopt;
    if (start < -tolerance) low = std::max(low, start / (start - end));
    if (end < -tolerance) high = std::min(high, start / (start - end));
  }
  const double length = norm(difference(segment[1], segment[0]));
  if (!((high - low) * length > tolerance)) return std::nullopt;
  return Segment{between(segment[0], segment[1], low), between(segment[0], segment[1], high)};
}

/// Adds where two triangles meet to the segments of the first.
void add_crossing(const Triangle& a, const Triangle& b, double tolerance, std::vector<Segment>& segments) {
  const Point<3> normal = unit_normal(b);
  if (normal == Point<3>{}) return;
  std::array<double, 3> heights;
  for (int i = 0; i < 3; ++i) {
    heights[i] = dot(normal, difference(a[i], b[0]));
    if (std::abs(heights[i]) <= tolerance) heights[i] = 0.0;
  }
  if (std::all_of(heights.begin(), heights.end(), [](double x) { return x == 0.0; })) {
    for (int i = 0; i < 3; ++i) segments.push_back({b[i], b[(i + 1) % 3]});
    return;
  }
  std::vector<Point<3>> ends;
  for (int i = 0; i < 3; ++i) {
    const int next = (i + 1) % 3;
    if (heights[i] == 0.0) ends.push_back(a[i]);
    if (heights[i] * heights[next] < 0.0)
      ends.push_back(between(a[i], a[next], heights[i] / (heights[i] - heights[next])));
  }
  if (ends.size() != 2) return;
  if (const auto found = clipped({ends[0], ends[1]}, b, normal, tolerance)) segments.push_back(*found);
}

struct BoxedTriangle {
  Bounds box;
  std::size_t number;
};

/// Those triangles of a mesh that come near a box, in the order of their lower ends along x.
std::vector<BoxedTriangle> triangles_near(const TriangleMesh& mesh, const Bounds& box) {
  std::vector<BoxedTriangle> result;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    Bounds own{mesh.corners(t)[0], mesh.corners(t)[0]};
    bool apart = false;
    for (int axis = 0; axis < 3; ++axis) {
      for (const Point<3>& corner : mesh.corners(t)) {
        own.low[axis] = std::min(own.low[axis], corner[axis]);
        own.high[axis] = std::max(own.high[axis], corner[axis]);
      }
      apart = apart || own.low[axis] > box.high[axis] || own.high[axis] < box.low[axis];
    }
    if (!apart) result.push_back({own, t});
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
    for (const BoxedTriangle& other : open) {
      bool apart = false;
      for (int axis = 0; axis < 3; ++axis)
        apart = apart || other.box.low[axis] > own.box.high[axis] + tolerance ||
                other.box.high[axis] < own.box.low[axis] - tolerance;
      if (apart) continue;
      const Triangle a = first.corners(own.number), b = second.corners(other.number);
      add_crossing(a, b, tolerance, result.first[own.number]);
      add_crossing(b, a, tolerance, result.second[other.number]);
    }
  }
  return result;
}

}  // namespace fabseq
