// SPDX-License-Identifier: MIT
/// Objective: |grad t| is to be uniform within each layer (docs/formulation.md 6).
#include "fabseq/responses/layer_statistics.h"
#include "fabseq/responses/response_type.h"

#include <algorithm>
#include <cmath>

namespace fabseq {

namespace {

/// Layers with at most this fraction of the mean volume V*/N do not count in the variance.
constexpr double empty_layer_fraction = 1e-6;

/// The objective is L = sum_j F_j(D_j, W_j, m_j) with D_j = sum_e w_e (M_e - m_j)^2, W_j = sum_e w_e and w =
/// drho + floor. The derivative of the mean drops out of D_j because deviations from it sum to zero. So a
/// form of the objective has to supply only the three partial derivatives of F_j.
struct Partials {
  double deviation = 0.0, weight = 0.0, mean = 0.0;
};

enum class UniformityForm { sum_of_squares, variance };

struct UniformitySettings {
  UniformityForm form = UniformityForm::sum_of_squares;
};

/// `sum_of_squares`: sum over layers of D_j. `variance`: mean over the layers that are not empty of the
/// squared coefficient of variation, which has no unit.
template <int Dim>
class Uniformity : public Response<Dim> {
 public:
  Uniformity(const ResponseContext<Dim>& context, const UniformitySettings& settings)
      : context_(context), variance_(settings.form == UniformityForm::variance) {}

  /// Gradients that differ by as much as they are long.
  double size() const override {
    return variance_
               ? 1.0
               : static_cast<double>(context_.part.count()) / std::pow(context_.characteristic_length, 2);
  }

  std::vector<double> values(const StageResults<Dim>& state) const override {
    const auto statistics = layer_statistics(context_, *state.time, *state.densities);
    double total = 0.0;
    for (const LayerStatistics& layer : statistics) {
      if (!variance_) total += layer.deviation;
      if (variance_ && !is_empty(layer, statistics.size()))
        total += std::pow(layer.coefficient_of_variation(), 2);
    }
    return {variance_ ? total / filled_layers(statistics) : total};
  }

  void add_derivative(int, double weight, const StageResults<Dim>& state,
                      StageDerivatives<Dim>& adjoint) const override {
    const auto statistics = layer_statistics(context_, *state.time, *state.densities);
    const std::vector<double> magnitude = gradient_magnitude(*state.time, context_.characteristic_length);
    std::vector<double> d_magnitude(magnitude.size(), 0.0);
    for (int j = 0; j < state.densities->count(); ++j) {
      const LayerStatistics& layer = statistics[j];
      const Partials partials = this->partials(statistics, layer);
      if (partials.deviation == 0.0) continue;
      auto& d_layer = DensityDerivatives::zeros_if_empty(adjoint.densities.layer[j], magnitude.size());
      for (std::size_t e = 0; e < magnitude.size(); ++e) {
        const double difference = magnitude[e] - layer.mean;
        const double density = state.densities->layer[j][e] + layer_density_floor;
        d_layer[e] += weight * (partials.deviation * difference * difference + partials.weight +
                                partials.mean * difference / layer.weight);
        d_magnitude[e] +=
            weight * density * (2.0 * partials.deviation * difference + partials.mean / layer.weight);
      }
    }
    add_magnitude_derivative(state, magnitude, d_magnitude, adjoint);
  }

 private:
  /// F_j = D_j, or D_j / (N' m_j^2 W_j).
  Partials partials(const std::vector<LayerStatistics>& all, const LayerStatistics& layer) const {
    if (!variance_) return {1.0, 0.0, 0.0};
    if (is_empty(layer, all.size())) return {};
    const double factor = 1.0 / (filled_layers(all) * layer.mean * layer.mean * layer.weight);
    return {factor, -factor * layer.deviation / layer.weight, -2.0 * factor * layer.deviation / layer.mean};
  }
  bool is_empty(const LayerStatistics& layer, std::size_t layers) const {
    return layer.volume <= empty_layer_fraction * (context_.part.volume() / static_cast<double>(layers));
  }
  int filled_layers(const std::vector<LayerStatistics>& all) const {
    return static_cast<int>(std::count_if(
        all.begin(), all.end(), [&](const LayerStatistics& layer) { return !is_empty(layer, all.size()); }));
  }

  ResponseContext<Dim> context_;
  bool variance_;
};

const Registered<Uniformity, UniformitySettings> registered(
    {.name = "layer_uniformity",
     .layers = LayerKind::curved,
     .needs_time_gradient = true,
     .weight = 0.3,  // measured at nominal positions (benchmarks/evidence/results/defaults.md)
     .weight_option = "-alpha"},
    Section<UniformitySettings>("objective")
        .key("form", &UniformitySettings::form, "Form of the deviation within each layer",
             {.words = "sum_of_squares variance"}));

}  // namespace

}  // namespace fabseq
