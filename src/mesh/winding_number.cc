// SPDX-License-Identifier: MIT
#include "fabseq/mesh/winding_number.h"

#include "mesh/normal_moments.h"
#include "mesh/vectors.h"

#include <algorithm>
#include <cmath>

namespace fabseq {

namespace {

/// Triangles are far away from this many radii of their node on; error and effort of a walk balance near 2
/// (Barill et al. 2018, section 4).
constexpr double accuracy = 2.0;
/// Triangles in a leaf: with fewer, the nodes would take more memory than the triangles.
constexpr std::size_t leaf_size = 8;

/// tan of half the solid angle of a triangle at the origin, as `sine` / `cosine` up to a common positive
/// factor (Van Oosterom & Strackee 1983).
struct HalfAngle {
  double sine, cosine;
};

inline HalfAngle half_solid_angle(const Point<3>& a, const Point<3>& b, const Point<3>& c) {
  const double la = norm(a), lb = norm(b), lc = norm(c);
  return {dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb};
}

}  // namespace

/// Points of a call and what they have gathered so far, [point].
struct WindingNumber::Group {
  std::size_t count;
  double x[group_limit], y[group_limit], z[group_limit];
  double far[group_limit] = {};  ///< solid angle of nodes far away
  /// Half the solid angle of the triangles close by is the argument of the product of their cosine + i sine,
  /// plus so many full turns. So a single arctangent does for all of them.
  double cosine[group_limit], sine[group_limit] = {}, turns[group_limit] = {};

  explicit Group(std::span<const Point<3>> points) : count(points.size()) {
    for (std::size_t i = 0; i < count; ++i) {
      x[i] = points[i][0];
      y[i] = points[i][1];
      z[i] = points[i][2];
    }
    std::fill_n(cosine, group_limit, 1.0);
  }

  void add_far(const Node& node) {
    const auto [cx, cy, cz] = node.center;  // copies, which no store below can change
    const auto [nx, ny, nz] = node.normal;
    const auto [xx, yy, zz, xy, yz, zx] = node.first;
    const auto [xxx, yyy, zzz, xxy, xxz, yyx, yyz, zzx, zzy, xyz] = node.second;
    for (std::size_t i = 0; i < count; ++i) {
      const double dx = cx - x[i], dy = cy - y[i], dz = cz - z[i];
      const double x2 = dx * dx, y2 = dy * dy, z2 = dz * dz;
      const double inverse2 = 1.0 / (x2 + y2 + z2);
      const double linear = nx * dx + ny * dy + nz * dz;
      const double quadratic = xx * x2 + yy * y2 + zz * z2 + dx * (xy * dy + zx * dz) + yz * dy * dz;
      const double cubic = dx * (xxx * x2 + yyx * y2 + zzx * z2 + xyz * dy * dz) +
                           dy * (yyy * y2 + xxy * x2 + zzy * z2) + dz * (zzz * z2 + xxz * x2 + yyz * y2);
      far[i] += inverse2 * std::sqrt(inverse2) * (linear + inverse2 * (quadratic + inverse2 * cubic));
    }
  }

  void add_close(const Point<3> a, const Point<3> b, const Point<3> c) {
    for (std::size_t i = 0; i < count; ++i) {
      const Point<3> point = {x[i], y[i], z[i]};
      HalfAngle half = half_solid_angle(difference(a, point), difference(b, point), difference(c, point));
      // In the triangle's plane no side is the right one: the triangle counts nothing.
      half.cosine = half.sine == 0.0 ? 1.0 : half.cosine;
      const double re = cosine[i] * half.cosine - sine[i] * half.sine;
      const double im = cosine[i] * half.sine + sine[i] * half.cosine;
      // A turn is complete where both angles have one sign and their sum, in (-pi, pi], has the other.
      const double before = std::copysign(1.0, sine[i]), added = std::copysign(1.0, half.sine);
      turns[i] += 0.25 * (before + added) * (1.0 - std::copysign(before, im) * before);
      const double scale = 1.0 / (std::abs(re) + std::abs(im));
      cosine[i] = re * scale;
      sine[i] = im * scale;
    }
  }

