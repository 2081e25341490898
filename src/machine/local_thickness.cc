// SPDX-License-Identifier: MIT
#include "fabseq/machine/local_thickness.h"

#include "fabseq/base/mpi.h"
#include "fabseq/sequence/sequence.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace fabseq {

namespace {

/// Whether a gradient (1/length) vanishes but for its regularization in a part of that length.
template <int Dim>
bool is_flat(const double* gradient, double length) {
  const double square = std::inner_product(gradient, gradient + Dim, gradient, 0.0);
  return std::isfinite(length) && square < gradient_regularization(length);
}

}  // namespace

template <int Dim>
std::vector<double> local_thickness(std::span<const double> time, std::span<const double> gradient,
                                    const LayerDensities& layers, std::span<const double> layer_index,
                                    double most) {
  std::vector<double> result;
  if (gradient.empty() || layers.time_points.empty()) return result;
  for (std::size_t e = 0; e < layer_index.size(); ++e) {
    const auto layer = static_cast<std::size_t>(layer_index[e]);
    const double* own = &gradient[e * Dim];
    const double duration =
        layers.time_points[layer] - layers.time_points[layer - 1] + layers.beyond(time[e]);
    const double steepness = std::sqrt(std::inner_product(own, own + Dim, own, 0.0));
    result.push_back(is_flat<Dim>(own, most) ? most : duration / steepness);
  }
  return result;
}

std::vector<double> beyond_range(std::span<const double> thickness, const std::array<double, 2>& allowed) {
  std::vector<double> result;
  for (const double value : thickness)
    result.push_back(std::max(value / allowed[1], allowed[0] / value) - 1.0);
  return result;
}

template <int Dim>
std::optional<ThicknessRange> thickness_range(const Part<Dim>& part, std::span<const double> thickness,
                                              std::span<const double> gradient,
                                              std::span<const double> meetings,
                                              const std::optional<std::array<double, 2>>& allowed,
                                              std::span<const double> layer_index, int layers) {
  const MPI_Comm comm = part.grid().comm();
  // A rank without part elements has no values whether they are defined or not.
  if (!any(comm, !thickness.empty())) return std::nullopt;
  double least = std::numeric_limits<double>::infinity(), largest = 0.0;
  std::vector<double> without_end;
  for (const double value : thickness) {
    least = std::min(least, value);
    largest = std::max(largest, value);
  }
  for (std::size_t e = 0; e < thickness.size(); ++e)
    without_end.push_back(is_flat<Dim>(&gradient[e * Dim], part.longest_edge()) ? 1.0 : 0.0);
  ThicknessRange result;
  result.least = min(comm, least);
  result.largest = max(comm, largest);
  const Point<Dim> at = part.first_place([&](std::size_t e) { return thickness[e] == result.largest; });
  result.largest_at.assign(at.begin(), at.end());
  bool meeting = false;
  for (std::size_t e = 0; e < thickness.size(); ++e)
    meeting |= thickness[e] == result.largest && meetings[e] != 0.0;
  result.largest_is_meeting = any(comm, meeting);
  result.without_end = count_marked(part, without_end, layer_index, layers, MarkedPlace::earliest);
  if (!allowed) return result;
  result.outside =
      count_marked<Dim>(part, beyond_range(thickness, *allowed), layer_index, layers, MarkedPlace::largest);
  result.worst =
      result.largest / (*allowed)[1] >= (*allowed)[0] / result.least ? result.largest : result.least;
  return result;
}

FABSEQ_INSTANTIATE_FUNCTION(local_thickness);
FABSEQ_INSTANTIATE_FUNCTION(thickness_range);

}  // namespace fabseq
