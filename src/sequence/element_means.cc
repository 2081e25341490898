// SPDX-License-Identifier: MIT
#include "fabseq/sequence/element_means.h"

#include <algorithm>

namespace fabseq {

template <int Dim>
ElementMeans element_means(const Part<Dim>& part, const ElementMatrices<Dim>& element,
                           std::span<const double> nodal) {
  const auto& offsets = part.grid().corner_offsets();
  const auto& corners = part.first_corners();
  ElementMeans result;
  result.mean.assign(corners.size(), 0.0);
  result.gradient.assign(corners.size() * Dim, 0.0);
  for (std::size_t e = 0; e < corners.size(); ++e)
    for (int corner = 0; corner < corner_count<Dim>; ++corner) {
      const double value = nodal[corners[e] + offsets[corner]];
      result.mean[e] += value / corner_count<Dim>;
      for (int axis = 0; axis < Dim; ++axis)
        result.gradient[e * Dim + axis] += element.center_gradient()[corner * Dim + axis] * value;
    }
  return result;
}

template <int Dim>
std::vector<std::vector<double>> element_gradients(const Part<Dim>& part, const ElementMatrices<Dim>& element,
                                                   const LaneVector& nodal) {
  const Grid<Dim>& grid = part.grid();
  const auto& corners = part.first_corners();
  const auto lanes = static_cast<std::size_t>(nodal.lanes);
  const std::vector<double> ghosted = grid.exchange(nodal.lanes).ghosted(nodal.values);
  std::vector<std::vector<double>> result(lanes, std::vector<double>(corners.size() * Dim));
  std::vector<double> sums(Dim * lanes);
  for (std::size_t e = 0; e < corners.size(); ++e) {
    std::ranges::fill(sums, 0.0);
    for (int corner = 0; corner < corner_count<Dim>; ++corner) {
      const double* const at_node = &ghosted[(corners[e] + grid.corner_offsets()[corner]) * lanes];
      for (int axis = 0; axis < Dim; ++axis) {
        const double weight = element.center_gradient()[corner * Dim + axis];
        for (std::size_t lane = 0; lane < lanes; ++lane) sums[axis * lanes + lane] += weight * at_node[lane];
      }
    }
    for (std::size_t lane = 0; lane < lanes; ++lane)
      for (int axis = 0; axis < Dim; ++axis) result[lane][e * Dim + axis] = sums[axis * lanes + lane];
  }
  return result;
}

template <int Dim>
LaneVector pull_back_means(const Part<Dim>& part, const ElementMatrices<Dim>& element,
                           std::span<const TimeDerivatives> rows) {
  const Grid<Dim>& grid = part.grid();
  const auto& corners = part.first_corners();
  const std::size_t lanes = rows.size();
  const bool have_gradients =
      std::ranges::any_of(rows, [](const TimeDerivatives& row) { return !row.gradient.empty(); });
  std::vector<double> ghosted(static_cast<std::size_t>(grid.ghosted_nodes().count()) * lanes, 0.0);
  std::vector<double> means(lanes);
  for (std::size_t e = 0; e < corners.size(); ++e) {
    for (std::size_t lane = 0; lane < lanes; ++lane) means[lane] = rows[lane].time[e] / corner_count<Dim>;
    for (int corner = 0; corner < corner_count<Dim>; ++corner) {
      double* const at_node = &ghosted[(corners[e] + grid.corner_offsets()[corner]) * lanes];
      for (std::size_t lane = 0; lane < lanes; ++lane) at_node[lane] += means[lane];
      for (std::size_t lane = 0; have_gradients && lane < lanes; ++lane)
        for (int axis = 0; !rows[lane].gradient.empty() && axis < Dim; ++axis)
          at_node[lane] +=
              rows[lane].gradient[e * Dim + axis] * element.center_gradient()[corner * Dim + axis];
    }
  }
  LaneVector result(static_cast<int>(grid.owned_nodes().count()), 1, static_cast<int>(lanes));
  grid.exchange(static_cast<int>(lanes)).add_to_owned(ghosted, result.values);
  return result;
}

FABSEQ_INSTANTIATE_FUNCTION(element_means);
FABSEQ_INSTANTIATE_FUNCTION(element_gradients);
FABSEQ_INSTANTIATE_FUNCTION(pull_back_means);

}  // namespace fabseq
