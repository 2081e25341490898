// SPDX-License-Identifier: MIT
#pragma once

#include "mesh/crossing_lines.h"

#include <array>
#include <vector>

namespace fabseq {

/// A flat convex polygon in space.
using Polygon3 = std::vector<Point<3>>;

/// Convex pieces of a triangle, turned like it, none of which a segment crosses. Segments lie in its plane;
/// what of them lies outside does not count. `tolerance`: lengths that count as none.
std::vector<Polygon3> split_triangle(const std::array<Point<3>, 3>& triangle, std::vector<Segment> segments,
                                     double tolerance);

}  // namespace fabseq
