// SPDX-License-Identifier: MIT
#include "fabseq/process/turned_strain.h"

#include "fabseq/grid/index_box.h"

#include <array>

namespace fabseq {

namespace {

/// The axes a <= b of each Voigt component: xx, yy, zz, xy, yz, zx; in 2D xx, yy, xy.
template <int Dim>
std::array<int, 2> axes(int component) {
  if (component < Dim) return {component, component};
  return {component - Dim, (component - Dim + 1) % Dim};
}

}  // namespace

template <int Dim>
TurnedStrain<Dim>::TurnedStrain(const TurningStrain& strain, const std::vector<double>& scale)
    : tangential_(strain.tangential),
      difference_(strain.normal - strain.tangential),
      scale_(voigt_factors(scale)) {}

template <int Dim>
void TurnedStrain<Dim>::set_strain(const double* g, double regularization, double* strain) const {
  double square = regularization;
  for (int axis = 0; axis < Dim; ++axis) square += g[axis] * g[axis];
  for (int c = 0; c < voigt_size<Dim>; ++c) {
    const auto [a, b] = axes<Dim>(c);
    const double direction = difference_ * g[a] * g[b] / square;
    strain[c] = scale_[c] * (a == b ? tangential_ + direction : 2.0 * direction);
  }
}

/// Uses s = |g|^2 + eps^2: d(g_a g_b / s) = (dg_a g_b + g_a dg_b) / s - 2 g_a g_b (g . dg) / s^2.
template <int Dim>
void TurnedStrain<Dim>::add_derivative(const double* g, double regularization, const double* d_strain,
                                       double* d_g) const {
  double square = regularization;
  for (int axis = 0; axis < Dim; ++axis) square += g[axis] * g[axis];
  double shrinking = 0.0;  // what the norm in the denominator adds
  for (int c = 0; c < voigt_size<Dim>; ++c) {
    const auto [a, b] = axes<Dim>(c);
    const double weight = (a == b ? 1.0 : 2.0) * difference_ * scale_[c] * d_strain[c] / square;
    d_g[a] += weight * g[b];
    d_g[b] += weight * g[a];
    shrinking += 2.0 * weight * g[a] * g[b] / square;
  }
  for (int axis = 0; axis < Dim; ++axis) d_g[axis] -= shrinking * g[axis];
}

FABSEQ_INSTANTIATE_CLASS(TurnedStrain);

}  // namespace fabseq
