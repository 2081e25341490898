// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/fem/element_matrices.h"
#include "fabseq/process/process_settings.h"

#include <vector>

namespace fabseq {

/// The inherent strain of a direction g across the layers (docs/formulation.md 4.2):
///
///     eps* = tangential (I - n n^T) + normal n n^T,  n = g / sqrt(|g|^2 + eps^2),
///
/// scaled axis by axis, shear by the root of the product of its two. Voigt, engineering shear.
template <int Dim>
class TurnedStrain {
 public:
  /// `strain`, `scale`: MaterialSettings::turning_strain and strain_scale.
  TurnedStrain(const TurningStrain& strain, const std::vector<double>& scale);

  /// Sets the strain of g, with `regularization` eps^2.
  void set_strain(const double* g, double regularization, double* strain) const;
  /// Adds dJ/dg, given dJ/d(strain).
  void add_derivative(const double* g, double regularization, const double* d_strain, double* d_g) const;

 private:
  double tangential_, difference_;  ///< normal - tangential
  std::vector<double> scale_;       ///< of each Voigt component
};

}  // namespace fabseq
