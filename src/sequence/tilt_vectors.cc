// SPDX-License-Identifier: MIT
#include "sequence/tilt_vectors.h"

#include <cmath>

namespace fabseq {

namespace {

/// Functions of the angle |a| that are smooth at 0.
struct AngleFunctions {
  double cosine, sine_ratio;  ///< cos|a|, sin|a| / |a|
  double slope_ratio;         ///< d(sin|a| / |a|)/d|a|, over |a|

  template <std::size_t Size>
  explicit AngleFunctions(const std::array<double, Size>& tilt) {
    const double square = dot(tilt, tilt), angle = std::sqrt(square);
    cosine = std::cos(angle);
    // Below, the next terms of the series are rounding errors of the first one.
    const bool small = square < 1e-6;
    sine_ratio = small ? 1.0 - square / 6.0 + square * square / 120.0 : std::sin(angle) / angle;
    slope_ratio =
        small ? -1.0 / 3.0 + square / 30.0 - square * square / 840.0 : (cosine - sine_ratio) / square;
  }
};

template <int Dim>
std::array<double, Dim - 1> components_of(const double* tilt) {
  std::array<double, Dim - 1> result;
  std::copy_n(tilt, Dim - 1, result.begin());
  return result;
}

}  // namespace

template <int Dim>
TiltVectors<Dim>::TiltVectors(const BuildPlate& plate) : up_(plate.normal<Dim>()) {
  for (int axis = 0, next = 0; axis < Dim; ++axis)
    if (axis != plate.axis) axes_[next++] = axis;
}

template <int Dim>
Point<Dim> TiltVectors<Dim>::direction(const double* tilt) const {
  const AngleFunctions of(components_of<Dim>(tilt));
  Point<Dim> result = up_;
  for (double& component : result) component *= of.cosine;
  for (int i = 0; i < components; ++i) result[axes_[i]] = tilt[i] * of.sine_ratio;
  return result;
}

template <int Dim>
void TiltVectors<Dim>::add_derivative(const double* tilt, const Point<Dim>& d_direction,
                                      double* d_tilt) const {
  const AngleFunctions of(components_of<Dim>(tilt));
  double along_tilt = 0.0;
  for (int i = 0; i < components; ++i) along_tilt += d_direction[axes_[i]] * tilt[i];
  // d|a|/da_i = a_i / |a|
  const double by_angle = along_tilt * of.slope_ratio - dot(d_direction, up_) * of.sine_ratio;
  for (int i = 0; i < components; ++i)
    d_tilt[i] += d_direction[axes_[i]] * of.sine_ratio + by_angle * tilt[i];
}

template <int Dim>
std::array<double, TiltVectors<Dim>::components> TiltVectors<Dim>::tilt_of(
    const Point<Dim>& direction) const {
  std::array<double, components> result;
  for (int i = 0; i < components; ++i) result[i] = direction[axes_[i]];
  const double across = std::sqrt(dot(result, result));
  const double scale = across > 0.0 ? std::atan2(across, dot(direction, up_)) / across : 0.0;
  for (double& component : result) component *= scale;
  return result;
}

FABSEQ_INSTANTIATE_CLASS(TiltVectors);

}  // namespace fabseq
