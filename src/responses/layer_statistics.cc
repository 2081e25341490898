// SPDX-License-Identifier: MIT
#include "fabseq/responses/layer_statistics.h"

#include "fabseq/base/mpi.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace fabseq {

namespace {

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

}  // namespace

double LayerStatistics::coefficient_of_variation(int layer) const {
  return std::sqrt(std::max(deviation[layer], 0.0) / weight[layer]) / mean[layer];
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

LayerMean layer_mean(MPI_Comm comm, const LayerDensities& layers, int layer,
                     const std::vector<double>& magnitude) {
  std::array<double, 3> sums = layer_sums(layers.layer[layer], magnitude);
  sum_in_place(comm, sums);
  const double mean = sums[2] / sums[1];
  return {sums[0], sums[1], mean, (layers.time_points[layer + 1] - layers.time_points[layer]) / mean};
}

template <int Dim>
std::vector<double> layer_volumes(const Grid<Dim>& grid, const LayerDensities& layers) {
  std::vector<double> result;
  for (const auto& density : layers.layer) result.push_back(elements_of(density) * grid.element_volume());
  sum_in_place(grid.comm(), result);
  return result;
}

template <int Dim>
LayerStatistics layer_statistics(const ResponseContext<Dim>& context, const PseudoTime<Dim>& time,
                                 const LayerDensities& layers) {
  const MPI_Comm comm = context.part.grid().comm();
  const std::vector<double> magnitude = gradient_magnitude(time, context.characteristic_length);
  // Multi-planar layers have no time points, because they do not follow the pseudo-time.
  const bool defined =
      !layers.time_points.empty() && sum(comm, static_cast<std::int64_t>(magnitude.size())) > 0;
  const int count = layers.count();
  std::vector<double> sums;
  for (const auto& density : layers.layer) {
    const auto of_layer = layer_sums(density, magnitude);
    sums.insert(sums.end(), of_layer.begin(), of_layer.end());
  }
  sum_in_place(comm, sums);

  LayerStatistics result;
  const double undefined = std::numeric_limits<double>::quiet_NaN();
  for (int j = 0; j < count; ++j) {
    result.volume.push_back(sums[3 * j] * context.part.grid().element_volume());
    result.weight.push_back(sums[3 * j + 1]);
    result.mean.push_back(defined ? sums[3 * j + 2] / sums[3 * j + 1] : undefined);
    result.thickness.push_back(defined ? (layers.time_points[j + 1] - layers.time_points[j]) / result.mean[j]
                                       : undefined);
  }
  result.deviation.assign(count, defined ? 0.0 : undefined);
  if (!defined) return result;
  for (int j = 0; j < count; ++j)
    result.deviation[j] = sum_over(magnitude.size(), [d = layers.layer[j].data(), m = magnitude.data(),
                                                      mean = result.mean[j]](std::size_t e) {
      return (d[e] + layer_density_floor) * (m[e] - mean) * (m[e] - mean);
    });
  sum_in_place(comm, result.deviation);
  return result;
}

template <int Dim>
void add_magnitude_derivative(const PipelineState<Dim>& state, const std::vector<double>& magnitude,
                              const std::vector<double>& d_magnitude, PipelineAdjoint<Dim>& adjoint) {
  auto& d_gradient = adjoint.time.gradient;
  if (d_gradient.empty()) d_gradient.assign(state.time.gradient.size(), 0.0);
  for (std::size_t e = 0; e < magnitude.size(); ++e) {
    const double factor = d_magnitude[e] / magnitude[e];
    for (int axis = 0; axis < Dim; ++axis)
      d_gradient[e * Dim + axis] += factor * state.time.gradient[e * Dim + axis];
  }
}

#define FABSEQ_INSTANTIATE(Dim)                                                                       \
  template std::vector<double> gradient_magnitude<Dim>(const PseudoTime<Dim>&, double);               \
  template std::vector<double> layer_volumes<Dim>(const Grid<Dim>&, const LayerDensities&);           \
  template LayerStatistics layer_statistics<Dim>(const ResponseContext<Dim>&, const PseudoTime<Dim>&, \
                                                 const LayerDensities&);                              \
  template void add_magnitude_derivative<Dim>(const PipelineState<Dim>&, const std::vector<double>&,  \
                                              const std::vector<double>&, PipelineAdjoint<Dim>&);
FABSEQ_INSTANTIATE(2)
FABSEQ_INSTANTIATE(3)
#undef FABSEQ_INSTANTIATE

}  // namespace fabseq
