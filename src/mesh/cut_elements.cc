// SPDX-License-Identifier: MIT
#include "mesh/cut_elements.h"

#include "mesh/vectors.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace fabseq {

namespace {

/// Tolerance in elements: far above rounding, far below what the samples of an element see. Without it, a
/// face between two elements that lies in the surface might belong to neither.
constexpr double tolerance = 1e-6;

/// Marks the elements that one triangle touches. Everything is in elements, relative to its first corner:
/// rounding is then relative to the size of the triangle and the elements, not to that of the grid.
class TriangleMarker {
 public:
  TriangleMarker(const Point<3>& a, const Point<3>& b, const Point<3>& c) : origin_(a) {
    const Point<3> ab = difference(b, a), ac = difference(c, a), bc = difference(c, b);
    std::size_t slab = 0;
    const auto add = [&](const Point<3>& normal) {
      const auto [low, high] = std::minmax({0.0, dot(normal, ab), dot(normal, ac)});
      slabs_[slab++] = {normal, low, high};
    };
    add(cross(ab, ac));
    for (const Point<3>& edge : {ab, ac, bc})
      for (int axis = 0; axis < 3; ++axis) {
        Point<3> direction{};
        direction[axis] = 1.0;
        add(cross(edge, direction));
      }
  }

  /// `range` lies in `box` and within the bounds of the triangle; `marks` has an entry per element of `box`.
  /// Halves of the range that the triangle does not touch are left alone, so that large slanted triangles
  /// take time in proportion to the elements that they cut.
  void mark(const IndexBox<3>& range, const IndexBox<3>& box, std::vector<char>& marks) const {
    const bool single = range.count() == 1;
    if ((single && marks[box.offset(range.start)] != 0) || !touches(range)) return;
    if (single) {
      marks[box.offset(range.start)] = 1;
      return;
    }
    const auto longest = std::max_element(range.size.begin(), range.size.end()) - range.size.begin();
    IndexBox<3> lower = range, upper = range;
    lower.size[longest] /= 2;
    upper.start[longest] += lower.size[longest];
    upper.size[longest] -= lower.size[longest];
    mark(lower, box, marks);
    mark(upper, box, marks);
  }

 private:
  /// The triangle lies where `low` <= normal . x <= `high`.
  struct Slab {
    Point<3> normal;
    double low, high;
  };

  /// Whether no slab separates the range from the triangle. With the box around the triangle, these are all
  /// candidates for a separating plane of a triangle and a box (Akenine-Moeller 2001).
  bool touches(const IndexBox<3>& range) const {
    Point<3> center, half;
    for (int axis = 0; axis < 3; ++axis) {
      half[axis] = 0.5 * range.size[axis] + tolerance;
      center[axis] = range.start[axis] + 0.5 * range.size[axis] - origin_[axis];
    }
    return std::all_of(slabs_.begin(), slabs_.end(), [&](const Slab& slab) {
      double reach = 0.0;
      for (int axis = 0; axis < 3; ++axis) reach += std::abs(slab.normal[axis]) * half[axis];
      const double middle = dot(slab.normal, center);
      return middle + reach >= slab.low && middle - reach <= slab.high;
    });
  }

  Point<3> origin_;
  std::array<Slab, 10> slabs_;
};

/// The elements of `box` that the box around a triangle touches; of size 0 along some axis if there are none.
IndexBox<3> range_of(const std::array<Point<3>, 3>& corners, const IndexBox<3>& box) {
  IndexBox<3> range;
  for (int axis = 0; axis < 3; ++axis) {
    const auto [low, high] = std::minmax({corners[0][axis], corners[1][axis], corners[2][axis]});
    const double first = box.start[axis], end = first + box.size[axis];
    const double from = std::clamp(std::floor(low - tolerance), first, end);
    const double to = std::clamp(std::floor(high + tolerance) + 1.0, from, end);
    range.start[axis] = static_cast<int>(from);
    range.size[axis] = static_cast<int>(to - from);
  }
  return range;
}

}  // namespace

std::vector<char> cut_elements(const TriangleMesh& mesh, const ElementLattice& lattice,
                               const IndexBox<3>& box) {
  std::vector<char> marks(static_cast<std::size_t>(box.count()), 0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    std::array<Point<3>, 3> corners = mesh.corners(t);
    for (Point<3>& corner : corners) corner = lattice.in_elements(corner);
    const IndexBox<3> range = range_of(corners, box);
    if (range.count() > 0) TriangleMarker(corners[0], corners[1], corners[2]).mark(range, box, marks);
  }
  return marks;
}

}  // namespace fabseq
