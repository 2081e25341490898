// SPDX-License-Identifier: MIT
#include "fabseq/machine/hanging.h"

#include "fabseq/grid/element_halo.h"

#include <algorithm>
#include <cmath>

namespace fabseq {

namespace {

/// What is relative to an element's edges and no larger than this is rounding.
constexpr double rounding = 1e-6;

/// The cylinder below an element in which something must lie: along the axis from half an element's extent to
/// a whole one, across it within `radius`.
template <int Dim>
struct Footing {
  Point<Dim> spacing;
  double radius;

  bool holds(const Index<Dim>& step, const double* direction) const {
    double along = 0.0, square = 0.0, extent = 0.0;
    for (int axis = 0; axis < Dim; ++axis) {
      const double offset = step[axis] * spacing[axis];
      along -= offset * direction[axis];
      square += offset * offset;
      extent += std::abs(direction[axis]) * spacing[axis];
    }
    return along > (0.5 - rounding) * extent && along < (1.0 + rounding) * extent &&
           square - along * along < radius * radius * (1.0 + rounding);
  }
};

template <int Dim>
Footing<Dim> footing_of(const Grid<Dim>& grid, double bead_width) {
  double square = 0.0;
  for (const double edge : grid.spacing()) square += edge * edge;
  const double width = bead_width > 0.0 ? bead_width : 2.0 * grid.largest_spacing();
  // Half a diagonal: however the axis is turned, the centre of an element lies near enough to it.
  return {grid.spacing(), std::max(0.5 * width, 0.5 * std::sqrt(square))};
}

/// How many elements a footing may reach along each axis.
template <int Dim>
Index<Dim> reach_of(const Footing<Dim>& footing) {
  Index<Dim> result;
  double reach = footing.radius;
  for (const double edge : footing.spacing) reach += edge;
  for (int axis = 0; axis < Dim; ++axis)
    result[axis] = static_cast<int>(std::ceil(reach / footing.spacing[axis]));
  return result;
}

/// Steps from an element to all that may be in its footing, the nearest first.
template <int Dim>
std::vector<Index<Dim>> steps_within(const Footing<Dim>& footing, const Index<Dim>& reach) {
  const IndexBox<Dim> box = ringed<Dim>({{}, uniform_index<Dim>(1)}, reach);
  std::vector<Index<Dim>> result;
  box.for_each([&](const Index<Dim>& step, std::int64_t) { result.push_back(step); });
  const auto square = [&](const Index<Dim>& step) {
    double sum = 0.0;
    for (int axis = 0; axis < Dim; ++axis) sum += std::pow(step[axis] * footing.spacing[axis], 2);
    return sum;
  };
  std::stable_sort(result.begin(), result.end(),
                   [&](const Index<Dim>& a, const Index<Dim>& b) { return square(a) < square(b); });
  return result;
}

}  // namespace

template <int Dim>
std::vector<double> hanging_elements(const Part<Dim>& part, std::span<const double> direction,
                                     std::span<const double> layer_index, double bead_width) {
  const Grid<Dim>& grid = part.grid();
  const Footing<Dim> footing = footing_of(grid, bead_width);
  const Index<Dim> reach = reach_of(footing);
  const std::vector<Index<Dim>> steps = steps_within<Dim>(footing, reach);
  const ElementHalo<Dim> halo(grid, reach);
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
    const double* axis_of_bead = direction.empty() ? normal.data() : &direction[e * Dim];
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
