// SPDX-License-Identifier: MIT
#include "mesh/cut_out.h"

#include "fabseq/base/error.h"
#include "fabseq/mesh/winding_number.h"
#include "mesh/crossing_lines.h"
#include "mesh/mesh_pieces.h"
#include "mesh/split_triangle.h"
#include "mesh/stitched.h"
#include "mesh/vectors.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fabseq {

namespace {

constexpr double least_length = 1e-11;  ///< of the diagonal of the box around both
constexpr double joined = 4.0;          ///< least lengths: so far apart, points are one
constexpr double beside = 20.0;         ///< least lengths: how far beside a piece it is asked what is there
constexpr double inside = 0.2;          ///< widths of the piece, if that is less: others may be so near
constexpr int samples = 4000;
constexpr double most_contradictions = 2e-3;  ///< share of the samples

double winding(const WindingNumber& number, const Point<3>& point) {
  double result = 0.0;
  number.at({&point, 1}, point, 0.0, {&result, 1});
  return result;
}

class Cut {
 public:
  Cut(const TriangleMesh& body, const TriangleMesh& hole)
      : body_(body),
        hole_(hole),
        body_winding_(body),
        hole_winding_(hole),
        box_(bounds(body)),
        hole_box_(bounds(hole)) {
    const Bounds both = join(box_, hole_box_);
    double farthest = 0.0;
    for (int axis = 0; axis < 3; ++axis)
      farthest = std::max({farthest, std::abs(both.low[axis]), std::abs(both.high[axis])});
    tolerance_ = std::max(least_length * norm(difference(both.high, both.low)),
                          100.0 * std::numeric_limits<double>::epsilon() * farthest);
  }

  TriangleMesh result() {
    const CrossingLines lines = find_crossing_lines(body_, hole_, tolerance_);
    add_pieces(body_, lines.first,
               [this](const Point<3>& behind, const Point<3>&) { return in_hole(behind) ? 0 : 1; });
    // Turned round where the hole is behind the piece. On a face of the body, what is outside it counts.
    add_pieces(hole_, lines.second, [this](const Point<3>& behind, const Point<3>& before) {
      const int body = std::min(in_body(behind), in_body(before));
      const bool hole_behind = body > 0 && in_hole(behind);
      if (body == 0 || hole_behind == in_hole(before)) return 0;
      return hole_behind ? -body : body;
    });
    TriangleMesh mesh = stitched(pieces_, joined * tolerance_);
    refuse_contradictions(mesh);
    return mesh;
  }

 private:
  /// Adds the pieces of a surface as often as count(point behind it, point before it) says, turned round
  /// where that is negative.
  template <class Count>
  void add_pieces(const TriangleMesh& mesh, const std::vector<std::vector<Segment>>& lines,
                  const Count& count) {
    TriangleMesh whole{mesh.points, {}};
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const auto corners = mesh.corners(t);
      if (lines[t].empty()) whole.triangles.push_back(mesh.triangles[t]);
      if (lines[t].empty() || !has_area(corners)) continue;
      const std::vector<Polygon3> polygons = split_triangle(corners, lines[t], tolerance_);
      for (const Polygon3& polygon : polygons)
        add(polygon, polygons.size() > 1, times(polygon, corners, count));
    }
    // Those that hang together are all on one side of the other surface.
    for (const MeshPiece& piece : find_mesh_pieces(whole)) {
      const auto known = std::find_if(piece.triangles.begin(), piece.triangles.end(),
                                      [&](std::int32_t t) { return has_area(whole.corners(t)); });
      if (known == piece.triangles.end()) continue;
      const auto first = whole.corners(*known);
      const int number = times({first.begin(), first.end()}, first, count);
      for (const std::int32_t t : piece.triangles) {
        const auto corners = whole.corners(t);
        add({corners.begin(), corners.end()}, false, number);
      }
    }
  }

  /// Returns about the radius of the largest circle in a convex polygon.
  static double width_of(const Polygon3& polygon) {
    Point<3> area{};
    double around = 0.0;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Point<3>&a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
      around += norm(difference(b, a));
      const Point<3> twice = cross(difference(a, polygon[0]), difference(b, polygon[0]));
      for (int axis = 0; axis < 3; ++axis) area[axis] += twice[axis];
    }
    return around > 0.0 ? norm(area) / around : 0.0;
  }

  static bool has_area(const std::array<Point<3>, 3>& corners) {
    return norm(cross(difference(corners[1], corners[0]), difference(corners[2], corners[0]))) > 0.0;
  }

  void add(Polygon3 polygon, bool divided, int times) {
    if (times < 0) std::reverse(polygon.begin(), polygon.end());
    pieces_.insert(pieces_.end(), static_cast<std::size_t>(std::abs(times)), {std::move(polygon), divided});
  }

  /// What count() says of a convex polygon in a triangle.
  template <class Count>
  int times(const Polygon3& polygon, const std::array<Point<3>, 3>& corners, const Count& count) const {
    Point<3> step = cross(difference(corners[1], corners[0]), difference(corners[2], corners[0]));
    const double length = norm(step), far = std::min(beside * tolerance_, inside * width_of(polygon));
    for (double& x : step) x *= far / length;
    Point<3> behind{}, before{};
    for (int axis = 0; axis < 3; ++axis) {
      double middle = 0.0;
      for (const Point<3>& corner : polygon) middle += corner[axis] / static_cast<double>(polygon.size());
      behind[axis] = middle - step[axis];
      before[axis] = middle + step[axis];
    }
    return count(behind, before);
  }

  /// How often the body winds around a point, and whether the hole does.
  int in_body(const Point<3>& point) const {
    if (!overlap({point, point}, box_)) return 0;
    return static_cast<int>(std::lround(std::abs(winding(body_winding_, point))));
  }
  bool in_hole(const Point<3>& point) const {
    return overlap({point, point}, hole_box_) && std::abs(winding(hole_winding_, point)) >= 0.5;
  }

  /// Asks points of the body's box, always the same ones.
  void refuse_contradictions(const TriangleMesh& mesh) const {
    const WindingNumber number(mesh);
    int contradictions = 0;
    for (int i = 1; i <= samples; ++i) {
      Point<3> point;
      constexpr std::array<double, 3> steps = {0.8191725133961645, 0.6710436067037893, 0.5497004779019703};
      for (int axis = 0; axis < 3; ++axis) {
        const double share = i * steps[axis] - std::floor(i * steps[axis]);
        point[axis] = box_.low[axis] + share * (box_.high[axis] - box_.low[axis]);
      }
      const int wanted = in_hole(point) ? 0 : in_body(point);
      if (wanted != static_cast<int>(std::lround(std::abs(winding(number, point))))) ++contradictions;
    }
    if (contradictions > most_contradictions * samples)
      throw InputError(
          "has a negative volume that cannot be cut out of its body, whose surfaces are open or "
          "wind around themselves; needs closed surfaces, or a body that is cut already");
  }

  const TriangleMesh &body_, &hole_;
  WindingNumber body_winding_, hole_winding_;
  Bounds box_, hole_box_;
  double tolerance_;
  std::vector<SurfacePiece> pieces_;
};

}  // namespace

TriangleMesh cut_out(const TriangleMesh& body, const TriangleMesh& hole) { return Cut(body, hole).result(); }

}  // namespace fabseq
