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

FABSEQ_INSTANTIATE_FUNCTION(torch_halo);
FABSEQ_INSTANTIATE_FUNCTION(fixed_torch_axis);
FABSEQ_INSTANTIATE_FUNCTION(torch_axis);
FABSEQ_INSTANTIATE_FUNCTION(torch_tilt);

}  // namespace fabseq
