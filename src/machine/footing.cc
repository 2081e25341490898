// SPDX-License-Identifier: MIT
#include "fabseq/machine/footing.h"

#include <algorithm>
#include <cmath>

namespace fabseq {

namespace {

/// What is relative to an element's edges and no larger than this is rounding.
constexpr double rounding = 1e-6;

}  // namespace

template <int Dim>
Footing<Dim>::Footing(const Grid<Dim>& grid, double bead_width)
    : spacing(grid.spacing()), elements(grid.domain().elements) {
  const double width = width_of_bead(grid, bead_width);
  // Half a diagonal: however the axis is turned, the centre of an element lies near enough to it.
  radius = std::max(0.5 * width, 0.5 * std::sqrt(dot(spacing, spacing)));
}

template <int Dim>
bool Footing<Dim>::holds(const Index<Dim>& step, const double* direction) const {
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

template <int Dim>
std::vector<Index<Dim>> Footing<Dim>::steps() const {
  // The extent along a unit vector is no longer than an element's diagonal.
  const double farthest = (dot(spacing, spacing) + radius * radius) * (1.0 + 4.0 * rounding);
  const auto square = [this](const Index<Dim>& step) {
    double sum = 0.0;
    for (int axis = 0; axis < Dim; ++axis) sum += std::pow(step[axis] * spacing[axis], 2);
    return sum;
  };
  Index<Dim> reach;
  for (int axis = 0; axis < Dim; ++axis)  // as a number: it may be more than an int can hold
    reach[axis] = static_cast<int>(std::min<double>(elements[axis], std::sqrt(farthest) / spacing[axis]));
  std::vector<Index<Dim>> result;
  ringed<Dim>({{}, uniform_index<Dim>(1)}, reach).for_each([&](const Index<Dim>& step, std::int64_t) {
    if (step != Index<Dim>{} && square(step) <= farthest) result.push_back(step);
  });
  std::stable_sort(result.begin(), result.end(),
                   [&](const Index<Dim>& a, const Index<Dim>& b) { return square(a) < square(b); });
  return result;
}

template <int Dim>
Index<Dim> reach_of(const std::vector<Index<Dim>>& steps) {
  Index<Dim> result{};
  for (const Index<Dim>& step : steps)
    for (int axis = 0; axis < Dim; ++axis) result[axis] = std::max(result[axis], std::abs(step[axis]));
  return result;
}

FABSEQ_INSTANTIATE_STRUCT(Footing);
FABSEQ_INSTANTIATE_FUNCTION(reach_of);

}  // namespace fabseq
