// SPDX-License-Identifier: MIT
#include "fabseq/machine/hanging.h"

#include "fabseq/base/mpi.h"
#include "fabseq/grid/element_halo.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fabseq {

namespace {

/// What is relative to an element's edges and no larger than this is rounding.
constexpr double rounding = 1e-6;
constexpr double never = std::numeric_limits<double>::infinity();

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
      : part_(part), halo_(part.grid(), width), layer_(gathered(layer_index)) {}

  double layer(const Index<Dim>& element) const {
    const BuildPlate& plate = part_.plate();
    const int height = element[plate.axis];
    if (plate.upper ? height >= part_.grid().domain().elements[plate.axis] : height < 0) return 0.0;
    return halo_.box().contains(element) ? layer_[halo_.box().offset(element)] : never;
  }

 private:
  std::vector<double> gathered(std::span<const double> layer_index) const {
    std::vector<double> layer = part_.expand(layer_index, never);
    const auto& substrate = part_.substrate().elements();
    for (std::size_t element = 0; element < substrate.size(); ++element)
      if (substrate[element] != 0) layer[element] = 0.0;
    return halo_.gather(layer);
  }

  const Part<Dim>& part_;
  ElementHalo<Dim> halo_;
  std::vector<double> layer_;
};

template <int Dim>
Point<Dim> plate_normal(const BuildPlate& plate) {
  Point<Dim> result{};
  result[plate.axis] = plate.upper ? -1.0 : 1.0;
  return result;
}

}  // namespace

template <int Dim>
std::vector<double> hanging_elements(const Part<Dim>& part, std::span<const double> direction,
                                     std::span<const double> layer_index, double bead_width) {
  const Grid<Dim>& grid = part.grid();
  const Footing<Dim> footing = footing_of(grid, bead_width);
  const std::vector<Index<Dim>> steps = steps_within(footing);
  const BuiltIn<Dim> built_in(part, layer_index, halo_width<Dim>(steps));
  const Point<Dim> normal = plate_normal<Dim>(part.plate());
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

template <int Dim>
HangingCount<Dim> count_hanging(const Part<Dim>& part, std::span<const double> hanging,
                                std::span<const double> layer_index, int layers) {
  const Grid<Dim>& grid = part.grid();
  HangingCount<Dim> result;
  result.per_layer.assign(static_cast<std::size_t>(layers), 0);
  for (std::size_t e = 0; e < hanging.size(); ++e)
    if (hanging[e] != 0.0) ++result.per_layer[static_cast<std::size_t>(layer_index[e]) - 1];
  sum_in_place(grid.comm(), result.per_layer);
  const auto first = std::find_if(result.per_layer.begin(), result.per_layer.end(),
                                  [](std::int64_t count) { return count > 0; });
  if (first == result.per_layer.end()) return result;
  for (const std::int64_t count : result.per_layer) result.elements += count;

  // Of the earliest layer that has any, the one that comes first in the grid, whatever its rank.
  const double layer = static_cast<double>(first - result.per_layer.begin()) + 1.0;
  const IndexBox<Dim> whole{{}, grid.domain().elements};
  std::int64_t place = whole.count();
  for (std::size_t e = 0; e < hanging.size(); ++e)
    if (hanging[e] != 0.0 && layer_index[e] == layer)
      place = std::min(place, whole.offset(grid.owned_elements().index(part.elements()[e])));
  result.at = grid.element_center(whole.index(min(grid.comm(), place)));
  return result;
}

FABSEQ_INSTANTIATE_FUNCTION(hanging_elements);
FABSEQ_INSTANTIATE_FUNCTION(count_hanging);

}  // namespace fabseq
