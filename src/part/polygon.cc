// SPDX-License-Identifier: MIT
#include "fabseq/part/polygon.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace fabseq {

namespace {

/// Entries of all strips together, for each edge.
constexpr double most_strips_of_an_edge = 8.0;

double distance_to_edge(const Polygon::Point& point, const Polygon::Point& start, const Polygon::Point& end) {
  const Polygon::Point edge = {end[0] - start[0], end[1] - start[1]};
  const Polygon::Point offset = {point[0] - start[0], point[1] - start[1]};
  const double square = edge[0] * edge[0] + edge[1] * edge[1];
  const double along =
      square > 0.0 ? std::clamp((offset[0] * edge[0] + offset[1] * edge[1]) / square, 0.0, 1.0) : 0.0;
  return std::hypot(offset[0] - along * edge[0], offset[1] - along * edge[1]);
}

/// Whether the ray from `point` towards larger first coordinates crosses the edge.
bool ray_crosses(const Polygon::Point& point, const Polygon::Point& start, const Polygon::Point& end) {
  if ((start[1] > point[1]) == (end[1] > point[1])) return false;
  const double share = (point[1] - start[1]) / (end[1] - start[1]);
  return point[0] < start[0] + share * (end[0] - start[0]);
}

}  // namespace

Polygon::Polygon(std::vector<Point> corners) : corners_(std::move(corners)) {
  if (corners_.empty()) return;
  double high = low_ = corners_.front()[1];
  double edges = 0.0;
  for (std::size_t edge = 0; edge < corners_.size(); ++edge) {
    const double from = start(static_cast<std::int32_t>(edge))[1], to = corners_[edge][1];
    low_ = std::min(low_, to);
    high = std::max(high, to);
    edges += std::abs(to - from);
  }
  const double height = high - low_, number = static_cast<double>(corners_.size());
  // Long edges reach into many strips: these are wider then.
  const double count = edges > 0.0 ? std::min(number, most_strips_of_an_edge * number * height / edges) : 1.0;
  strips_.resize(std::max<std::size_t>(1, static_cast<std::size_t>(count)));
  width_ = height / static_cast<double>(strips_.size());
  for (std::size_t edge = 0; edge < corners_.size(); ++edge) {
    const auto index = static_cast<std::int32_t>(edge);
    const auto [first, last] = std::minmax({strip_of(start(index)[1]), strip_of(end(index)[1])});
    for (std::size_t strip = first; strip <= last; ++strip) strips_[strip].push_back(index);
  }
}

std::size_t Polygon::strip_of(double coordinate) const {
  if (!(width_ > 0.0) || !(coordinate > low_)) return 0;
  return static_cast<std::size_t>(
      std::min((coordinate - low_) / width_, static_cast<double>(strips_.size() - 1)));
}

bool Polygon::contains(const Point& point, double tolerance) const {
  if (corners_.empty()) return false;
  for (std::size_t strip = strip_of(point[1] - tolerance); strip <= strip_of(point[1] + tolerance); ++strip)
    for (const std::int32_t edge : strips_[strip])
      if (distance_to_edge(point, start(edge), end(edge)) <= tolerance) return true;
  bool inside = false;
  for (const std::int32_t edge : strips_[strip_of(point[1])])
    if (ray_crosses(point, start(edge), end(edge))) inside = !inside;
  return inside;
}

}  // namespace fabseq
