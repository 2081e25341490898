// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/grid/index_box.h"

#include <array>
#include <cstdint>
#include <vector>

namespace fabseq {

/// Moduli of coordinates are no larger: products of three lengths and more stay numbers.
inline constexpr double largest_mesh_coordinate = 1e30;

/// A surface of triangles in any order. It may be open, cut itself, or consist of several pieces.
struct TriangleMesh {
  std::vector<Point<3>> points;  ///< length unit
  /// Indices of corners in `points`. Seen from outside they run counterclockwise, unless the mesh is inside
  /// out.
  std::vector<std::array<std::int32_t, 3>> triangles;

  /// Corners of a triangle, [corner].
  std::array<Point<3>, 3> corners(std::size_t triangle) const {
    const auto& [a, b, c] = triangles[triangle];
    return {points[a], points[b], points[c]};
  }
};

struct Bounds {
  Point<3> low{}, high{};
};

/// The smallest box around all triangles that have an area; infinite with low > high if there are none.
Bounds bounds(const TriangleMesh& mesh);
/// The mesh with every point p at `matrix` p + `shift`; `matrix` is [row][column].
TriangleMesh transformed(TriangleMesh mesh, const std::array<Point<3>, 3>& matrix, const Point<3>& shift);
/// Volume that a closed mesh encloses: negative if it is inside out, counted as often as it is wound around.
/// Means nothing for an open mesh.
double signed_volume(const TriangleMesh& mesh);
/// Whether as many triangles run along every edge in one direction as in the other. Then the winding number
/// is an integer everywhere off the surface. Points at the same position must have been joined.
bool is_closed(const TriangleMesh& mesh);

}  // namespace fabseq
