// SPDX-License-Identifier: MIT
#include "fabseq/machine/torch_samples.h"

#include "fabseq/machine/torch.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace fabseq {

namespace {

/// Unit vectors perpendicular to each other and to an axis of the grid.
template <int Dim>
std::array<Point<Dim>, 2> across(const Point<Dim>& up) {
  std::array<Point<Dim>, 2> result{};
  int found = 0;
  for (int axis = 0; axis < Dim; ++axis)
    if (up[axis] == 0.0) result[found++][axis] = 1.0;
  return result;
}

/// Fractional parts of the multiples of the golden section, and of the plastic number, cover an interval, and
/// together a square, evenly.
double fraction(double value) { return value - std::floor(value); }

}  // namespace

template <int Dim>
std::vector<Point<Dim>> torch_samples(const ToolSettings& settings, const Point<Dim>& up, double highest,
                                      int count) {
  constexpr double plastic = 1.32471795724474602596;
  const Torch torch(settings);
  const double lowest = settings.profile.front()[0];
  const double extent = std::max(0.0, std::min(highest, settings.profile.back()[0]) - lowest);
  const auto directions = across<Dim>(up);
  std::vector<Point<Dim>> result;
  for (int m = 0; m < count; ++m) {
    const double share = (m + 0.5) / count;
    const double height = lowest + share * share * extent, radius = torch.radius(height);
    std::array<double, 2> offset;
    if constexpr (Dim == 2) {
      offset = {radius * (2.0 * fraction((m + 0.5) / std::numbers::phi) - 1.0), 0.0};
    } else {
      const double angle = 2.0 * std::numbers::pi * fraction((m + 0.5) / plastic);
      const double distance = radius * std::sqrt(fraction((m + 0.5) / (plastic * plastic)));
      offset = {distance * std::cos(angle), distance * std::sin(angle)};
    }
    Point<Dim> point;
    for (int axis = 0; axis < Dim; ++axis)
      point[axis] = height * up[axis] + offset[0] * directions[0][axis] + offset[1] * directions[1][axis];
    result.push_back(point);
  }
  return result;
}

FABSEQ_INSTANTIATE_FUNCTION(torch_samples);

}  // namespace fabseq
