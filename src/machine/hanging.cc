// SPDX-License-Identifier: MIT
#include "fabseq/machine/hanging.h"

#include "fabseq/grid/element_halo.h"
#include "fabseq/machine/built_layers.h"

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

/// Steps from an element to all that may be in its footing, the nearest first.
template <int Dim>
std::vector<Index<Dim>> steps_within(const Footing<Dim>& footing) {
  IndexBox<Dim> box;
  double reach = footing.radius;
  for (const double edge : footing.spacing) reach += edge;
  for (int axis = 0; axis < Dim; ++axis) {
    const int most = static_cast<int>(std::ceil(reach / footing.spacing[axis]));
    box.start[axis] = -most;
    box.size[axis] = 2 * most + 1;
  }
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

/// Width of the halo that all steps stay in.
template <int Dim>
Index<Dim> halo_width(const std::vector<Index<Dim>>& steps) {
  Index<Dim> width{};
  for (const Index<Dim>& step : steps)
    for (int axis = 0; axis < Dim; ++axis) width[axis] = std::max(width[axis], std::abs(step[axis]));
  return width;
}

/// The layer that builds each element of a box: 0 for the substrate and for the other side of the plate.
template <int Dim>
class BuiltIn {
 public:
  BuiltIn(const Part<Dim>& part, std::span<const double> layer_index, const Index<Dim>& width)
      : part_(part), halo_(part.grid(), width), layer_(halo_.gather(built_layers(part, layer_index))) {}

  double layer(const Index<Dim>& element) const {
    const BuildPlate& plate = part_.plate();
    const int height = element[plate.axis];
    if (plate.upper ? height >= part_.grid().domain().elements[plate.axis] : height < 0) return 0.0;
    return halo_.box().contains(element) ? layer_[halo_.box().offset(element)] : never_built;
  }

 private:
  const Part<Dim>& part_;
  ElementHalo<Dim> halo_;
  std::vector<double> layer_;
};

}  // namespace

template <int Dim>
std::vector<double> hanging_elements(const Part<Dim>& part, std::span<const double> direction,
                                     std::span<const double> layer_index, double bead_width) {
  const Grid<Dim>& grid = part.grid();
  const Footing<Dim> footing = footing_of(grid, bead_width);
  const std::vector<Index<Dim>> steps = steps_within(footing);
  const BuiltIn<Dim> built_in(part, layer_index, halo_width<Dim>(steps));
  const Point<Dim> normal = part.plate().template normal<Dim>();
  std::vector<double> result(layer_index.size());
  for (std::size_t e = 0; e < layer_index.size(); ++e) {
    const Index<Dim> element = grid.owned_elements().index(part.elements()[e]);
    const double* axis_of_bead = direction.empty() ? normal.data() : &direction[e * Dim];
    const bool stands = std::any_of(steps.begin(), steps.end(), [&](const Index<Dim>& step) {
      if (!footing.holds(step, axis_of_bead)) return false;
      Index<Dim> below = element;
      for (int axis = 0; axis < Dim; ++axis) below[axis] += step[axis];
      return built_in.layer(below) <= layer_index[e];
    });
    result[e] = stands ? 0.0 : 1.0;
  }
  return result;
}

FABSEQ_INSTANTIATE_FUNCTION(hanging_elements);

}  // namespace fabseq
