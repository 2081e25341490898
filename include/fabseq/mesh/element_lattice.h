// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/grid/index_box.h"

namespace fabseq {

/// Samples of an element along each axis: it is divided into as many cells, which are asked at their centres.
constexpr int samples_per_axis = 4;
constexpr int samples_per_element = samples_per_axis * samples_per_axis * samples_per_axis;
/// All samples are shifted by this, in elements. With round numbers, faces of a part often run through the
/// centres of cells. Shifted samples lie on one side, and of two opposite faces one gets them. Different
/// along the axes for the sake of slanted faces.
constexpr Point<3> sample_shift = {1.0e-4, 1.6e-4, 2.7e-4};

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
  /// Where a point lies, in samples: those of element i have the numbers from samples_per_axis * i on.
  Point<3> in_samples(const Point<3>& point) const {
    Point<3> result = in_elements(point);
    for (int axis = 0; axis < 3; ++axis)
      result[axis] = samples_per_axis * (result[axis] - sample_shift[axis]) - 0.5;
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

}  // namespace fabseq
