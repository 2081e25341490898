// SPDX-License-Identifier: MIT
/// \file
/// Constructive solid geometry: which points belong to a part, a node set, a start region.
#pragma once

#include "fabseq/part/polygon.h"

#include <span>
#include <vector>

namespace fabseq {

/// Shapes contain points up to this share of the smallest spacing outside their surface (docs/reference.md,
/// conventions).
inline constexpr double shape_tolerance = 1e-6;

/// A primitive or a boolean combination of shapes, in 2D or 3D. Coordinates have as many entries as the
/// domain has dimensions.
struct Shape {
  enum class Kind { box, half_space, cylinder, sphere, polygon, union_of, intersection, difference };

  Kind kind = Kind::union_of;
  std::vector<double> first;   ///< box min, half_space point, cylinder from, sphere center
  std::vector<double> second;  ///< box max, half_space normal, cylinder to
  double radius = 0.0;         ///< cylinder, sphere
  int axis = 2;                ///< polygon in 3D: axis along which it is extruded through the box
  /// Polygon whose corners in 3D are the coordinates along the two other axes in ascending order.
  Polygon polygon;
  std::vector<Shape> operands;  ///< union_of, intersection, difference (the first minus all others)

  /// Whether `point` (one coordinate per axis) lies inside or at most `tolerance` outside; both in length
  /// units.
  bool contains(std::span<const double> point, double tolerance) const;
  friend bool operator==(const Shape&, const Shape&) = default;
};

}  // namespace fabseq
