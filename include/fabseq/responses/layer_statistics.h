// SPDX-License-Identifier: MIT
/// \file
/// Means over layers that layer uniformity and layer thickness share (docs/formulation.md 6). M_e is the
/// regularized |grad t| of an element, drho_e its layer density, and "floor" is layer_density_floor, which is
/// added to the layer densities used as weights.
#pragma once

#include "fabseq/responses/response.h"

#include <optional>
#include <vector>

namespace fabseq {

/// Statistics of a layer; the same on all ranks.
struct LayerStatistics {
  double weight = 0.0;     ///< W_j: sum over the elements of drho_e + floor
  double volume = 0.0;     ///< volume without the floor, length^3
  double mean = 0.0;       ///< m_j: weighted mean of M_e, 1/length
  double thickness = 0.0;  ///< d_j = (T_j - T_{j-1}) / m_j, length unit
  double deviation = 0.0;  ///< D_j: sum of (drho_e + floor) (M_e - m_j)^2

  /// sqrt(D_j / W_j) / m_j.
  double coefficient_of_variation() const;
};

/// M_e = sqrt(|grad t|^2 + epsilon^2) of each part element, 1/length; empty if the gradient is not defined.
/// Local.
template <int Dim>
std::vector<double> gradient_magnitude(const PseudoTime<Dim>& time, double characteristic_length);

/// Volume of every layer without the floor, the same on all ranks. Collective on the grid's communicator.
template <int Dim>
std::vector<double> layer_volumes(const Grid<Dim>& grid, const LayerDensities& layers);

/// Statistics of all layers. Mean, deviation and thickness are NaN if the gradient is not defined or if the
/// layers have no time points. Collective on the grid's communicator.
template <int Dim>
std::vector<LayerStatistics> layer_statistics(const ResponseContext<Dim>& context,
                                              const PseudoTime<Dim>& time, const LayerDensities& layers);

/// The same for one layer, which costs less, but for the deviation. `magnitude`: M_e, which must be defined.
/// Collective on the grid's communicator.
template <int Dim>
LayerStatistics layer_mean(const Grid<Dim>& grid, const LayerDensities& layers, int layer,
                           const std::vector<double>& magnitude);

/// Adds the derivative with respect to grad t that follows from `d_magnitude`, dJ/dM_e (a part field), to
/// `adjoint`. `magnitude`: M_e. Local.
template <int Dim>
void add_magnitude_derivative(const StageResults<Dim>& state, const std::vector<double>& magnitude,
                              const std::vector<double>& d_magnitude, StageDerivatives<Dim>& adjoint);

}  // namespace fabseq
