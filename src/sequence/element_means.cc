// SPDX-License-Identifier: MIT
#include "fabseq/sequence/element_means.h"

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
LaneVector pull_back_means(const Part<Dim>& part, const ElementMatrices<Dim>& element,
                           std::span<const TimeDerivatives> rows) {
  const Grid<Dim>& grid = part.grid();
  const auto& corners = part.first_corners();
  const int lanes = static_cast<int>(rows.size());
  std::vector<double> ghosted(static_cast<std::size_t>(grid.ghosted_nodes().count()) * lanes, 0.0);
  for (int lane = 0; lane < lanes; ++lane) {
    const TimeDerivatives& row = rows[lane];
    for (std::size_t e = 0; e < corners.size(); ++e)
      for (int corner = 0; corner < corner_count<Dim>; ++corner) {
        double value = row.time[e] / corner_count<Dim>;
        for (int axis = 0; !row.gradient.empty() && axis < Dim; ++axis)
          value += row.gradient[e * Dim + axis] * element.center_gradient()[corner * Dim + axis];
        const std::size_t node = corners[e] + grid.corner_offsets()[corner];
        ghosted[node * lanes + lane] += value;
      }
  }
  LaneVector result(static_cast<int>(grid.owned_nodes().count()), 1, lanes);
  grid.exchange(lanes).add_to_owned(ghosted, result.values);
  return result;
}

FABSEQ_INSTANTIATE_FUNCTION(element_means);
FABSEQ_INSTANTIATE_FUNCTION(pull_back_means);

}  // namespace fabseq
