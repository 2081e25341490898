// SPDX-License-Identifier: MIT
/// \file
/// Vectors in space.
#pragma once

#include "fabseq/grid/index_box.h"

#include <cmath>

namespace fabseq {

inline Point<3> difference(const Point<3>& a, const Point<3>& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
inline double dot(const Point<3>& a, const Point<3>& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline Point<3> cross(const Point<3>& a, const Point<3>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
/// The point at that share of the way from a to b.
inline Point<3> between(const Point<3>& a, const Point<3>& b, double share) {
  return {a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1]), a[2] + share * (b[2] - a[2])};
}
inline double norm(const Point<3>& a) { return std::sqrt(dot(a, a)); }

}  // namespace fabseq
