// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cmath>

namespace fabseq {

/// Angles that a direction has.
template <int Dim>
constexpr int angle_count = Dim - 1;

/// Print direction (docs/formulation.md 3.2): unit vector (cos a, sin a) in 2D, (cos a cos b, cos a sin b,
/// sin a) of elevation a and azimuth b in 3D. `angles`: [angle].
template <int Dim>
std::array<double, Dim> print_direction(const double* angles) {
  const double c = std::cos(angles[0]), s = std::sin(angles[0]);
  if constexpr (Dim == 2)
    return {c, s};
  else
    return {c * std::cos(angles[1]), c * std::sin(angles[1]), s};
}

/// Maps a derivative with respect to the direction, [axis], to the angles, and adds it to `d_angles`,
/// [angle].
template <int Dim>
void add_angle_derivatives(const double* angles, const double* d_direction, double* d_angles) {
  const double c = std::cos(angles[0]), s = std::sin(angles[0]);
  if constexpr (Dim == 2) {
    d_angles[0] += -s * d_direction[0] + c * d_direction[1];
  } else {
    const double cos_b = std::cos(angles[1]), sin_b = std::sin(angles[1]);
    d_angles[0] += -s * (cos_b * d_direction[0] + sin_b * d_direction[1]) + c * d_direction[2];
    d_angles[1] += c * (-sin_b * d_direction[0] + cos_b * d_direction[1]);
  }
}

}  // namespace fabseq
