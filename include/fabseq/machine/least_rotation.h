// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/grid/index_box.h"

namespace fabseq {

/// The rotation by the least angle that takes the unit vector `up` to another one, as it acts on a point:
/// R p = p - b (b . p) / (1 + up . a) + 2 a (up . p), b = up + a. Where a = -up it is not defined; a small
/// number keeps the denominator away from 0.
template <int Dim>
class LeastRotation {
 public:
  /// \param axis  a, of length 1 or, where its gradient vanishes, less
  LeastRotation(const Point<Dim>& up, const Point<Dim>& axis);

  Point<Dim> apply(const Point<Dim>& point) const;
  /// Adds d(d_image . R p) / da to d_axis.
  void add_derivative(const Point<Dim>& point, const Point<Dim>& d_image, Point<Dim>& d_axis) const;

 private:
  Point<Dim> up_, axis_, both_;
  double denominator_;
};

}  // namespace fabseq
