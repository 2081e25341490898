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

/// Statistics of every layer, one entry per layer; the same on all ranks.
struct LayerStatistics {
  std::vector<double> weight;     ///< W_j: sum over the elements of drho_e + floor
  std::vector<double> volume;     ///< volume without the floor, length^3
  std::vector<double> mean;       ///< m_j: weighted mean of M_e, 1/length
  std::vector<double> deviation;  ///< D_j: sum of (drho_e + floor) (M_e - m_j)^2
  std::vector<double> thickness;  ///< d_j = (T_j - T_{j-1}) / m_j, length unit

  /// sqrt(D_j / W_j) / m_j.
  double coefficient_of_variation(int layer) const;
};

/// M_e = sqrt(|grad t|^2 + epsilon^2) of each part element, 1/length; empty if the gradient is not defined.
/// Local.
template <int Dim>
std::vector<double> gradient_magnitude(const PseudoTime<Dim>& time, double characteristic_length);

/// The quantities of one layer from which its thickness follows; the same on all ranks.
struct LayerMean {
  double elements = 0.0;   ///< sum of layer densities without the floor: volume in elements
  double weight = 0.0;     ///< W_j of LayerStatistics
  double mean = 0.0;       ///< m_j of LayerStatistics, 1/length
  double thickness = 0.0;  ///< d_j of LayerStatistics, length unit
};

/// Computes these for one layer, which costs less than a whole LayerStatistics. `magnitude`: M_e, which must
/// be defined. Collective on `comm`, the grid's communicator.
LayerMean layer_mean(MPI_Comm comm, const LayerDensities& layers, int layer,
                     const std::vector<double>& magnitude);

/// Volume of every layer without the floor, the same on all ranks. Collective on the grid's communicator.
template <int Dim>
std::vector<double> layer_volumes(const Grid<Dim>& grid, const LayerDensities& layers);

/// Statistics of all layers. Mean, deviation and thickness are NaN if the gradient is not defined or if the
/// layers have no time points. Collective on the grid's communicator.
template <int Dim>
LayerStatistics layer_statistics(const ResponseContext<Dim>& context, const PseudoTime<Dim>& time,
                                 const LayerDensities& layers);

/// Adds the derivative with respect to grad t that follows from `d_magnitude`, dJ/dM_e (a part field), to
/// `adjoint`. `magnitude`: M_e. Local.
template <int Dim>
void add_magnitude_derivative(const PipelineState<Dim>& state, const std::vector<double>& magnitude,
                              const std::vector<double>& d_magnitude, PipelineAdjoint<Dim>& adjoint);

}  // namespace fabseq
