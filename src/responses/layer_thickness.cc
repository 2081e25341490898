// SPDX-License-Identifier: MIT
/// Constraint: the mean thickness of every layer stays near its target (docs/formulation.md 6).
#include "fabseq/responses/layer_statistics.h"
#include "fabseq/responses/response_type.h"

#include <algorithm>

namespace fabseq {

namespace {

struct LayerThicknessSettings {
  double target = 0.0;        ///< of real layers, length unit
  double tolerance = 0.1;     ///< relative to the target
  double least_volume = 0.0;  ///< relative to the mean volume; layers with less are slivers

  TermFacts facts() const { return {.target_thickness = target}; }
};

/// One component per layer, d_j / target, between 1 - tolerance and 1 + tolerance. The components of layers
/// with less than `least_volume` of the mean volume V*/N fade towards 1, which they reach at volume 0. With
/// `least_volume` 0, none does.
template <int Dim>
class LayerThickness : public Response<Dim> {
 public:
  LayerThickness(const ResponseContext<Dim>& context, const LayerThicknessSettings& settings)
      : context_(context),
        target_(context.passes * settings.target),
        tolerance_(settings.tolerance),
        least_volume_(settings.least_volume) {}

  std::vector<double> values(const StageResults<Dim>& state) const override {
    std::vector<double> result;
    for (const LayerStatistics& layer : layer_statistics(context_, *state.time, *state.densities)) {
      const double value = layer.thickness / target_;
      const Fade fade = fade_of(layer.volume, state.densities->count());
      result.push_back(fade.share < 1.0 ? 1.0 + fade.share * (value - 1.0) : value);
    }
    return result;
  }

  /// Uses the mean m_j = (M . w) / W with W = 1 . w, so that dm/dw_e = (M_e - m) / W and dm/dM_e = w_e / W.
  /// Without fading, d_j = (T_j - T_{j-1}) / m_j.
  void add_derivative(int component, double weight, const StageResults<Dim>& state,
                      StageDerivatives<Dim>& adjoint) const override {
    const std::vector<double> magnitude = gradient_magnitude(*state.time, context_.characteristic_length);
    const Grid<Dim>& grid = context_.part.grid();
    const LayerStatistics layer = layer_mean(grid, *state.densities, component, magnitude);
    const Fade fade = fade_of(layer.volume, state.densities->count());
    const double through_volume =
        weight * (layer.thickness / target_ - 1.0) * fade.slope * grid.element_volume();
    weight *= fade.share;
    const double factor = -weight * layer.thickness / (target_ * layer.mean * layer.weight);
    auto& d_layer = DensityDerivatives::zeros_if_empty(adjoint.densities.layer[component], magnitude.size());
    const std::vector<double>& density = state.densities->layer[component];
    std::vector<double> d_magnitude(magnitude.size());
    for (std::size_t e = 0; e < magnitude.size(); ++e) {
      d_layer[e] += factor * (magnitude[e] - layer.mean) + through_volume;
      d_magnitude[e] = factor * (density[e] + layer_density_floor);
    }
    add_magnitude_derivative(state, magnitude, d_magnitude, adjoint);
    std::vector<double>& d_time_points = adjoint.densities.time_points_or_zeros();
    d_time_points[component] -= weight / (target_ * layer.mean);
    d_time_points[component + 1] += weight / (target_ * layer.mean);
  }

  std::vector<ConstraintRow> rows(double margin) const override {
    return {{1.0, 1.0 + margin * tolerance_}, {-1.0, 1.0 - margin * tolerance_}};
  }

 private:
  /// How much a layer of this volume counts, from 0 to 1, and the derivative with respect to the volume.
  struct Fade {
    double share = 1.0, slope = 0.0;
  };
  Fade fade_of(double volume, int layers) const {
    const double whole = least_volume_ * context_.part.volume() / layers;
    if (!(whole > 0.0) || volume >= whole) return {};  // an empty layer may have less than 0, by rounding
    const double x = std::max(volume / whole, 0.0);
    return {x * x * (3.0 - 2.0 * x), 6.0 * x * (1.0 - x) / whole};
  }

  ResponseContext<Dim> context_;
  double target_;  ///< of a simulated layer, length unit
  double tolerance_, least_volume_;
};

const Registered<LayerThickness, LayerThicknessSettings> registered(
    {.list = TermList::constraints,
     .name = "layer_thickness",
     .layers = LayerKind::curved,
     .needs_time_gradient = true,
     .unit = "times the target"},
    Section<LayerThicknessSettings>("constraints")
        .key("target", &LayerThicknessSettings::target, "Mean thickness of each real layer (layers.passes)",
             {.required = true, .range = "(0, inf)", .unit = "length", .option = "-target"})
        .key("tolerance", &LayerThicknessSettings::tolerance, "Allowed deviation, relative to the target",
             {.range = "(0, 1)", .option = "-thickness_tolerance"})
        .key("least_volume", &LayerThicknessSettings::least_volume,
             "Layers of less volume, relative to the mean, fade out; 0: none",
             {.range = "[0, 1)", .option = "-least_volume"}));

}  // namespace

}  // namespace fabseq
