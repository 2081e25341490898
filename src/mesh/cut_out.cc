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

constexpr double least_length = 1e-9;  ///< of the diagonal of the box around both
constexpr double beside = 20.0;        ///< least lengths: how far beside a piece it is asked what is there
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
      const bool hole_behind = in_hole(behind);
      if (hole_behind == in_hole(before)) return 0;
      const int body = std::min(in_body(behind), in_body(before));
      return hole_behind ? -body : body;
    });
    TriangleMesh mesh = stitched(pieces_, tolerance_);
    refuse_contradictions(mesh);
    return mesh;
  }

 private:
  /// Adds the pieces of a surface as often as count(behind, before) says, turned round where that is
  /// negative.
  template <class Count>
  void add_pieces(const TriangleMesh& mesh, const std::vector<std::vector<Segment>>& lines,
                  const Count& count) {
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const auto corners = mesh.corners(t);
      Point<3> step = cross(difference(corners[1], corners[0]), difference(corners[2], corners[0]));
      const double length = norm(step);
      if (!(length > 0.0)) continue;
      for (double& x : step) x *= beside * tolerance_ / length;
      const std::vector<Polygon3> polygons = split_triangle(corners, lines[t], tolerance_);
      for (const Polygon3& polygon : polygons) {
        Point<3> behind{}, before{};
        for (int axis = 0; axis < 3; ++axis) {
          double middle = 0.0;
          for (const Point<3>& corner : polygon) middle += corner[axis] / static_cast<double>(polygon.size());
          behind[axis] = middle - step[axis];
          before[axis] = middle + step[axis];
        }
        const int times = count(behind, before);
        SurfacePiece piece{polygon, polygons.size() > 1};
        if (times < 0) std::reverse(piece.polygon.begin(), piece.polygon.end());
        pieces_.insert(pieces_.end(), static_cast<std::size_t>(std::abs(times)), piece);
      }
    }
  }

  /// How often the body winds around a point, and whether the hole does.
  int in_body(const Point<3>& point) const {
    return static_cast<int>(std::lround(std::abs(winding(body_winding_, point))));
  }
  bool in_hole(const Point<3>& point) const {
    for (int axis = 0; axis < 3; ++axis)
      if (point[axis] < hole_box_.low[axis] || point[axis] > hole_box_.high[axis]) return false;
    return std::abs(winding(hole_winding_, point)) >= 0.5;
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

TriangleMesh part_of(const TriangleMesh& mesh, const MeshPiece& piece) {
  TriangleMesh result{mesh.points, {}};
  for (const std::int32_t t : piece.triangles) result.triangles.push_back(mesh.triangles[t]);
  return result;
}

bool overlap(const Bounds& a, const Bounds& b) {
  for (int axis = 0; axis < 3; ++axis)
    if (a.low[axis] > b.high[axis] || a.high[axis] < b.low[axis]) return false;
  return true;
}

/// Closed pieces that face outward, those whose boxes are apart together.
struct Group {
  std::vector<Bounds> boxes;
  TriangleMesh mesh;

  bool takes(const Bounds& box) const {
    return std::none_of(boxes.begin(), boxes.end(), [&](const Bounds& other) { return overlap(other, box); });
  }
};

}  // namespace

TriangleMesh cut_out(const TriangleMesh& body, const TriangleMesh& hole) { return Cut(body, hole).result(); }

TriangleMesh cut_out_piecewise(TriangleMesh body, const TriangleMesh& hole) {
  std::vector<Group> groups;
  for (const MeshPiece& piece : find_mesh_pieces(hole)) {
    if (!piece.closed || signed_volume(part_of(hole, piece)) < 0.0) return cut_out(body, hole);  // a cavity
    const Bounds box = bounds(hole, piece.triangles);
    auto group = std::find_if(groups.begin(), groups.end(), [&](const Group& g) { return g.takes(box); });
    if (group == groups.end()) group = groups.insert(group, {{}, {hole.points, {}}});
    group->boxes.push_back(box);
    for (const std::int32_t t : piece.triangles) group->mesh.triangles.push_back(hole.triangles[t]);
  }
  for (const Group& group : groups)
    if (!body.triangles.empty()) body = cut_out(body, group.mesh);
  return body;
}

}  // namespace fabseq
