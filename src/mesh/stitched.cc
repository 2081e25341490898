// SPDX-License-Identifier: MIT
#include "mesh/stitched.h"

#include "mesh/vectors.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <utility>

namespace fabseq {

namespace {

/// Points by their places, those close together as one. Cells are cubes.
class PointNumbers {
 public:
  explicit PointNumbers(double tolerance) : tolerance_(tolerance), cell_(4.0 * tolerance) {}

  std::int32_t number_of(const Point<3>& point) {
    std::array<std::array<std::int64_t, 2>, 3> range;
    for (int axis = 0; axis < 3; ++axis)
      range[axis] = {cell_of(point[axis] - tolerance_), cell_of(point[axis] + tolerance_)};
    for (std::int64_t x = range[0][0]; x <= range[0][1]; ++x)
      for (std::int64_t y = range[1][0]; y <= range[1][1]; ++y)
        for (std::int64_t z = range[2][0]; z <= range[2][1]; ++z) {
          const auto found = cells_.find({x, y, z});
          if (found == cells_.end()) continue;
          for (const std::int32_t number : found->second)
            if (norm(difference(points_[number], point)) <= tolerance_) return number;
        }
    points_.push_back(point);
    const auto number = static_cast<std::int32_t>(points_.size() - 1);
    cells_[{cell_of(point[0]), cell_of(point[1]), cell_of(point[2])}].push_back(number);
    return number;
  }
  const std::vector<Point<3>>& points() const { return points_; }

 private:
  using Cell = std::array<std::int64_t, 3>;
  struct Hash {
    std::size_t operator()(const Cell& cell) const {
      std::uint64_t hash = 0;
      for (const std::int64_t index : cell) {
        hash = (hash ^ static_cast<std::uint64_t>(index)) * 0x9e3779b97f4a7c15;
        hash ^= hash >> 32;
      }
      return hash;
    }
  };
  std::int64_t cell_of(double coordinate) const {
    return static_cast<std::int64_t>(std::floor(coordinate / cell_));
  }

  double tolerance_, cell_;
  std::vector<Point<3>> points_;
  std::unordered_map<Cell, std::vector<std::int32_t>, Hash> cells_;
};

/// Which of some points lie within an edge.
class PointsOnEdges {
 public:
  PointsOnEdges(const std::vector<Point<3>>& points, std::vector<std::int32_t> candidates, double tolerance)
      : points_(points), tolerance_(tolerance) {
    std::sort(candidates.begin(), candidates.end());
    candidates.erase(std::unique(candidates.begin(), candidates.end()), candidates.end());
    for (const std::int32_t number : candidates) sorted_.emplace_back(along(points[number]), number);
    std::sort(sorted_.begin(), sorted_.end());
  }

  /// Returns the points strictly between `from` and `to`, in this order.
  std::vector<std::int32_t> between(std::int32_t from, std::int32_t to) const {
    const Point<3>& start = points_[from];
    const Point<3> edge = difference(points_[to], start);
    const double square = dot(edge, edge);
    const auto [low, high] = std::minmax({along(start), along(points_[to])});
    std::vector<std::pair<double, std::int32_t>> found;
    for (auto it = std::lower_bound(sorted_.begin(), sorted_.end(), std::pair(low - tolerance_, -1));
         it != sorted_.end() && it->first <= high + tolerance_; ++it) {
      if (it->second == from || it->second == to) continue;
      const Point<3> offset = difference(points_[it->second], start);
      const double share = dot(offset, edge) / square;
      if (!(share > 0.0 && share < 1.0)) continue;
      Point<3> away;
      for (int axis = 0; axis < 3; ++axis) away[axis] = offset[axis] - share * edge[axis];
      if (norm(away) <= tolerance_) found.emplace_back(share, it->second);
    }
    std::sort(found.begin(), found.end());
    std::vector<std::int32_t> result;
    for (const auto& [share, number] : found) result.push_back(number);
    return result;
  }

 private:
  /// Returns the coordinate along a direction across which no face of a usual part lies.
  static double along(const Point<3>& point) { return dot(point, Point<3>{0.6173, 0.5191, 0.5911}); }

  const std::vector<Point<3>>& points_;
  double tolerance_;
  std::vector<std::pair<double, std::int32_t>> sorted_;
};

/// A fan of triangles: around the middle, in which none is without area, where there are more than three
/// corners.
void add_triangles(const std::vector<std::int32_t>& polygon, TriangleMesh& mesh) {
  if (polygon.size() == 3) {
    mesh.triangles.push_back({polygon[0], polygon[1], polygon[2]});
    return;
  }
  Point<3> middle{};
  for (const std::int32_t corner : polygon)
    for (int axis = 0; axis < 3; ++axis)
      middle[axis] += mesh.points[corner][axis] / static_cast<double>(polygon.size());
  const auto center = static_cast<std::int32_t>(mesh.points.size());
  mesh.points.push_back(middle);
  for (std::size_t i = 0; i < polygon.size(); ++i)
    mesh.triangles.push_back({polygon[i], polygon[(i + 1) % polygon.size()], center});
}

}  // namespace

TriangleMesh stitched(const std::vector<SurfacePiece>& pieces, double tolerance) {
  PointNumbers numbers(tolerance);
  std::vector<std::vector<std::int32_t>> polygons;
  std::vector<std::int32_t> candidates;
  for (const SurfacePiece& piece : pieces) {
    std::vector<std::int32_t>& polygon = polygons.emplace_back();
    for (const Point<3>& corner : piece.polygon) polygon.push_back(numbers.number_of(corner));
    polygon.erase(std::unique(polygon.begin(), polygon.end()), polygon.end());
    while (polygon.size() > 1 && polygon.front() == polygon.back()) polygon.pop_back();
    if (piece.divided) candidates.insert(candidates.end(), polygon.begin(), polygon.end());
  }
  const PointsOnEdges on_edges(numbers.points(), std::move(candidates), tolerance);
  TriangleMesh mesh;
  mesh.points = numbers.points();
  for (const std::vector<std::int32_t>& polygon : polygons) {
    if (polygon.size() < 3) continue;
    std::vector<std::int32_t> whole;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      whole.push_back(polygon[i]);
      const std::int32_t from = polygon[i], to = polygon[(i + 1) % polygon.size()];
      for (const std::int32_t number : on_edges.between(from, to)) {
        whole.push_back(number);
        for (int axis = 0; axis < 3; ++axis)  // without rounding where the edge lies in a plane of the axes
          if (mesh.points[from][axis] == mesh.points[to][axis])
            mesh.points[number][axis] = mesh.points[from][axis];
      }
    }
    add_triangles(whole, mesh);
  }
  return mesh;
}

}  // namespace fabseq
