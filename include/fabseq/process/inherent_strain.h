// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/fem/element_matrices.h"
#include "fabseq/layers/layers.h"
#include "fabseq/process/elastic_model.h"
#include "fabseq/process/process_settings.h"
#include "fabseq/sequence/sequence.h"

#include <span>
#include <vector>

namespace fabseq {

/// Returns the largest magnitude of a material's inherent strain; where it turns, without strain_scale.
double largest_strain(const MaterialSettings& material);

/// The inherent strain of each part element (docs/formulation.md 4.2, 4.5): either the same in all, or one
/// that turns with the layers:
///
///     eps* = tangential (I - n n^T) + normal n n^T,
///
/// scaled axis by axis, shear by the root of the product of its two. n is the print direction of the layer's
/// sub-part, or, where there are no sub-parts, g / sqrt(|g|^2 + eps^2) of the gradient g of the pseudo-time
/// at the element's centre. Strains are Voigt, engineering shear. Local to the rank.
template <int Dim>
class InherentStrain {
 public:
  /// `characteristic_length`: l_c of the regularization eps^2 = 1e-9 / l_c^2.
  InherentStrain(const MaterialSettings& material, double characteristic_length);

  bool turns() const { return turns_; }
  /// Strains of the layers or of the elements, by the gradients of the pseudo-time, [part element][axis];
  /// empty if they are all the same, the material's.
  StrainField strains(std::span<const double> gradient, const LayerDensities& layers) const;
  /// Adds what derivatives by these strains amount to: to `d_gradient`, [part element][axis], or, with
  /// sub-parts, to `d_densities`. For strains that turn.
  void pull_back(std::span<const double> gradient, const LayerDensities& layers, const StrainField& d_strain,
                 std::vector<double>& d_gradient, DensityDerivatives& d_densities) const;

 private:
  /// The strain of a single direction g, with regularization eps^2.
  void set_strain(const double* g, double regularization, double* strain) const;
  void add_derivative(const double* g, double regularization, const double* d_strain, double* d_g) const;

  bool turns_;
  double tangential_ = 0.0, difference_ = 0.0;  ///< normal - tangential
  double regularization_;                       ///< eps^2
  std::vector<double> scale_;                   ///< of each Voigt component
};

/// Multiplies the strains of each layer by its factor (docs/formulation.md 14.2). Local.
template <int Dim>
void scale_layers(std::span<const double> factors, StrainField& strains);
/// The derivative by these factors, this rank's part, for `d_strains` by the product. Takes `d_strains` on to
/// the derivatives by the strains before, `full`. Local.
template <int Dim>
std::vector<double> pull_back_layer_scale(const StrainField& full, std::span<const double> factors,
                                          StrainField& d_strains);

}  // namespace fabseq
