// SPDX-License-Identifier: MIT
#include "fabseq/responses/layer_statistics.h"

#include "fabseq/base/mpi.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace fabseq {

namespace {

constexpr double undefined = std::numeric_limits<double>::quiet_NaN();

/// Sum of term(e) over the elements. The partial sums are independent of each other, so that the compiler can
/// vectorize the loop.
template <class Term>
double sum_over(std::size_t elements, Term&& term) {
  constexpr std::size_t lanes = 8;
  std::array<double, lanes> partial{};
  const std::size_t whole = elements - elements % lanes;
  for (std::size_t e = 0; e < whole; e += lanes)
    for (std::size_t lane = 0; lane < lanes; ++lane) partial[lane] += term(e + lane);
  double total = 0.0;
  for (std::size_t e = whole; e < elements; ++e) total += term(e);
  for (const double value : partial) total += value;
  return total;
}

/// Volume of a layer in elements, this rank's share of the sum.
double elements_of(const std::vector<double>& density) {
  return sum_over(density.size(), [d = density.data()](std::size_t e) { return d[e]; });
}

/// Sum of the layer densities without the floor, the same with the floor, and the weighted sum of the
/// magnitudes. This rank's share of each.
std::array<double, 3> layer_sums(const std::vector<double>& density, const std::vector<double>& magnitude) {
  const double* d = density.data();
  const double* m = magnitude.data();
  const double volume = elements_of(density);
  const double weighted =
      sum_over(magnitude.size(), [d, m](std::size_t e) { return (d[e] + layer_density_floor) * m[e]; });
  return {volume, volume + layer_density_floor * static_cast<double>(density.size()), weighted};
}

/// Returns all but the deviation, from the layer_sums() of all ranks.
template <int Dim>
LayerStatistics statistics_of(const Grid<Dim>& grid, const LayerDensities& layers, int layer, bool defined,
                              const double* sums) {
  LayerStatistics result;
  result.weight = sums[1];
  result.volume = sums[0] * grid.element_volume();
  result.mean = defined ? sums[2] / sums[1] : undefined;
  result.thickness =
      defined ? (layers.time_points[layer + 1] - layers.time_points[layer]) / result.mean : undefined;
  return result;
}

}  // namespace

double LayerStatistics::coefficient_of_variation() const {
  return std::sqrt(std::max(deviation, 0.0) / weight) / mean;
}

template <int Dim>
std::vector<double> gradient_magnitude(const PseudoTime<Dim>& time, double characteristic_length) {
  std::vector<double> result(time.gradient.size() / Dim);
  for (std::size_t e = 0; e < result.size(); ++e) {
    double square = gradient_regularization(characteristic_length);
    for (int axis = 0; axis < Dim; ++axis)
      square += time.gradient[e * Dim + axis] * time.gradient[e * Dim + axis];
    result[e] = std::sqrt(square);
  }
  return result;
}

template <int Dim>
std::vector<double> layer_volumes(const Grid<Dim>& grid, const LayerDensities& layers) {
  std::vector<double> result;
  for (const auto& density : layers.layer) result.push_back(elements_of(density) * grid.element_volume());
  sum_in_place(grid.comm(), result);
  return result;
}

template <int Dim>
std::vector<LayerStatistics> layer_statistics(const ResponseContext<Dim>& context,
                                              const PseudoTime<Dim>& time, const LayerDensities& layers) {
  const Grid<Dim>& grid = context.part.grid();
  const std::vector<double> magnitude = gradient_magnitude(time, context.characteristic_length);
  // Multi-planar layers have no time points, because they do not follow the pseudo-time.
  const bool defined =
      !layers.time_points.empty() && sum(grid.comm(), static_cast<std::int64_t>(magnitude.size())) > 0;
  std::vector<double> sums;
  for (const auto& density : layers.layer) {
    const auto of_layer = layer_sums(density, magnitude);
    sums.insert(sums.end(), of_layer.begin(), of_layer.end());
  }
  sum_in_place(grid.comm(), sums);

  std::vector<LayerStatistics> result;
  std::vector<double> deviation(layers.layer.size(), undefined);
  for (int j = 0; j < layers.count(); ++j) {
    result.push_back(statistics_of(grid, layers, j, defined, &sums[3 * j]));
    if (!defined) continue;
    deviation[j] = sum_over(magnitude.size(), [d = layers.layer[j].data(), m = magnitude.data(),
                                               mean = result[j].mean](std::size_t e) {
      return (d[e] + layer_density_floor) * (m[e] - mean) * (m[e] - mean);
    });
  }
  sum_in_place(grid.comm(), deviation);
  for (std::size_t j = 0; j < result.size(); ++j) result[j].deviation = deviation[j];
  return result;
}

template <int Dim>
LayerStatistics layer_mean(const Grid<Dim>& grid, const LayerDensities& layers, int layer,
                           const std::vector<double>& magnitude) {
  std::array<double, 3> sums = layer_sums(layers.layer[layer], magnitude);
  sum_in_place(grid.comm(), sums);
  return statistics_of(grid, layers, layer, true, sums.data());
}

template <int Dim>
void add_magnitude_derivative(const StageResults<Dim>& state, const std::vector<double>& magnitude,
                              const std::vector<double>& d_magnitude, StageDerivatives<Dim>& adjoint) {
  auto& d_gradient = adjoint.time.gradient;
  if (d_gradient.empty()) d_gradient.assign(state.time->gradient.size(), 0.0);
  for (std::size_t e = 0; e < magnitude.size(); ++e) {
    const double factor = d_magnitude[e] / magnitude[e];
    for (int axis = 0; axis < Dim; ++axis)
      d_gradient[e * Dim + axis] += factor * state.time->gradient[e * Dim + axis];
  }
}

FABSEQ_INSTANTIATE_FUNCTION(gradient_magnitude);
FABSEQ_INSTANTIATE_FUNCTION(layer_volumes);
FABSEQ_INSTANTIATE_FUNCTION(layer_statistics);
FABSEQ_INSTANTIATE_FUNCTION(layer_mean);
FABSEQ_INSTANTIATE_FUNCTION(add_magnitude_derivative);

}  // namespace fabseq
