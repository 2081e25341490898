// SPDX-License-Identifier: MIT
#include "fabseq/process/inherent_strain.h"

#include "fabseq/grid/index_box.h"
#include "fabseq/sequence/sequence.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace fabseq {

double largest_strain(const MaterialSettings& material) {
  if (const auto& turning = material.turning_strain)
    return std::max(std::abs(turning->tangential), std::abs(turning->normal));
  double result = 0.0;
  for (const double strain : material.inherent_strain) result = std::max(result, std::abs(strain));
  return result;
}

template <int Dim>
InherentStrain<Dim>::InherentStrain(const MaterialSettings& material, double characteristic_length)
    : regularization_(gradient_regularization(characteristic_length)), values_(material.inherent_strain) {
  if (material.turning_strain) turned_.emplace(*material.turning_strain, material.strain_scale);
}

template <int Dim>
void InherentStrain<Dim>::set(std::span<const double> gradient, const LayerDensities& layers,
                              std::span<const double> share) {
  share_.assign(share.begin(), share.end());
  if (!turned_) return;
  const SubParts& sub_parts = layers.sub_parts;
  if (sub_parts.count() == 0) {
    kind_ = Values::of_elements;
    values_.resize(gradient.size() / Dim * voigt_size<Dim>);
    for (std::size_t e = 0; e < gradient.size() / Dim; ++e)
      turned_->set_strain(&gradient[e * Dim], regularization_, &values_[e * voigt_size<Dim>]);
    return;
  }
  kind_ = Values::of_layers;
  values_.resize(sub_parts.of_layer.size() * voigt_size<Dim>);
  for (std::size_t j = 0; j < sub_parts.of_layer.size(); ++j)
    turned_->set_strain(&sub_parts.directions[static_cast<std::size_t>(sub_parts.of_layer[j]) * Dim], 0.0,
                        &values_[j * voigt_size<Dim>]);
}

template <int Dim>
StrainVariation InherentStrain<Dim>::variation() const {
  if (kind_ == Values::of_elements) return StrainVariation::by_element;
  return kind_ == Values::one_for_all && share_.empty() ? StrainVariation::none : StrainVariation::by_step;
}

template <int Dim>
void InherentStrain<Dim>::set_strains(std::span<const int> elements, const StepBlock& steps,
                                      std::span<double> strains) const {
  double* to = strains.data();
  for (const int element : elements)
    for (int c = 0; c < voigt_size<Dim>; ++c, to += steps.lanes) {
      if (share_.empty() && kind_ != Values::of_layers) {
        std::fill_n(to, steps.lanes, values_[place(element, 0) + c]);
        continue;
      }
      for (int lane = 0; lane < steps.lanes; ++lane)
        to[lane] = values_[place(element, steps.first + lane) + c] * share(steps.first + lane);
    }
}

template <int Dim>
void InherentStrain<Dim>::add_derivatives(std::span<const int> elements, const StepBlock& steps,
                                          std::span<const double> d_strains,
                                          std::span<double> d_inputs) const {
  const double* from = d_strains.data();
  // Most strains that turn have no shares.
  if (kind_ == Values::of_elements && share_.empty()) {
    for (const int element : elements)
      for (int c = 0; c < voigt_size<Dim>; ++c, from += steps.lanes) {
        double& to = d_inputs[place(element, 0) + c];
        to = std::accumulate(from, from + steps.lanes, to);
      }
    return;
  }
  double* d_values = kind_ == Values::one_for_all ? nullptr : d_inputs.data();
  double* d_share = share_.empty() ? nullptr : d_inputs.data() + value_count();
  for (const int element : elements)
    for (int c = 0; c < voigt_size<Dim>; ++c, from += steps.lanes)
      for (int lane = 0; lane < steps.lanes; ++lane) {
        const int layer = steps.first + lane;
        const std::size_t at = place(element, layer) + c;
        if (d_values != nullptr) d_values[at] += from[lane] * share(layer);
        if (d_share != nullptr) d_share[layer] += from[lane] * values_[at];
      }
}

template <int Dim>
void InherentStrain<Dim>::pull_back(std::span<const double> gradient, const LayerDensities& layers,
                                    std::span<const double> d_inputs, std::vector<double>& d_gradient,
                                    DensityDerivatives& d_densities) const {
  const SubParts& sub_parts = layers.sub_parts;
  if (sub_parts.count() == 0) {
    d_gradient.resize(gradient.size(), 0.0);
    for (std::size_t e = 0; e < gradient.size() / Dim; ++e)
      turned_->add_derivative(&gradient[e * Dim], regularization_, &d_inputs[e * voigt_size<Dim>],
                              &d_gradient[e * Dim]);
    return;
  }
  std::vector<double>& d_directions = d_densities.directions_or_zeros(sub_parts);
  for (std::size_t j = 0; j < sub_parts.of_layer.size(); ++j) {
    const std::size_t first = static_cast<std::size_t>(sub_parts.of_layer[j]) * Dim;
    turned_->add_derivative(&sub_parts.directions[first], 0.0, &d_inputs[j * voigt_size<Dim>],
                            &d_directions[first]);
  }
}

FABSEQ_INSTANTIATE_CLASS(InherentStrain);

}  // namespace fabseq
