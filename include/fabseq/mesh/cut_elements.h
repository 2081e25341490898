// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/mesh/triangle_mesh.h"

#include <vector>

namespace fabseq {

/// Boxes of the same size side by side: element i covers `origin` + `spacing` * [i, i + 1] along each axis.
struct ElementLattice {
  Point<3> origin{};   ///< length unit
  Point<3> spacing{};  ///< length unit, positive

  /// Where a point lies, in elements.
  Point<3> in_elements(const Point<3>& point) const {
    Point<3> result;
    for (int axis = 0; axis < 3; ++axis) result[axis] = (point[axis] - origin[axis]) / spacing[axis];
    return result;
  }
  /// Point of an element: `share` is 0 at its lower and 1 at its upper end.
  Point<3> point_of(const Index<3>& element, const Point<3>& share) const {
    Point<3> result;
    for (int axis = 0; axis < 3; ++axis)
      result[axis] = origin[axis] + spacing[axis] * (element[axis] + share[axis]);
    return result;
  }
};

/// 1 for the elements of `box` that a triangle touches, 0 for others, lexicographic in `box`. Elements that
/// only touch a triangle with a face, an edge or a corner count, too, up to a millionth of an element.
std::vector<char> cut_elements(const TriangleMesh& mesh, const ElementLattice& lattice,
                               const IndexBox<3>& box);

}  // namespace fabseq
