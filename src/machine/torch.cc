// SPDX-License-Identifier: MIT
#include "fabseq/machine/torch.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

namespace fabseq {

namespace {

constexpr double nowhere = -std::numeric_limits<double>::infinity();

double radius_between(const std::array<double, 2>& a, const std::array<double, 2>& b, double height) {
  return a[1] + (b[1] - a[1]) * (height - a[0]) / (b[0] - a[0]);
}

template <int Dim>
double length(const double* vector) {
  return std::sqrt(std::inner_product(vector, vector + Dim, vector, 0.0));
}

/// Unit vectors perpendicular to each other and to an axis of the grid.
template <int Dim>
std::array<Point<Dim>, 2> perpendiculars(const Point<Dim>& up) {
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

Torch::Torch(const ToolSettings& settings) : profile_(settings.profile) {
  for (auto& [height, radius] : profile_) radius += settings.clearance;
  rounding_ = 1e-12 * reach();
}

double Torch::radius(double height) const { return largest_radius(height, height); }

double Torch::largest_radius(double low, double high) const {
  const double lowest = profile_.front()[0], highest = profile_.back()[0];
  if (high < lowest - rounding_ || low > highest + rounding_) return nowhere;
  const double from = std::clamp(low, lowest, highest), to = std::clamp(high, lowest, highest);
  double result = nowhere;
  for (std::size_t i = 0; i < profile_.size(); ++i) {
    const auto& point = profile_[i];
    // At a step of the profile both of its radii are there.
    if (point[0] >= from - rounding_ && point[0] <= to + rounding_) result = std::max(result, point[1]);
    if (i == 0 || point[0] <= profile_[i - 1][0]) continue;
    for (const double end : {from, to})
      if (end >= profile_[i - 1][0] && end <= point[0])
        result = std::max(result, radius_between(profile_[i - 1], point, end));
  }
  return result;
}

double Torch::reach() const {
  double result = 0.0;
  for (const auto& [height, radius] : profile_) result = std::max(result, std::hypot(height, radius));
  return result;
}

template <int Dim>
Index<Dim> torch_halo(const Grid<Dim>& grid, const Torch& torch) {
  Index<Dim> width;
  for (int axis = 0; axis < Dim; ++axis)
    width[axis] = static_cast<int>(std::min(std::ceil(torch.reach() / grid.spacing()[axis]),
                                            static_cast<double>(grid.domain().elements[axis])));
  return width;
}

template <int Dim>
Point<Dim> fixed_torch_axis(const ToolSettings& settings) {
  const double size = length<Dim>(settings.axis.data());
  Point<Dim> result;
  for (int axis = 0; axis < Dim; ++axis) result[axis] = settings.axis[axis] / size;
  return result;
}

template <int Dim>
std::vector<double> torch_axis(const Part<Dim>& part, const ToolSettings& settings,
                               std::span<const double> direction) {
  std::vector<double> result(direction.begin(), direction.end());
  if (!settings.axis.empty()) {
    const Point<Dim> fixed = fixed_torch_axis<Dim>(settings);
    result.clear();
    for (std::size_t e = 0; e < part.elements().size(); ++e)
      result.insert(result.end(), fixed.begin(), fixed.end());
  }
  const Point<Dim> normal = part.plate().template normal<Dim>();
  for (std::size_t e = 0; e * Dim < result.size(); ++e)
    if (length<Dim>(&result[e * Dim]) == 0.0) std::copy(normal.begin(), normal.end(), &result[e * Dim]);
  return result;
}

template <int Dim>
std::vector<double> torch_tilt(const Part<Dim>& part, std::span<const double> axis) {
  constexpr double degrees = 180.0 / std::numbers::pi;
  const Point<Dim> normal = part.plate().template normal<Dim>();
  std::vector<double> result;
  for (std::size_t e = 0; e * Dim < axis.size(); ++e) {
    const double along = std::inner_product(normal.begin(), normal.end(), &axis[e * Dim], 0.0);
    double across = 0.0;  // of the rest of the axis, for angles whose cosine is near 1
    for (int i = 0; i < Dim; ++i) across += std::pow(axis[e * Dim + i] - along * normal[i], 2);
    result.push_back(degrees * std::atan2(std::sqrt(across), along));
  }
  return result;
}

template <int Dim>
std::vector<Point<Dim>> torch_samples(const ToolSettings& settings, const Point<Dim>& up, double highest,
                                      int count) {
  constexpr double plastic = 1.32471795724474602596;
  const Torch torch(settings);
  const double lowest = settings.profile.front()[0];
  const double extent = std::max(0.0, std::min(highest, settings.profile.back()[0]) - lowest);
  const auto directions = perpendiculars<Dim>(up);
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

FABSEQ_INSTANTIATE_FUNCTION(torch_halo);
FABSEQ_INSTANTIATE_FUNCTION(fixed_torch_axis);
FABSEQ_INSTANTIATE_FUNCTION(torch_axis);
FABSEQ_INSTANTIATE_FUNCTION(torch_tilt);
FABSEQ_INSTANTIATE_FUNCTION(torch_samples);

}  // namespace fabseq
