// SPDX-License-Identifier: MIT
/// \file
/// Means over layers that uniformity and thickness share (docs/formulation.md 6).
#pragma once

#include "fabseq/responses/response.h"

#include <optional>
#include <vector>

namespace fabseq {

/// Statistics of every layer; the same on all ranks.
struct LayerStatistics {
  std::vector<double> weight;     ///< sum of layer densities, floor included
  std::vector<double> volume;     ///< volume, floor not included
  std::vector<double> mean;       ///< m_j: mean |grad t|, 1/length
  std::vector<double> deviation;  ///< sum of layer density * (M - m_j)^2
  std::vector<double> thickness;  ///< d_j = (T_j - T_{j-1}) / m_j, length unit

  /// sqrt(deviation / weight) / mean.
  double coefficient_of_variation(int layer) const;
};

/// M_e = sqrt(|grad t|^2 + epsilon^2) of each part element; empty where the gradient is not defined.
template <int Dim>
std::vector<double> gradient_magnitude(const PseudoTime<Dim>& time, double characteristic_length);

/// What a layer's thickness follows from; the same on all ranks.
struct LayerMean {
  double elements = 0.0;   ///< sum of layer densities, floor not included
  double weight = 0.0;     ///< like LayerStatistics, of one layer
  double mean = 0.0;       ///< 1/length
  double thickness = 0.0;  ///< length unit
};

/// Of one layer, where a whole LayerStatistics would be more than is asked for. `magnitude`: M_e, defined.
/// Collective on `comm`, the grid's.
LayerMean layer_mean(MPI_Comm comm, const LayerDensities& layers, int layer,
                     const std::vector<double>& magnitude);

/// Volume of every layer, floor not included; the same on all ranks. Collective on the grid's communicator.
template <int Dim>
std::vector<double> layer_volumes(const Grid<Dim>& grid, const LayerDensities& layers);

/// Collective. Where the gradient is not defined, mean, deviation and thickness are NaN.
template <int Dim>
LayerStatistics layer_statistics(const ResponseContext<Dim>& context, const PseudoTime<Dim>& time,
                                 const LayerDensities& layers);

/// Adds to the adjoint: `d_magnitude` (dJ/dM_e, a part field) as a derivative with respect to grad t. Local.
template <int Dim>
void add_magnitude_derivative(const PipelineState<Dim>& state, const std::vector<double>& magnitude,
                              const std::vector<double>& d_magnitude, PipelineAdjoint<Dim>& adjoint);

}  // namespace fabseq
