// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/layers/layers.h"
#include "fabseq/process/process_settings.h"
#include "fabseq/process/strain_source.h"
#include "fabseq/process/turned_strain.h"

#include <optional>
#include <span>
#include <vector>

namespace fabseq {

/// Returns the largest magnitude of a material's inherent strain; where it turns, without strain_scale.
double largest_strain(const MaterialSettings& material);

/// The material's inherent strain (docs/formulation.md 4.2, 4.5): the same in all elements, or turned with
/// the layers, times the share that each layer gets of it (14.2). Layers turn it by the print direction of
/// their sub-part, or, where there are no sub-parts, elements by the gradient of the pseudo-time at their
/// centres.
///
/// Its inputs are the values before the shares, [part element][Voigt] or [layer][Voigt], if they turn, and
/// the shares, [layer], if there are any.
template <int Dim>
class InherentStrain : public StrainSource<Dim> {
 public:
  /// `characteristic_length`: l_c of the regularization eps^2 = 1e-9 / l_c^2 of gradients.
  InherentStrain(const MaterialSettings& material, double characteristic_length);

  /// Takes a design: gradients of the pseudo-time, [part element][axis], and shares of the layers; empty: 1.
  void set(std::span<const double> gradient, const LayerDensities& layers, std::span<const double> share);

  StrainVariation variation() const override;
  void set_strains(std::span<const int> elements, const StepBlock& steps,
                   std::span<double> strains) const override;
  std::size_t input_count() const override { return value_count() + share_.size(); }
  void add_derivatives(std::span<const int> elements, const StepBlock& steps,
                       std::span<const double> d_strains, std::span<double> d_inputs) const override;

  bool turns() const { return turned_.has_value(); }
  /// Maps derivatives with respect to the inputs, for strains that turn: to `d_gradient`, laid out as the
  /// gradients of set(), or, with sub-parts, to `d_densities`.
  void pull_back(std::span<const double> gradient, const LayerDensities& layers,
                 std::span<const double> d_inputs, std::vector<double>& d_gradient,
                 DensityDerivatives& d_densities) const;
  /// Picks the derivatives with respect to the inputs that are the shares.
  std::span<const double> of_shares(std::span<const double> d_inputs) const {
    return d_inputs.subspan(value_count());
  }

 private:
  /// What has a value of its own.
  enum class Values { one_for_all, of_elements, of_layers };

  std::size_t value_count() const { return kind_ == Values::one_for_all ? 0 : values_.size(); }
  /// Where the value of an element in a layer is.
  std::size_t place(int element, int layer) const {
    const int number = kind_ == Values::one_for_all ? 0 : kind_ == Values::of_elements ? element : layer;
    return static_cast<std::size_t>(number) * voigt_size<Dim>;
  }
  double share(int layer) const { return share_.empty() ? 1.0 : share_[layer]; }

  std::optional<TurnedStrain<Dim>> turned_;
  double regularization_;  ///< eps^2
  Values kind_ = Values::one_for_all;
  std::vector<double> values_;  ///< by `kind_`, [Voigt] innermost
  std::vector<double> share_;   ///< [layer]; empty: 1
};

}  // namespace fabseq
