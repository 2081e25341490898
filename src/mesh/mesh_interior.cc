// SPDX-License-Identifier: MIT
#include "fabseq/mesh/mesh_interior.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

namespace fabseq {

namespace {

/// The lines of samples along x in one plane z = constant, and where they cross triangles.
class SamplePlane {
 public:
  explicit SamplePlane(const IndexBox<3>& box)
      : samples_(samples_per_axis * box.size[0]),
        lines_(samples_per_axis * box.size[1]),
        first_sample_(samples_per_axis * box.start[0]),
        first_line_(samples_per_axis * box.start[1]),
        changes_(static_cast<std::size_t>(lines_) * samples_),
        touched_(static_cast<std::size_t>(lines_)) {}

  /// Crosses the plane at `z` with a triangle; `points` are in samples.
  void cross(const std::array<std::int32_t, 3>& triangle, const std::vector<Point<3>>& points, double z) {
    std::array<End, 2> ends{};
    int found = 0;
    for (int i = 0; i < 3; ++i) {
      const std::int32_t from = triangle[i], to = triangle[(i + 1) % 3];
      if ((points[from][2] <= z) == (points[to][2] <= z)) continue;
      // Rounding must be the same in both triangles of an edge: it always starts at the same point.
      const Point<3>&p = points[std::min(from, to)], &q = points[std::max(from, to)];
      const double share = (z - p[2]) / (q[2] - p[2]);
      ends[found++] = {p[0] + share * (q[0] - p[0]), p[1] + share * (q[1] - p[1]),
                       points[from][2] <= z ? 1 : -1};
    }
    if (found == 0) return;
    if (ends[0].y > ends[1].y) std::swap(ends[0], ends[1]);
    const int begin = first_from(ends[0].y, first_line_, lines_);
    const int end = first_from(ends[1].y, first_line_, lines_);
    for (int line = begin; line < end; ++line) {
      const double share = (line + first_line_ - ends[0].y) / (ends[1].y - ends[0].y);
      const double x = ends[0].x + share * (ends[1].x - ends[0].x);
      const int sample = first_from(x, first_sample_, samples_);
      if (sample == samples_) continue;
      changes_[static_cast<std::size_t>(line) * samples_ + sample] += ends[1].sign;
      touched_[line] = 1;
    }
  }

  /// Adds the shares of samples inside to `fractions`, an entry per element of the layer that the plane runs
  /// through, and forgets all crossings.
  void take(double* fractions) {
    constexpr double sample = 1.0 / samples_per_element;
    for (int line = 0; line < lines_; ++line) {
      if (touched_[line] == 0) continue;
      touched_[line] = 0;
      const int elements = samples_ / samples_per_axis;
      double* row = fractions + static_cast<std::ptrdiff_t>(line / samples_per_axis) * elements;
      std::int32_t* change = &changes_[static_cast<std::size_t>(line) * samples_];
      std::int32_t winding = 0;
      for (int e = 0; e < elements; ++e, change += samples_per_axis) {
        int inside = 0;
        for (int s = 0; s < samples_per_axis; ++s) {
          winding += change[s];
          change[s] = 0;
          inside += winding != 0 ? 1 : 0;
        }
        row[e] += inside * sample;
      }
    }
  }

 private:
  /// Where the plane cuts an edge, and 1 if the edge runs upwards, -1 if downwards.
  struct End {
    double x, y;
    int sign;
  };

  /// The first i from 0 to `count` - 1 with `first` + i >= `value`, `count` if there is none.
  static int first_from(double value, int first, int count) {
    return static_cast<int>(std::clamp(std::ceil(value) - first, 0.0, static_cast<double>(count)));
  }

  int samples_, lines_, first_sample_, first_line_;
  std::vector<std::int32_t> changes_;  ///< [line][sample]: change of the winding number before the sample
  std::vector<char> touched_;          ///< [line]: whether there is a change
};

/// Triangles with their lowest z, in ascending order.
std::vector<std::pair<double, std::int32_t>> by_height(const TriangleMesh& mesh,
                                                       const std::vector<Point<3>>& points) {
  std::vector<std::pair<double, std::int32_t>> result;
  result.reserve(mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    result.emplace_back(std::min({points[a][2], points[b][2], points[c][2]}), static_cast<std::int32_t>(t));
  }
  std::sort(result.begin(), result.end());
  return result;
}

/// Share of the samples of each element of `box` around which a closed mesh winds, lexicographic. The mesh
/// may be inside out or overlap itself.
///
/// A line along x through samples crosses as many triangles in one direction as in the other, and the winding
/// number at a sample is the sum over those before it. Lines that run through edges and corners are no
/// exception: a triangle's part in a line is a sum over its edges, and at an edge between two triangles these
/// add the same number with opposite signs, rounding included. Takes time in proportion to the number of
/// crossings, whatever the shape of the triangles.
std::vector<double> closed_fractions(const TriangleMesh& mesh, const ElementLattice& lattice,
                                     const IndexBox<3>& box) {
  std::vector<double> fractions(static_cast<std::size_t>(box.count()), 0.0);
  if (fractions.empty()) return fractions;
  std::vector<Point<3>> points(mesh.points.size());
  std::transform(mesh.points.begin(), mesh.points.end(), points.begin(),
                 [&](const Point<3>& point) { return lattice.in_samples(point); });
  const auto sorted = by_height(mesh, points);
  auto next = sorted.begin();
  std::vector<std::int32_t> active;  // triangles that the plane cuts
  SamplePlane plane(box);
  const auto layer = static_cast<std::ptrdiff_t>(box.size[0]) * box.size[1];
  for (int row = 0; row < samples_per_axis * box.size[2]; ++row) {
    const double z = samples_per_axis * box.start[2] + row;
    for (; next != sorted.end() && next->first <= z; ++next) active.push_back(next->second);
    const auto is_below = [&](std::int32_t t) {
      const auto& [a, b, c] = mesh.triangles[t];
      return points[a][2] <= z && points[b][2] <= z && points[c][2] <= z;
    };
    std::erase_if(active, is_below);
    for (const std::int32_t t : active) plane.cross(mesh.triangles[t], points, z);
    plane.take(&fractions[row / samples_per_axis * layer]);
  }
  return fractions;
}

}  // namespace

MeshInterior::MeshInterior(const TriangleMesh& mesh) : mesh_(mesh) {
  if (!is_closed(mesh)) winding_.emplace(mesh);
}

FillFractions MeshInterior::fill_fractions(const ElementLattice& lattice, const IndexBox<3>& box) const {
  if (winding_) return open_fractions(mesh_, *winding_, lattice, box);
  return {closed_fractions(mesh_, lattice, box), {}};
}

}  // namespace fabseq
