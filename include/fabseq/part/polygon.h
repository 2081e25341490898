// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace fabseq {

/// A closed line of straight edges in a plane, which may cross itself: inside is what a ray out of it crosses
/// an odd number of edges from. Edges are sorted by strips, so that a point looks at few of many.
class Polygon {
 public:
  using Point = std::array<double, 2>;

  Polygon() = default;
  /// `corners`: in their order, the last one joined to the first.
  explicit Polygon(std::vector<Point> corners);

  const std::vector<Point>& corners() const { return corners_; }
  /// Whether a point lies inside, or at most `tolerance` away from an edge.
  bool contains(const Point& point, double tolerance) const;
  friend bool operator==(const Polygon& a, const Polygon& b) { return a.corners_ == b.corners_; }

 private:
  const Point& start(std::int32_t edge) const { return corners_[edge > 0 ? edge - 1 : corners_.size() - 1]; }
  const Point& end(std::int32_t edge) const { return corners_[edge]; }
  /// Number of the strip for a second coordinate, the nearest one for those outside.
  std::size_t strip_of(double coordinate) const;

  std::vector<Point> corners_;
  double low_ = 0.0, width_ = 0.0;                 ///< of the strips, along the second coordinate
  std::vector<std::vector<std::int32_t>> strips_;  ///< edges that reach into each
};

}  // namespace fabseq
