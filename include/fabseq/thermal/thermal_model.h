// SPDX-License-Identifier: MIT
/// \file
/// Heat conduction in a part that grows: what all layers have in common, and what a layer is
/// (docs/formulation.md 14.1).
#pragma once

#include "fabseq/fem/element_matrices.h"
#include "fabseq/grid/unknown_numbering.h"
#include "fabseq/layers/layers.h"
#include "fabseq/part/part.h"
#include "fabseq/thermal/film_faces.h"
#include "fabseq/thermal/thermal_settings.h"

#include <span>
#include <vector>

namespace fabseq {

/// A step in time.
struct ThermalStep {
  double seconds;
  bool welding;  ///< whether the torch is on
};

/// What is conducted and stored while a layer is built. Nodal fields are on the owned nodes.
struct ThermalLayer {
  std::vector<double>
      standing;               ///< r of this rank's elements and of those beside them, FilmFaces::standing()
  std::vector<double> share;  ///< a of each element of the domain
  std::vector<double> capacity;  ///< C, J/K
  std::vector<double> film;      ///< H, W/K
  std::vector<double> heat;      ///< that its new material brings, J
  double mass = 0.0;             ///< of that, kg, all ranks
};

/// Temperatures are excesses theta = T - T_a at the nodes of part and substrate, K; nodal fields are on the
/// owned nodes, 0 elsewhere. Calls are collective on the grid's communicator unless they say otherwise.
template <int Dim>
struct ThermalModel {
  /// What conducts and stores heat where nothing stands yet, relative to the material.
  static constexpr double least_share = 1e-6;

  /// The part must outlive the model.
  ThermalModel(const Part<Dim>& part_, const ThermalProperties& properties_);

  const Part<Dim>& part;
  ThermalProperties properties;
  ElementMatrices<Dim> element;
  SystemDomain domain;             ///< elements of part and substrate; nodes on the plate's face are held
  std::vector<int> nodes;          ///< those of these elements: offsets in Grid::owned_nodes(), ascending
  std::vector<int> part_position;  ///< index in domain.first_corners of each part element
  FilmFaces<Dim> film;

  int owned_nodes() const { return static_cast<int>(domain.fixed.size()); }
  /// Mass of a layer, kg.
  double mass(const LayerDensities& densities, int layer) const;
  /// `region`: whether each element of part and substrate is in, on the owned elements, 0 or 1; what is not
  /// conducts, stores and brings nothing. Empty: all are.
  ThermalLayer layer(const LayerDensities& densities, int number, std::span<const double> region = {}) const;
  /// C before the first layer: of the substrate.
  std::vector<double> first_capacity() const;
  /// theta before the first layer: the plate's on substrate and held nodes.
  std::vector<double> start() const;
  /// The steps of a layer of this mass, with these pauses between its real layers and after the last. Local.
  std::vector<ThermalStep> steps(double mass, double inner_pause, double last_pause) const;
  /// Returns the steps with the pauses of the process. Local.
  std::vector<ThermalStep> steps(double mass) const {
    return steps(mass, properties.pause, properties.pause);
  }
  /// Shares the values of elements, times `factor`, out among their corners, and sums these up at the nodes.
  /// `corners`: the first corner of each element.
  std::vector<double> lumped(std::span<const int> corners, std::span<const double> of_elements,
                             double factor) const;
  /// Weights of part elements in the mean by which the layer after this one begins. Local.
  static std::vector<double> weights(const std::vector<double>& layer_density);
  /// Returns the mean with these weights, as an excess.
  double interpass(const std::vector<double>& layer_density, std::span<const double> theta) const;
  /// K times a field: what flows off each node, W, for potentials in K; `share`: ThermalLayer's.
  std::vector<double> conducted(std::span<const double> share, std::span<const double> potential) const;
  /// Sets held nodes to the plate's temperature. Local.
  void hold(std::span<double> theta) const;

 private:
  /// `elements`: of part and substrate, offsets in Grid::owned_elements().
  ThermalModel(const Part<Dim>& part_, const ThermalProperties& properties_,
               const std::vector<int>& elements);
  std::vector<double> capacity_of(std::span<const double> share) const;
  std::vector<double> film_of(std::span<const double> standing) const;
  std::vector<double> sum_of(std::span<const double> ghosted) const;

  std::vector<int> held_;  ///< nodes at the plate's temperature, of `nodes`
};

/// The values of a nodal field at these of its nodes, and back, 0 at others.
std::vector<double> picked(std::span<const double> field, std::span<const int> nodes);
std::vector<double> spread_out(std::span<const double> values, std::span<const int> nodes, std::size_t count);

}  // namespace fabseq
