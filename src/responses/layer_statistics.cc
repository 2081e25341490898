#include "fabseq/responses/layer_statistics.h"

#include "fabseq/base/mpi.h"

#include <cmath>
#include <limits>

namespace fabseq {

double LayerStatistics::coefficient_of_variation(int layer) const {
  return std::sqrt(std::max(deviation[layer], 0.0) / weight[layer]) / mean[layer];
}

double gradient_regularization(double characteristic_length) {
  return 1e-9 / (characteristic_length * characteristic_length);
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
LayerStatistics layer_statistics(const ResponseContext<Dim>& context, const PseudoTime<Dim>& time,
                                 const LayerDensities& layers) {
  const MPI_Comm comm = context.part.grid().comm();
  const std::vector<double> magnitude = gradient_magnitude(time, context.characteristic_length);
  const bool defined = sum(comm, static_cast<std::int64_t>(magnitude.size())) > 0;
  const int count = layers.count();
  std::vector<double> sums(3 * static_cast<std::size_t>(count),
                           0.0);  // weight, floorless weight, weighted magnitude
  for (int j = 0; j < count; ++j)
    for (std::size_t e = 0; e < layers.layer[j].size(); ++e) {
      const double density = layers.layer[j][e];
      sums[3 * j] += density + layer_density_floor;
      sums[3 * j + 1] += density;
      if (defined) sums[3 * j + 2] += (density + layer_density_floor) * magnitude[e];
    }
  sum_in_place(comm, sums);

  LayerStatistics result;
  const double undefined = std::numeric_limits<double>::quiet_NaN();
  for (int j = 0; j < count; ++j) {
    result.weight.push_back(sums[3 * j]);
    result.volume.push_back(sums[3 * j + 1] * context.part.grid().element_volume());
    result.mean.push_back(defined ? sums[3 * j + 2] / sums[3 * j] : undefined);
    result.thickness.push_back((layers.time_points[j + 1] - layers.time_points[j]) / result.mean[j]);
  }
  result.deviation.assign(count, defined ? 0.0 : undefined);
  if (!defined) return result;
  for (int j = 0; j < count; ++j)
    for (std::size_t e = 0; e < magnitude.size(); ++e)
      result.deviation[j] +=
          (layers.layer[j][e] + layer_density_floor) * std::pow(magnitude[e] - result.mean[j], 2);
  sum_in_place(comm, result.deviation);
  return result;
}

template <int Dim>
void add_magnitude_derivative(const PipelineState<Dim>& state, const std::vector<double>& magnitude,
                              const std::vector<double>& d_magnitude, PipelineAdjoint<Dim>& adjoint) {
  auto& d_gradient = adjoint.time.gradient;
  if (d_gradient.empty()) d_gradient.assign(state.time.gradient.size(), 0.0);
  for (std::size_t e = 0; e < magnitude.size(); ++e)
    for (int axis = 0; axis < Dim; ++axis)
      d_gradient[e * Dim + axis] += d_magnitude[e] * state.time.gradient[e * Dim + axis] / magnitude[e];
}

#define FABSEQ_INSTANTIATE(Dim)                                                                       \
  template std::vector<double> gradient_magnitude<Dim>(const PseudoTime<Dim>&, double);               \
  template LayerStatistics layer_statistics<Dim>(const ResponseContext<Dim>&, const PseudoTime<Dim>&, \
                                                 const LayerDensities&);                              \
  template void add_magnitude_derivative<Dim>(const PipelineState<Dim>&, const std::vector<double>&,  \
                                              const std::vector<double>&, PipelineAdjoint<Dim>&);
FABSEQ_INSTANTIATE(2)
FABSEQ_INSTANTIATE(3)
#undef FABSEQ_INSTANTIATE

}  // namespace fabseq
