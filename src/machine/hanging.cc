// SPDX-License-Identifier: MIT
#include "fabseq/machine/hanging.h"

#include "fabseq/grid/element_halo.h"
#include "fabseq/machine/footing.h"

#include <algorithm>
#include <cmath>

namespace fabseq {

namespace {

template <int Dim>
bool vanishes(const double* vector) {
  return std::all_of(vector, vector + Dim, [](double component) { return component == 0.0; });
}

}  // namespace

template <int Dim>
std::vector<double> hanging_elements(const Part<Dim>& part, std::span<const double> direction,
                                     std::span<const double> layer_index, double bead_width) {
  const Grid<Dim>& grid = part.grid();
  const Footing<Dim> footing(grid, bead_width);
  const std::vector<Index<Dim>> steps = footing.steps();
  const ElementHalo<Dim> halo(grid, reach_of<Dim>(steps));
  const std::vector<double> layers = halo.gather(part.expand(layer_index, INFINITY, 0.0));
  // The layer that builds an element: 0 for the substrate and for the other side of the plate.
  const auto layer_of = [&](const Index<Dim>& element) {
    const auto [axis, upper] = part.plate();
    if (upper ? element[axis] >= grid.domain().elements[axis] : element[axis] < 0) return 0.0;
    return halo.box().contains(element) ? layers[halo.box().offset(element)] : INFINITY;
  };
  const Point<Dim> normal = part.plate().template normal<Dim>();
  std::vector<double> result(layer_index.size());
  for (std::size_t e = 0; e < layer_index.size(); ++e) {
    const Index<Dim> element = grid.owned_elements().index(part.elements()[e]);
    const double* axis_of_bead =
        direction.empty() || vanishes<Dim>(&direction[e * Dim]) ? normal.data() : &direction[e * Dim];
    const bool stands = std::any_of(steps.begin(), steps.end(), [&](const Index<Dim>& step) {
      if (!footing.holds(step, axis_of_bead)) return false;
      Index<Dim> below = element;
      for (int axis = 0; axis < Dim; ++axis) below[axis] += step[axis];
      return layer_of(below) <= layer_index[e];
    });
    result[e] = stands ? 0.0 : 1.0;
  }
  return result;
}

FABSEQ_INSTANTIATE_FUNCTION(hanging_elements);

}  // namespace fabseq
