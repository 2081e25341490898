// SPDX-License-Identifier: MIT
#include "fabseq/machine/torch_samples.h"

#include "fabseq/machine/torch.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace fabseq {

namespace {

/// Added to 1 + up . a.
constexpr double least_denominator = 1e-6;

template <int Dim>
double dot(const Point<Dim>& a, const Point<Dim>& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

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

template <int Dim>
LeastRotation<Dim>::LeastRotation(const Point<Dim>& up, const Point<Dim>& axis)
    : up_(up), axis_(axis), denominator_(1.0 + dot<Dim>(up, axis) + least_denominator) {
  for (int i = 0; i < Dim; ++i) both_[i] = up[i] + axis[i];
}

template <int Dim>
Point<Dim> LeastRotation<Dim>::apply(const Point<Dim>& point) const {
  const double along_both = dot<Dim>(both_, point) / denominator_, along_up = dot<Dim>(up_, point);
  Point<Dim> result;
  for (int i = 0; i < Dim; ++i) result[i] = point[i] - along_both * both_[i] + 2.0 * along_up * axis_[i];
  return result;
}

template <int Dim>
void LeastRotation<Dim>::add_derivative(const Point<Dim>& point, const Point<Dim>& d_image,
                                        Point<Dim>& d_axis) const {
  const double along_point = dot<Dim>(both_, point) / denominator_,
               along_image = dot<Dim>(both_, d_image) / denominator_, along_up = dot<Dim>(up_, point);
  for (int i = 0; i < Dim; ++i)
    d_axis[i] += 2.0 * along_up * d_image[i] - along_point * d_image[i] - along_image * point[i] +
                 along_point * along_image * up_[i];
}

FABSEQ_INSTANTIATE_FUNCTION(torch_samples);
template class LeastRotation<2>;
template class LeastRotation<3>;

}  // namespace fabseq
