// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/mesh/triangle_mesh.h"

#include <array>
#include <vector>

namespace fabseq {

/// Line from one point to another.
using Segment = std::array<Point<3>, 2>;

/// Where two surfaces meet: for each triangle of both, the segments along which triangles of the other one
/// cross it. Where triangles lie on each other, these are the edges of the other one, which may reach beyond
/// the triangle.
struct CrossingLines {
  std::vector<std::vector<Segment>> first, second;  ///< [triangle]
};

/// `tolerance`: lengths that count as none. Takes time in proportion to the pairs of triangles whose boxes
/// touch, and a part of all pairs along one axis.
CrossingLines find_crossing_lines(const TriangleMesh& first, const TriangleMesh& second, double tolerance);

}  // namespace fabseq
