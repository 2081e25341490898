// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/fem/element_matrices.h"
#include "fabseq/grid/unknown_numbering.h"
#include "fabseq/part/part.h"
#include "fabseq/part/supports.h"
#include "fabseq/process/process_settings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

namespace fabseq {

/// What the elastic solves of a part have in common (docs/formulation.md 4.1, 4.4). The elements of the model
/// are those of part and substrate, or all of the box where the void is quiet. Works with unit Young's
/// modulus: displacements do not depend on it.
template <int Dim>
struct ElasticModel {
  using ElementLoad = std::array<double, element_unknowns<Dim>>;

  /// Part and supports must outlive the model. Collective on the grid's communicator.
  ElasticModel(const Part<Dim>& part_, const Supports<Dim>& supports_, const MaterialSettings& material_,
               const ProcessSettings& settings_);

  const Part<Dim>& part;
  const Supports<Dim>& supports;
  MaterialSettings material;
  ProcessSettings settings;
  ElementMatrices<Dim> element;
  std::array<ElementLoad, voigt_size<Dim>> unit_loads;  ///< of each strain component alone in a full element
  SystemDomain domain;                                  ///< elements of the model; supports fixed
  std::vector<int> nodes;     ///< those of the model's elements: offsets in Grid::owned_nodes(), ascending
  std::vector<int> elements;  ///< of the model, in the order of the domain: offsets in Grid::owned_elements()
  std::vector<int> part_position;  ///< index in domain.first_corners of each part element
  std::vector<int> part_element;   ///< the other way round; negative for elements of substrate and void

  /// Stage density of an element of the model, given those of the part: the substrate stands, the void does
  /// not.
  double stage_density(const std::vector<double>& part_stage, std::size_t model_element) const {
    const int number = part_element[model_element];
    return number >= 0 ? part_stage[number] : (number == in_substrate ? 1.0 : 0.0);
  }
  /// Values of a field ([owned node][component]) at the model's nodes.
  std::vector<double> at_nodes(std::span<const double> field) const;
  /// The other way round, with 0 at other nodes.
  std::vector<double> on_all_nodes(std::span<const double> values) const;
  /// Stiffness factor of every element of the model once the part is finished.
  std::vector<double> finished_stiffness() const;

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
  /// Strain that an element of this density takes, free, in the layer that builds it, over the inherent one:
  /// a grey element deposits less than a full one, and is softer.
  double strain_factor(double density) const { return load(density) / stiffness(density); }

 private:
  static constexpr int in_void = -1, in_substrate = -2;

  /// max(base, 0)^exponent. The usual exponents are worth a branch: this is called for each element and
  /// layer.
  static double power(double base, double exponent) {
    const double positive = std::max(base, 0.0);
    if (exponent == 3.0) return positive * positive * positive;
    if (exponent == 2.0) return positive * positive;
    return std::pow(positive, exponent);
  }
};

/// This rank's nodes, ascending offsets in Grid::owned_nodes(), that elements of any rank touch. `elements`:
/// offsets in Grid::owned_elements(). Collective on the grid's communicator.
template <int Dim>
std::vector<int> touched_nodes(const Grid<Dim>& grid, const std::vector<int>& elements);

}  // namespace fabseq
