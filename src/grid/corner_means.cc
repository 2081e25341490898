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

FABSEQ_INSTANTIATE_FUNCTION(corner_means);

}  // namespace fabseq
