// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/process/elastic_process.h"

#include <array>
#include <span>
#include <vector>

namespace fabseq {

/// sigma = sum_s [E_j C B du_s - (drho_j)^q E_0 C eps*_s] at the centres of the model's elements, [owned
/// element][Voigt], stress unit, 0 outside the model; from the last result of the process
/// (docs/formulation.md 4.3). Collective.
template <int Dim>
std::vector<double> residual_stress(const ElasticProcess<Dim>& process, const LayerDensities& densities);

/// E_N C B v, what a displacement v of the finished part ([owned node][component]) adds to it. Collective on
/// the grid's communicator.
template <int Dim>
std::vector<double> finished_stress(const ElasticModel<Dim>& model, std::span<const double> displacement);

/// Equivalent stress (von Mises; plane stress in 2D) at the centres of the part's elements, a part field;
/// stress unit. Local. \param stress  of all owned elements, [element][Voigt component]
template <int Dim>
std::vector<double> equivalent_stress(const Part<Dim>& part, std::span<const double> stress);

/// Extremes over the part's elements, all ranks.
template <int Dim>
struct StressExtremes {
  double von_mises = 0.0;  ///< largest equivalent stress
  std::array<double, voigt_size<Dim>> lowest{}, highest{};
};

/// Extremes of a stress laid out as residual_stress()'s. Collective on the grid's communicator.
template <int Dim>
StressExtremes<Dim> stress_extremes(const Part<Dim>& part, std::span<const double> stress);

/// Share of the part's volume in which the equivalent stress is above `limit`. Collective on the grid's
/// communicator.
template <int Dim>
double share_beyond(const Part<Dim>& part, std::span<const double> stress, double limit);

}  // namespace fabseq
