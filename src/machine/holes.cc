// SPDX-License-Identifier: MIT
#include "fabseq/machine/holes.h"

#include "fabseq/base/mpi.h"
#include "fabseq/grid/components.h"
#include "fabseq/grid/element_halo.h"
#include "fabseq/machine/footing.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace fabseq {

namespace {

constexpr double finest_step = 2.5;  // degrees, between directions that are tried
constexpr double rounding = 1e-6;

/// Unit vectors that lean from the plate's normal by no more than `most` degrees.
template <int Dim>
std::vector<Point<Dim>> cone(const BuildPlate& plate, double most) {
  std::vector<Point<Dim>> result;
  const int steps = static_cast<int>(std::ceil(most / finest_step));
  for (int i = 0; i <= steps; ++i) {
    const double tilt = most * i / std::max(steps, 1) * std::numbers::pi / 180.0;
    const int around = i == 0 ? 1 : Dim == 2 ? 2 : 72;
    for (int k = 0; k < around; ++k) {
      const double angle = 2.0 * std::numbers::pi * k / around;
      Point<Dim> direction{};
      int next = 0;
      for (int axis = 0; axis < Dim; ++axis)
        direction[axis] = axis == plate.axis
                              ? (plate.upper ? -1.0 : 1.0) * std::cos(tilt)
                              : std::sin(tilt) * (next++ == 0 ? std::cos(angle) : std::sin(angle));
      result.push_back(direction);
    }
  }
  return result;
}

/// Spreads from plate and substrate to all that can rest, directly or not, on what they carry.
template <int Dim>
class Carried {
 public:
  Carried(const Part<Dim>& part, const ToolSettings& tool)
      : part_(part), footing_(part.grid(), tool.bead_width) {
    const std::vector<Point<Dim>> directions = cone<Dim>(part.plate(), tool.max_tilt);
    for (const Index<Dim>& step : footing_.steps())
      if (std::any_of(directions.begin(), directions.end(),
                      [&](const Point<Dim>& direction) { return footing_.holds(step, direction.data()); }))
        steps_.push_back(step);
  }

  /// 1 on part elements that are carried, 0 on others; a part field.
  std::vector<double> find() const {
    const ElementHalo<Dim> halo(part_.grid(), reach_of<Dim>(steps_));
    std::vector<double> carried(part_.elements().size(), 0.0);
    bool changed = true;
    while (any(part_.grid().comm(), changed)) {
      std::vector<double> around = halo.gather(part_.expand(carried, 0.0, 1.0));
      changed = false;
      for (bool spreads = true; spreads; changed = changed || spreads)
        spreads = spread(halo, around, carried);
    }
    return carried;
  }

 private:
  bool spread(const ElementHalo<Dim>& halo, std::vector<double>& around, std::vector<double>& carried) const {
    bool spreads = false;
    for (std::size_t e = 0; e < carried.size(); ++e) {
      const Index<Dim> element = part_.grid().owned_elements().index(part_.elements()[e]);
      if (carried[e] > 0.0 || !rests(halo, around, element)) continue;
      carried[e] = around[halo.box().offset(element)] = 1.0;
      spreads = true;
    }
    return spreads;
  }
  bool rests(const ElementHalo<Dim>& halo, const std::vector<double>& around,
             const Index<Dim>& element) const {
    const int axis = part_.plate().axis, end = part_.grid().domain().elements[axis];
    const bool upper = part_.plate().upper;
    return std::any_of(steps_.begin(), steps_.end(), [&](const Index<Dim>& step) {
      Index<Dim> below = element;
      for (int i = 0; i < Dim; ++i) below[i] += step[i];
      if (upper ? below[axis] >= end : below[axis] < 0) return true;
      return halo.box().contains(below) && around[halo.box().offset(below)] > 0.0;
    });
  }

  const Part<Dim>& part_;
  Footing<Dim> footing_;
  std::vector<Index<Dim>> steps_;  ///< to what an element can rest on, whatever direction it has
};

/// Empty elements that part or substrate close on both sides along an axis of the plate and above.
template <int Dim>
class ClosedVoids {
 public:
  /// Collective.
  explicit ClosedVoids(const Part<Dim>& part)
      : part_(part), all_(part.grid().all_elements()), solid_(static_cast<std::size_t>(all_.count()), 0) {
    const std::vector<double> owned = part.solid();
    std::vector<std::int64_t> own;
    part.grid().owned_elements().for_each([&](const Index<Dim>& element, std::int64_t offset) {
      if (owned[offset] > 0.0) own.push_back(all_.offset(element));
    });
    for (const std::int64_t number : gather_all(part.grid().comm(), own)) solid_[number] = 1;
  }

  /// 1 on closed voids, on all owned elements.
  std::vector<double> find() const {
    const BuildPlate& plate = part_.plate();
    std::vector<double> result(part_.density().size(), 0.0);
    part_.grid().owned_elements().for_each([&](const Index<Dim>& element, std::int64_t offset) {
      if (is_solid(element) || !is_before(element, plate.axis, plate.upper ? -1 : 1)) return;
      for (int axis = 0; axis < Dim; ++axis)
        if (axis != plate.axis && is_before(element, axis, -1) && is_before(element, axis, 1))
          result[offset] = 1.0;
    });
    return result;
  }

