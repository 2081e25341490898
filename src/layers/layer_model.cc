// SPDX-License-Identifier: MIT
#include "fabseq/layers/layer_model.h"

#include "fabseq/base/refusal.h"
#include "fabseq/layers/curved_layers.h"
#include "fabseq/sequence/geodesic_distance.h"
#include "layers/multi_planar_layers.h"

#include <algorithm>
#include <cmath>

namespace fabseq {

namespace {

/// `rounded` layers, at least one, for a height; refuses the target thickness that makes too many.
int layers_of_target(const TargetThickness& target, double height, double rounded) {
  if (rounded <= most_layers) return std::max(1, static_cast<int>(rounded));
  refuse(target.key, shown(target.bead) + " for a height of " + shown(height),
         "at least " + shown(height / most_layers * (target.bead / target.value)) + ", that is up to " +
             std::to_string(most_layers) + " layers");
}

/// Config keeps it from being asked for without a count or a target.
template <int Dim>
int curved_count(const LayerSettings& settings, const Part<Dim>& part) {
  if (settings.count) return *settings.count;
  const double height = geodesic_height(part, geodesic_distance(part));
  // A height that is a whole number of layers but for rounding needs no further one.
  return layers_of_target(*settings.target, height, std::ceil(height / settings.target->value - 1e-9));
}

LayerTraits curved_traits(const LayerSettings& settings, const ProjectionSettings& projection, int count) {
  LayerTraits traits{"curved", "/layers/count", count};
  traits.first_beta = projection.first_beta(count);
  traits.last_beta = projection.last_beta(count);
  traits.variables = time_point_variables(settings.variable_time_points ? count : 1);
  return traits;
}

template <int Dim>
class CurvedLayerModel : public LayerModel<Dim> {
 public:
  CurvedLayerModel(const LayerSettings& settings, const ProjectionSettings& projection, int count,
                   const Part<Dim>& part)
      : LayerModel<Dim>(curved_traits(settings, projection, count)), target_(settings.target), part_(part) {}

  std::unique_ptr<Layers> make(std::span<const double> variables, double beta, bool binary,
                               const NegligibleLayers& /*negligible*/) const override {
    return std::make_unique<CurvedLayers>(part_.part_density(), time_points(variables), beta, binary);
  }
  int planar_count(double height) const override {
    return target_ ? layers_of_target(*target_, height, std::round(height / target_->value)) : this->count();
  }

 private:
  /// T_0 ... T_N, with those that vary.
  std::vector<double> time_points(std::span<const double> variables) const {
    if (variables.empty()) return uniform_time_points(this->count());
    std::vector<double> result = {0.0};
    result.insert(result.end(), variables.begin(), variables.end());
    result.push_back(1.0);
    return result;
  }

  std::optional<TargetThickness> target_;
  const Part<Dim>& part_;
};

/// Slabs of all sub-parts: one alone has the whole part's, several overlap by a half each, as seen with two
/// to four.
int estimated_slabs(const MultiPlanarSettings& settings, double longest_edge) {
  const double slabs = std::ceil(longest_edge / settings.slab_thickness()) * (1.0 + settings.subparts) / 2.0;
  if (slabs + settings.subparts <= most_layers) return static_cast<int>(slabs) + settings.subparts;
  refuse("/layers/thickness", shown(settings.thickness) + " for a part " + shown(longest_edge) + " long",
         "at most " + std::to_string(most_layers) + " layers");
}

/// The optimizer's range of an angle, in layers by which it turns the far end of the part.
constexpr double layers_in_reach = 10.0;

/// The sharpness stays. The variables are the angles of the print directions (docs/formulation.md 3.2).
template <int Dim>
LayerTraits multi_planar_traits(const MultiPlanarSettings& settings, const Part<Dim>& part) {
  LayerTraits traits{"multi-planar", "/layers/thickness", estimated_slabs(settings, part.longest_edge()),
                     true};
  traits.first_beta = traits.last_beta = settings.time_sharpness;
  traits.variables = {.name = "angles",
                      .label = "angles",
                      .start = settings.angles,
                      .lower = settings.lowest_angles,
                      .upper = settings.highest_angles,
                      .reach = layers_in_reach * settings.slab_thickness() / part.longest_edge(),
                      .columns = Dim - 1,
                      .fixed = settings.fixed_angles};
  traits.sub_parts = settings.subparts;
  traits.time_is_fixed = settings.fixed_time;
  return traits;
}

template <int Dim>
class MultiPlanarLayerModel : public LayerModel<Dim> {
 public:
  MultiPlanarLayerModel(const MultiPlanarSettings& settings, const Part<Dim>& part)
      : LayerModel<Dim>(multi_planar_traits(settings, part)), settings_(settings), part_(part) {}

  std::unique_ptr<Layers> make(std::span<const double> variables, double /*beta*/, bool binary,
                               const NegligibleLayers& negligible) const override {
    return std::make_unique<MultiPlanarLayers<Dim>>(part_, settings_, variables, binary, negligible);
  }
  int planar_count(double height) const override {
    return std::max(1, static_cast<int>(std::round(height / settings_.slab_thickness())));
  }

 private:
  MultiPlanarSettings settings_;
  const Part<Dim>& part_;
};

}  // namespace

Json LayerVariables::record(std::span<const double> values) const {
  if (columns == 0) return std::vector<double>(values.begin(), values.end());
  Json table = Json::array();
  for (std::size_t first = 0; first < values.size(); first += columns) {
    const auto of_sub_part = values.subspan(first, columns);
    table.push_back(std::vector<double>(of_sub_part.begin(), of_sub_part.end()));
  }
  return table;
}

LayerVariables time_point_variables(int layers) {
  return {.name = "time_points",
          .label = "time points",
          .start = interpolated_time_points({}, layers),
          .lower = std::vector<double>(layers - 1, 0.0),
          .upper = std::vector<double>(layers - 1, 1.0),
          .reach = 1.0 / layers};  // they shall not overtake each other
}

template <int Dim>
std::unique_ptr<const LayerModel<Dim>> make_layer_model(const LayerSettings& layers,
                                                        const ProjectionSettings& projection,
                                                        const Part<Dim>& part) {
  if (layers.multi_planar)
    return std::make_unique<const MultiPlanarLayerModel<Dim>>(*layers.multi_planar, part);
  return std::make_unique<const CurvedLayerModel<Dim>>(layers, projection, curved_count(layers, part), part);
}

FABSEQ_INSTANTIATE_FUNCTION(make_layer_model);

}  // namespace fabseq