  double value(std::size_t i) const {
    return (0.5 * far[i] + std::atan2(sine[i], cosine[i])) / (2.0 * M_PI) + turns[i];
  }
};

WindingNumber::WindingNumber(const TriangleMesh& mesh) : points_(mesh.points) {
  if (mesh.triangles.empty()) return;
  std::vector<Item> items(mesh.triangles.size());
  for (std::size_t t = 0; t < items.size(); ++t) {
    const auto [a, b, c] = mesh.corners(t);
    items[t].triangle = static_cast<std::int32_t>(t);
    for (int axis = 0; axis < 3; ++axis)
      items[t].centroid[axis] = static_cast<float>((a[axis] + b[axis] + c[axis]) / 3.0);
  }
  triangles_.reserve(items.size());
  build(mesh, items);
  nodes_.shrink_to_fit();
}

NormalMoments WindingNumber::build(const TriangleMesh& mesh, std::span<Item> items) {
  const std::size_t number = nodes_.size();
  const auto begin = static_cast<std::int32_t>(triangles_.size());
  nodes_.push_back({});
  std::int32_t second_child = 0;
  NormalMoments moments;
  if (items.size() <= leaf_size) {
    std::array<NormalMoments, leaf_size> parts;
    for (std::size_t t = 0; t < items.size(); ++t) {
      triangles_.push_back(mesh.triangles[items[t].triangle]);
      const auto [a, b, c] = mesh.corners(items[t].triangle);
      parts[t] = moments_of_triangle(a, b, c);
    }
    moments = join(std::span(parts).first(items.size()));
  } else {
    std::array<float, 3> low = items.front().centroid, high = low;
    for (const Item& item : items)
      for (int axis = 0; axis < 3; ++axis) {
        low[axis] = std::min(low[axis], item.centroid[axis]);
        high[axis] = std::max(high[axis], item.centroid[axis]);
      }
    int longest = 0;
    for (const int axis : {1, 2})
      if (high[axis] - low[axis] > high[longest] - low[longest]) longest = axis;
    // A multiple of the size of a leaf, so that all leaves but one are full.
    const std::size_t half = (items.size() / 2 + leaf_size - 1) / leaf_size * leaf_size;
    std::nth_element(items.begin(), items.begin() + static_cast<std::ptrdiff_t>(half), items.end(),
                     [=](const Item& a, const Item& b) { return a.centroid[longest] < b.centroid[longest]; });
    std::array<NormalMoments, 2> children;
    children[0] = build(mesh, items.first(half));
    second_child = static_cast<std::int32_t>(nodes_.size());
    children[1] = build(mesh, items.subspan(half));
    moments = join(children);
  }
  Node& node = nodes_[number];
  node.second_child = second_child;
  node.begin = begin;
  node.end = static_cast<std::int32_t>(triangles_.size());
  fill(node, moments);
  return moments;
}

void WindingNumber::fill(Node& node, NormalMoments moments) const {
  double square = 0.0;
  for (std::int32_t t = node.begin; t < node.end; ++t)
    for (const std::int32_t corner : triangles_[t]) {
      const Point<3> offset = difference(points_[corner], moments.center);
      square = std::max(square, dot(offset, offset));
    }
  node.center = moments.center;
  node.reach = static_cast<float>(accuracy * std::sqrt(square));
  moments.make_harmonic();
  const auto copy = [](const auto& from, auto& to, double factor) {
    for (std::size_t i = 0; i < from.size(); ++i) to[i] = static_cast<float>(factor * from[i]);
  };
  copy(moments.normal, node.normal, 1.0);
  copy(moments.first, node.first, -3.0);
  copy(moments.second, node.second, 7.5);
}

void WindingNumber::walk(const Point<3>& center, double radius, Group& group) const {
  std::array<std::int32_t, 64> pending;  // one per level of the tree, of which there are up to 32
  std::size_t count = 0;
  if (!nodes_.empty()) pending[count++] = 0;
  while (count > 0) {
    const std::int32_t number = pending[--count];
    const Node& node = nodes_[number];
    const Point<3> offset = difference(node.center, center);
    const double reach = node.reach + radius;
    if (dot(offset, offset) > reach * reach) {
      group.add_far(node);
    } else if (node.second_child == 0) {
      for (std::int32_t t = node.begin; t < node.end; ++t)
        group.add_close(points_[triangles_[t][0]], points_[triangles_[t][1]], points_[triangles_[t][2]]);
    } else {
      pending[count++] = node.second_child;
      pending[count++] = number + 1;
    }
  }
}

void WindingNumber::at(std::span<const Point<3>> points, const Point<3>& center, double radius,
                       std::span<double> values) const {
  Group group(points);
  walk(center, radius, group);
  for (std::size_t i = 0; i < points.size(); ++i) values[i] = group.value(i);
}

}  // namespace fabseq
