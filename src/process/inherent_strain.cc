// SPDX-License-Identifier: MIT
#include "fabseq/process/inherent_strain.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace fabseq {

namespace {

/// The axes a <= b of each Voigt component: xx, yy, zz, xy, yz, zx; in 2D xx, yy, xy.
template <int Dim>
std::array<int, 2> axes(int component) {
  if (component < Dim) return {component, component};
  return {component - Dim, (component - Dim + 1) % Dim};
}

}  // namespace

double largest_strain(const MaterialSettings& material) {
  if (const auto& turning = material.turning_strain)
    return std::max(std::abs(turning->tangential), std::abs(turning->normal));
  double result = 0.0;
  for (const double strain : material.inherent_strain) result = std::max(result, std::abs(strain));
  return result;
}

template <int Dim>
InherentStrain<Dim>::InherentStrain(const MaterialSettings& material, double characteristic_length)
    : turns_(material.turning_strain.has_value()),
      regularization_(gradient_regularization(characteristic_length)) {
  if (!turns_) return;
  tangential_ = material.turning_strain->tangential;
  difference_ = material.turning_strain->normal - tangential_;
  scale_ = voigt_factors(material.strain_scale);
}

template <int Dim>
void InherentStrain<Dim>::set_strain(const double* g, double regularization, double* strain) const {
  double square = regularization;
  for (int axis = 0; axis < Dim; ++axis) square += g[axis] * g[axis];
  for (int c = 0; c < voigt_size<Dim>; ++c) {
    const auto [a, b] = axes<Dim>(c);
    const double direction = difference_ * g[a] * g[b] / square;
    strain[c] = scale_[c] * (a == b ? tangential_ + direction : 2.0 * direction);
  }
}

/// With s = |g|^2 + eps^2: d(g_a g_b / s) = (dg_a g_b + g_a dg_b) / s - 2 g_a g_b (g . dg) / s^2.
template <int Dim>
void InherentStrain<Dim>::add_derivative(const double* g, double regularization, const double* d_strain,
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

template <int Dim>
StrainField InherentStrain<Dim>::strains(std::span<const double> gradient,
                                         const LayerDensities& layers) const {
  const SubParts& sub_parts = layers.sub_parts;
  StrainField result;
  if (!turns_) return result;
  if (sub_parts.count() == 0) {
    result.of_elements.resize(gradient.size() / Dim * voigt_size<Dim>);
    for (std::size_t e = 0; e < gradient.size() / Dim; ++e)
      set_strain(&gradient[e * Dim], regularization_, &result.of_elements[e * voigt_size<Dim>]);
    return result;
  }
  result.of_layers.resize(sub_parts.of_layer.size() * voigt_size<Dim>);
  for (std::size_t j = 0; j < sub_parts.of_layer.size(); ++j)
    set_strain(&sub_parts.directions[static_cast<std::size_t>(sub_parts.of_layer[j]) * Dim], 0.0,
               &result.of_layers[j * voigt_size<Dim>]);
  return result;
}

template <int Dim>
void InherentStrain<Dim>::pull_back(std::span<const double> gradient, const LayerDensities& layers,
                                    const StrainField& d_strain, std::vector<double>& d_gradient,
                                    DensityDerivatives& d_densities) const {
  const SubParts& sub_parts = layers.sub_parts;
  if (sub_parts.count() == 0) {
    d_gradient.resize(gradient.size(), 0.0);
    for (std::size_t e = 0; e < gradient.size() / Dim; ++e)
      add_derivative(&gradient[e * Dim], regularization_, &d_strain.of_elements[e * voigt_size<Dim>],
                     &d_gradient[e * Dim]);
    return;
  }
  std::vector<double>& d_directions = d_densities.touch_directions(sub_parts);
  for (std::size_t j = 0; j < sub_parts.of_layer.size(); ++j) {
    const std::size_t first = static_cast<std::size_t>(sub_parts.of_layer[j]) * Dim;
    add_derivative(&sub_parts.directions[first], 0.0, &d_strain.of_layers[j * voigt_size<Dim>],
                   &d_directions[first]);
  }
}

template <int Dim>
void scale_layers(std::span<const double> factors, StrainField& strains) {
  if (strains.of_layers.empty()) strains.of_layers.assign(factors.size() * voigt_size<Dim>, 1.0);
  for (std::size_t i = 0; i < strains.of_layers.size(); ++i)
    strains.of_layers[i] *= factors[i / voigt_size<Dim>];
}

template <int Dim>
std::vector<double> pull_back_layer_scale(const StrainField& full, std::span<const double> factors,
                                          StrainField& d_strains) {
  std::vector<double> result(factors.size(), 0.0);
  for (std::size_t i = 0; i < d_strains.of_layers.size(); ++i) {
    const double before = full.of_layers.empty() ? 1.0 : full.of_layers[i];
    result[i / voigt_size<Dim>] += before * d_strains.of_layers[i];
    d_strains.of_layers[i] *= factors[i / voigt_size<Dim>];
  }
  return result;
}

FABSEQ_INSTANTIATE_CLASS(InherentStrain);
FABSEQ_INSTANTIATE_FUNCTION(scale_layers);
FABSEQ_INSTANTIATE_FUNCTION(pull_back_layer_scale);

}  // namespace fabseq
