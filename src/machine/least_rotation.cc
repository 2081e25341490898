// SPDX-License-Identifier: MIT
#include "fabseq/machine/least_rotation.h"

namespace fabseq {

/// Added to 1 + up . a.
constexpr double least_denominator = 1e-6;

template <int Dim>
LeastRotation<Dim>::LeastRotation(const Point<Dim>& up, const Point<Dim>& axis)
    : up_(up), axis_(axis), denominator_(1.0 + dot(up, axis) + least_denominator) {
  for (int i = 0; i < Dim; ++i) both_[i] = up[i] + axis[i];
}

template <int Dim>
Point<Dim> LeastRotation<Dim>::apply(const Point<Dim>& point) const {
  const double along_both = dot(both_, point) / denominator_, along_up = dot(up_, point);
  Point<Dim> result;
  for (int i = 0; i < Dim; ++i) result[i] = point[i] - along_both * both_[i] + 2.0 * along_up * axis_[i];
  return result;
}

template <int Dim>
void LeastRotation<Dim>::add_derivative(const Point<Dim>& point, const Point<Dim>& d_image,
                                        Point<Dim>& d_axis) const {
  const double along_point = dot(both_, point) / denominator_,
               along_image = dot(both_, d_image) / denominator_, along_up = dot(up_, point);
  for (int i = 0; i < Dim; ++i)
    d_axis[i] += 2.0 * along_up * d_image[i] - along_point * d_image[i] - along_image * point[i] +
                 along_point * along_image * up_[i];
}

FABSEQ_INSTANTIATE_CLASS(LeastRotation);

}  // namespace fabseq
