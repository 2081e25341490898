// SPDX-License-Identifier: MIT
#include "mesh/split_triangle.h"

#include "mesh/vectors.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace fabseq {

namespace {

/// A piece, and the segments that may cross it.
struct Piece {
  Polygon3 polygon;
  std::vector<Segment> segments;
};

/// A line in the plane of a triangle.
class Line {
 public:
  Line(const Segment& segment, const Point<3>& normal) : origin_(segment[0]) {
    across_ = cross(normal, difference(segment[1], segment[0]));
    length_ = norm(across_);
  }
  /// Distance to the left of the line.
  double distance(const Point<3>& point) const {
    return length_ > 0.0 ? dot(across_, difference(point, origin_)) / length_ : 0.0;
  }
  std::vector<double> distances(const auto& points) const {
    std::vector<double> result;
    for (const Point<3>& point : points) result.push_back(distance(point));
    return result;
  }

 private:
  Point<3> origin_, across_;
  double length_;
};

Point<3> crossing(const Point<3>& a, const Point<3>& b, double of_a, double of_b) {
  // The same for both directions of an edge.
  if (b < a) return crossing(b, a, of_b, of_a);
  return between(a, b, of_a / (of_a - of_b));
}

/// Whether more than a tolerance of a segment lies inside a convex polygon.
bool reaches(const Segment& segment, const Polygon3& polygon, const Point<3>& normal, double tolerance) {
  double low = 0.0, high = 1.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Line edge({polygon[i], polygon[(i + 1) % polygon.size()]}, normal);
    const double start = edge.distance(segment[0]), end = edge.distance(segment[1]);
    if (start <= tolerance && end <= tolerance) return false;
    if (start < 0.0) low = std::max(low, start / (start - end));
    if (end < 0.0) high = std::min(high, start / (start - end));
  }
  return (high - low) * norm(difference(segment[1], segment[0])) > tolerance;
}

/// Shares a piece out to both sides of a line that crosses it.
std::pair<Piece, Piece> divided(const Piece& piece, const Line& line, double tolerance) {
  std::pair<Piece, Piece> result;
  auto& [left, right] = result;
  const std::vector<double> of_corner = line.distances(piece.polygon);
  for (std::size_t i = 0; i < of_corner.size(); ++i) {
    const std::size_t next = (i + 1) % of_corner.size();
    const double here = of_corner[i], there = of_corner[next];
    if (here >= -tolerance) left.polygon.push_back(piece.polygon[i]);
    if (here <= tolerance) right.polygon.push_back(piece.polygon[i]);
    if ((here > tolerance && there < -tolerance) || (here < -tolerance && there > tolerance)) {
      const Point<3> point = crossing(piece.polygon[i], piece.polygon[next], here, there);
      left.polygon.push_back(point);
      right.polygon.push_back(point);
    }
  }
  for (const Segment& segment : piece.segments) {
    const double start = line.distance(segment[0]), end = line.distance(segment[1]);
    const bool on_left = std::max(start, end) > tolerance, on_right = std::min(start, end) < -tolerance;
    if (on_left && on_right) {
      const Point<3> point = crossing(segment[0], segment[1], start, end);
      (start > 0.0 ? left : right).segments.push_back({segment[0], point});
      (end > 0.0 ? left : right).segments.push_back({point, segment[1]});
    } else if (on_left || on_right) {
      (on_left ? left : right).segments.push_back(segment);
    }
  }
  return result;
}

}  // namespace

std::vector<Polygon3> split_triangle(const std::array<Point<3>, 3>& triangle, std::vector<Segment> segments,
                                     double tolerance) {
  const Point<3> normal = cross(difference(triangle[1], triangle[0]), difference(triangle[2], triangle[0]));
  std::vector<Polygon3> done;
  std::vector<Piece> pieces = {{{triangle.begin(), triangle.end()}, std::move(segments)}};
  while (!pieces.empty()) {
    Piece piece = std::move(pieces.back());
    pieces.pop_back();
    if (piece.segments.empty()) {
      done.push_back(std::move(piece.polygon));
      continue;
    }
    std::swap(piece.segments[piece.segments.size() / 2], piece.segments.back());
    const Segment segment = piece.segments.back();
    piece.segments.pop_back();
    const Line line(segment, normal);
    const std::vector<double> sides = line.distances(piece.polygon);
    const auto [low, high] = std::minmax_element(sides.begin(), sides.end());
    if (*low >= -tolerance || *high <= tolerance || !reaches(segment, piece.polygon, normal, tolerance)) {
      pieces.push_back(std::move(piece));
      continue;
    }
    auto [left, right] = divided(piece, line, tolerance);
    pieces.push_back(std::move(left));
    pieces.push_back(std::move(right));
  }
  return done;
}

}  // namespace fabseq
