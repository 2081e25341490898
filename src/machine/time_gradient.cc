// SPDX-License-Identifier: MIT
#include "fabseq/machine/time_gradient.h"

#include "fabseq/base/mpi.h"
#include "machine/time_differences.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace fabseq {

namespace {

/// Times that differ by less are one.
constexpr double same_time = 1e-9;
/// Layers that a fit looks over to both sides where times are no finer than layers, and the most elements.
constexpr double layers_to_each_side = 2.0;
constexpr int most_reach = 6;

/// Sorts times and leaves out what is there already.
void keep_distinct(std::vector<double>& times) {
  std::sort(times.begin(), times.end());
  const auto same = [](double a, double b) { return b - a < same_time; };
  times.erase(std::unique(times.begin(), times.end(), same), times.end());
}

/// Mean step between the times, if these are no more than there are layers. Collective.
std::optional<double> step_of_layers(MPI_Comm comm, std::vector<double> times, int layers) {
  const auto most = static_cast<std::size_t>(layers);
  keep_distinct(times);
  if (any(comm, times.size() > most)) return std::nullopt;
  times = gather_all(comm, times);
  keep_distinct(times);
  if (times.size() > most || times.size() < 2) return std::nullopt;
  return (times.back() - times.front()) / static_cast<double>(times.size() - 1);
}

/// Elements that gradients of all ranks belong to, at least 1. Collective.
template <int Dim>
double elements_of(MPI_Comm comm, std::span<const double> gradient) {
  return std::max(1.0, sum(comm, static_cast<double>(gradient.size())) / Dim);
}

/// Mean length of the gradients, 1/length. Collective.
template <int Dim>
double mean_length(MPI_Comm comm, std::span<const double> gradient) {
  double total = 0.0;
  for (std::size_t e = 0; e * Dim < gradient.size(); ++e) {
    double square = 0.0;
    for (int axis = 0; axis < Dim; ++axis) square += std::pow(gradient[e * Dim + axis], 2);
    total += std::sqrt(square);
  }
  return sum(comm, total) / elements_of<Dim>(comm, gradient);
}

/// Share of the elements at which two gradients make an angle of more than 60 degrees. Collective.
template <int Dim>
double share_elsewhere(MPI_Comm comm, std::span<const double> gradient, std::span<const double> other) {
  double elsewhere = 0.0;
  for (std::size_t e = 0; e * Dim < gradient.size(); ++e) {
    double product = 0.0, square = 0.0, square_of_other = 0.0;
    for (std::size_t i = e * Dim; i < (e + 1) * Dim; ++i) {
      product += gradient[i] * other[i];
      square += gradient[i] * gradient[i];
      square_of_other += other[i] * other[i];
    }
    if (product < 0.5 * std::sqrt(square) * std::sqrt(square_of_other)) elsewhere += 1.0;
  }
  return sum(comm, elsewhere) / elements_of<Dim>(comm, gradient);
}

}  // namespace

template <int Dim>
TimeGradient time_gradient(const Part<Dim>& part, const PseudoTime<Dim>& time, const LayerDensities& layers) {
  const Grid<Dim>& grid = part.grid();
  const MPI_Comm comm = grid.comm();
  // A rank without part elements has no values whether they are defined or not.
  const bool is_known = any(comm, !time.gradient.empty());
  if (is_known || layers.sub_parts.count() > 0) return {time.gradient, GradientSource::sequence};
  std::vector<double> differences = TimeDifferences<Dim>(part, time.time, uniform_index<Dim>(1)).gradient();
  if (any(comm, !time.recorded_gradient.empty()))
    return {time.recorded_gradient, GradientSource::file,
            share_elsewhere<Dim>(comm, time.recorded_gradient, differences)};
  TimeGradient result{std::move(differences), GradientSource::differences};
  const std::optional<double> step = step_of_layers(comm, time.time, layers.count());
  const double slope = mean_length<Dim>(comm, result.values);
  if (!step || !(slope > 0.0)) return result;
  Index<Dim> reach;
  for (int axis = 0; axis < Dim; ++axis) {
    const double elements = *step / (slope * grid.spacing()[axis]);  // of a layer
    reach[axis] = std::clamp(static_cast<int>(std::lround(layers_to_each_side * elements)), 1, most_reach);
  }
  return {TimeDifferences<Dim>(part, time.time, reach).gradient(), GradientSource::layer_differences};
}

FABSEQ_INSTANTIATE_FUNCTION(time_gradient);

}  // namespace fabseq
