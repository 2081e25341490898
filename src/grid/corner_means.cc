// SPDX-License-Identifier: MIT
#include "fabseq/grid/corner_means.h"

namespace fabseq {

template <int Dim>
std::vector<double> corner_means(const Grid<Dim>& grid, std::span<const int> first_corners,
                                 std::span<const double> field) {
  const std::vector<double> ghosted = grid.exchange(1).ghosted(field);
  std::vector<double> result;
  for (const int first : first_corners) {
    double sum = 0.0;
    for (const int offset : grid.corner_offsets()) sum += ghosted[first + offset];
    result.push_back(sum / corner_count<Dim>);
  }
  return result;
}

template <int Dim>
std::vector<double> spread_to_corners(const Grid<Dim>& grid, std::span<const int> first_corners,
                                      std::span<const double> values, double factor) {
  std::vector<double> ghosted(static_cast<std::size_t>(grid.ghosted_nodes().count()), 0.0);
  const double of_corner = factor / corner_count<Dim>;
  for (std::size_t e = 0; e < values.size(); ++e)
    for (const int offset : grid.corner_offsets())
      ghosted[first_corners[e] + offset] += of_corner * values[e];
  std::vector<double> result(static_cast<std::size_t>(grid.owned_nodes().count()), 0.0);
  grid.exchange(1).add_to_owned(ghosted, result);
  return result;
}

FABSEQ_INSTANTIATE_FUNCTION(corner_means);
FABSEQ_INSTANTIATE_FUNCTION(spread_to_corners);

}  // namespace fabseq
