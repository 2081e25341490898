/// \file
/// What the elastic solves of a part have in common: elements, supports, element matrices
/// (docs/formulation.md 4.1).
#pragma once

#include "fabseq/fem/element_matrices.h"
#include "fabseq/grid/part.h"
#include "fabseq/io/config.h"
#include "fabseq/solve/unknown_numbering.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace fabseq {

/// The elements of the mechanical model: the part's, or all of the box where the void is quiet; supported on
/// the plate's face. Works with unit Young's modulus: displacements do not depend on it.
template <int Dim>
struct ElasticModel {
  /// The part must outlive the model.
  ElasticModel(const Part<Dim>& part_, const MaterialSettings& material_, const ProcessSettings& settings_);

  const Part<Dim>& part;
  MaterialSettings material;
  ProcessSettings settings;
  ElementMatrices<Dim> element;
  std::array<double, element_unknowns<Dim>>
      strain_load;                 ///< load of the inherent strain in a full element, unit modulus
  SystemDomain domain;             ///< elements of the model; plate nodes fixed
  std::vector<int> part_position;  ///< index in domain.first_corners of each part element

  /// Stiffness factor of an element with this stage density.
  double stiffness(double stage_density) const {
    return settings.min_stiffness +
           (1.0 - settings.min_stiffness) * power(stage_density, settings.stiffness_penalty);
  }
  double stiffness_derivative(double stage_density) const {
    return (1.0 - settings.min_stiffness) * settings.stiffness_penalty *
           power(stage_density, settings.stiffness_penalty - 1.0);
  }
  /// Load factor of an element with this layer density.
  double load(double layer_density) const { return power(layer_density, settings.strain_penalty); }
  double load_derivative(double layer_density) const {
    return settings.strain_penalty * power(layer_density, settings.strain_penalty - 1.0);
  }

 private:
  /// max(base, 0)^exponent. The usual exponents are worth a branch: this is called for each element and layer.
  static double power(double base, double exponent) {
    const double positive = std::max(base, 0.0);
    if (exponent == 3.0) return positive * positive * positive;
    if (exponent == 2.0) return positive * positive;
    return std::pow(positive, exponent);
  }
};

extern template struct ElasticModel<2>;
extern template struct ElasticModel<3>;

}  // namespace fabseq
