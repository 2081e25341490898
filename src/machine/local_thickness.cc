// SPDX-License-Identifier: MIT
#include "fabseq/machine/local_thickness.h"

#include "fabseq/base/mpi.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fabseq {

template <int Dim>
std::vector<double> local_thickness(const PseudoTime<Dim>& time, const LayerDensities& layers,
                                    std::span<const double> layer_index) {
  std::vector<double> result;
  if (time.gradient.empty() || layers.time_points.empty()) return result;
  for (std::size_t e = 0; e < layer_index.size(); ++e) {
    const auto layer = static_cast<std::size_t>(layer_index[e]);
    double square = 0.0;
    for (int axis = 0; axis < Dim; ++axis)
      square += time.gradient[e * Dim + axis] * time.gradient[e * Dim + axis];
    result.push_back((layers.time_points[layer] - layers.time_points[layer - 1]) / std::sqrt(square));
  }
  return result;
}

template <int Dim>
std::optional<ThicknessRange> thickness_range(const Part<Dim>& part, std::span<const double> thickness,
                                              const std::optional<std::array<double, 2>>& allowed) {
  const MPI_Comm comm = part.grid().comm();
  // A rank without part elements has no values whether they are defined or not.
  if (!any(comm, !thickness.empty())) return std::nullopt;
  constexpr double infinite = std::numeric_limits<double>::infinity();
  double least = infinite, largest = 0.0, volume = 0.0, outside = 0.0;
  for (std::size_t e = 0; e < thickness.size(); ++e) {
    const double density = part.part_density()[e];
    least = std::min(least, thickness[e]);
    largest = std::max(largest, thickness[e]);
    volume += density;
    if (allowed && (thickness[e] < (*allowed)[0] || thickness[e] > (*allowed)[1])) outside += density;
  }
  ThicknessRange result{min(comm, least), max(comm, largest), std::nullopt};
  if (allowed) result.share_outside = sum(comm, outside) / sum(comm, volume);
  return result;
}

FABSEQ_INSTANTIATE_FUNCTION(local_thickness);
FABSEQ_INSTANTIATE_FUNCTION(thickness_range);

}  // namespace fabseq
