// SPDX-License-Identifier: MIT
#include "fabseq/process/standing_elements.h"

#include "fabseq/grid/element_halo.h"
#include "fabseq/kernels/lane_vector.h"

#include <algorithm>

namespace fabseq {

namespace {

/// Each value becomes the largest of its own and those of the next entries along an axis.
template <int Dim>
void spread_along(int axis, const IndexBox<Dim>& box, std::vector<double>& field) {
  std::int64_t stride = 1;
  for (int other = 0; other < axis; ++other) stride *= box.size[other];
  const std::vector<double> from = field;
  box.for_each([&](const Index<Dim>& element, std::int64_t offset) {
    const int place = element[axis] - box.start[axis];
    if (place > 0) field[offset] = std::max(field[offset], from[offset - stride]);
    if (place + 1 < box.size[axis]) field[offset] = std::max(field[offset], from[offset + stride]);
  });
}

}  // namespace

template <int Dim>
std::vector<double> StandingElements<Dim>::of(const LayerDensities& densities, int layer) const {
  const std::vector<char>& substrate = part_.substrate().elements();
  std::vector<double> result(substrate.begin(), substrate.end());
  const int first = layer - layer % widest_block, end = std::min(first + widest_block, densities.count());
  for (int number = first; number < end; ++number) {
    const std::vector<double>& stage = densities.stage[number];
    for (std::size_t e = 0; e < stage.size(); ++e)
      if (stage[e] > least_) result[part_.elements()[e]] = 1.0;
  }
  return result;
}

template <int Dim>
std::vector<double> StandingElements<Dim>::with_neighbors(const LayerDensities& densities, int layer) const {
  const Grid<Dim>& grid = part_.grid();
  const ElementHalo<Dim> halo(grid, 1);
  std::vector<double> around = halo.gather(of(densities, layer));
  for (int axis = 0; axis < Dim; ++axis) spread_along(axis, halo.box(), around);
  std::vector<double> result = part_.solid();
  for (std::size_t e = 0; e < result.size(); ++e)
    result[e] = result[e] > 0.0 ? around[halo.box().offset(grid.owned_elements().index(e))] : 0.0;
  return result;
}

FABSEQ_INSTANTIATE_CLASS(StandingElements);

}  // namespace fabseq