 private:
  bool is_solid(const Index<Dim>& element) const { return solid_[all_.offset(element)] != 0; }
  /// Whether something solid comes in that direction.
  bool is_before(Index<Dim> element, int axis, int step) const {
    for (element[axis] += step; all_.contains(element); element[axis] += step)
      if (is_solid(element)) return true;
    return false;
  }

  const Part<Dim>& part_;
  IndexBox<Dim> all_;
  std::vector<char> solid_;  ///< on the whole grid
};

/// Boxes of the components of elements, and how many elements they have. Lengths are in length units.
template <int Dim>
struct Boxes {
  std::vector<Point<Dim>> lower, upper;
  std::vector<std::int64_t> elements;

  /// Collective.
  Boxes(const Grid<Dim>& grid, const Components& components)
      : lower(static_cast<std::size_t>(components.count)), upper(lower), elements(lower.size(), 0) {
    std::vector<double> ends(2 * Dim * lower.size(), -std::numeric_limits<double>::infinity());
    grid.owned_elements().for_each([&](const Index<Dim>& element, std::int64_t offset) {
      const int component = components.of_element[offset];
      if (component < 0) return;
      ++elements[component];
      const Point<Dim> low = grid.node_position(element),
                       high = grid.node_position(stepped<Dim>(element, all, 1));
      for (int axis = 0; axis < Dim; ++axis) {
        double* end = &ends[2 * (Dim * component + axis)];
        end[0] = std::max(end[0], -low[axis]);
        end[1] = std::max(end[1], high[axis]);
      }
    });
    max_in_place(grid.comm(), ends);
    sum_in_place(grid.comm(), std::span<std::int64_t>(elements));
    for (std::size_t c = 0; c < lower.size(); ++c)
      for (int axis = 0; axis < Dim; ++axis) {
        lower[c][axis] = -ends[2 * (Dim * c + axis)];
        upper[c][axis] = ends[2 * (Dim * c + axis) + 1];
      }
  }

 private:
  static constexpr int all = corner_count<Dim> - 1;  ///< the corner that is one element on along all axes
};

/// Adds what the places close: of each, the closed voids below its elements. Collective.
template <int Dim>
void add_holes(const Part<Dim>& part, const Components& places, std::vector<UncarriedPlace<Dim>>& result) {
  const Grid<Dim>& grid = part.grid();
  const Components voids = find_components<Dim>(grid, ClosedVoids<Dim>(part).find(), Contact::face);
  const Boxes<Dim> boxes(grid, voids);
  const ElementHalo<Dim> halo(grid, 1);
  const std::vector<double> around =
      halo.gather(std::vector<double>(voids.of_element.begin(), voids.of_element.end()));
  std::vector<double> below(result.size() * boxes.lower.size(), 0.0);
  grid.owned_elements().for_each([&](Index<Dim> element, std::int64_t offset) {
    const int place = places.of_element[offset];
    element[part.plate().axis] += part.plate().upper ? 1 : -1;
    if (place < 0 || !halo.box().contains(element)) return;
    const int number = static_cast<int>(around[halo.box().offset(element)]);
    if (number >= 0) below[place * boxes.lower.size() + number] = 1.0;
  });
  max_in_place(grid.comm(), below);
  for (std::size_t place = 0; place < result.size(); ++place)
    for (std::size_t number = 0; number < boxes.lower.size(); ++number) {
      if (below[place * boxes.lower.size() + number] == 0.0) continue;
      UncarriedPlace<Dim>& roof = result[place];
      for (int axis = 0; axis < Dim; ++axis) {
        const double low = boxes.lower[number][axis], high = boxes.upper[number][axis];
        roof.hole_lower[axis] = roof.is_roof ? std::min(roof.hole_lower[axis], low) : low;
        roof.hole_upper[axis] = roof.is_roof ? std::max(roof.hole_upper[axis], high) : high;
      }
      roof.is_roof = true;
    }
}

}  // namespace

template <int Dim>
double bridged_span(const Part<Dim>& part, const ToolSettings& tool) {
  return tool.bridge.value_or(2.0 * width_of_bead(part.grid(), tool.bead_width));
}

template <int Dim>
std::vector<UncarriedPlace<Dim>> find_uncarried(const Part<Dim>& part, const ToolSettings& tool) {
  std::vector<UncarriedPlace<Dim>> result;
  if (!tool.axis.empty()) return result;
  std::vector<double> uncarried = Carried<Dim>(part, tool).find();
  for (double& value : uncarried) value = 1.0 - value;
  const Components places = find_components<Dim>(part.grid(), part.expand(uncarried), Contact::corner);
  if (places.count == 0) return result;
  const Boxes<Dim> boxes(part.grid(), places);
  for (std::size_t c = 0; c < boxes.lower.size(); ++c) {
    double span = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < Dim; ++axis)
      if (axis != part.plate().axis) span = std::min(span, boxes.upper[c][axis] - boxes.lower[c][axis]);
    result.push_back({boxes.lower[c], boxes.upper[c], span, boxes.elements[c]});
  }
  add_holes(part, places, result);
  const double bridged = bridged_span(part, tool) * (1.0 + rounding);
  std::erase_if(result, [&](const UncarriedPlace<Dim>& place) { return place.span <= bridged; });
  std::stable_sort(result.begin(), result.end(),
                   [](const auto& a, const auto& b) { return a.elements > b.elements; });
  return result;
}

FABSEQ_INSTANTIATE_FUNCTION(bridged_span);
FABSEQ_INSTANTIATE_FUNCTION(find_uncarried);

}  // namespace fabseq
