// SPDX-License-Identifier: MIT
/// Constraint: no layer vanishes (docs/formulation.md 7).
#include "fabseq/responses/layer_statistics.h"
#include "fabseq/responses/response_type.h"

namespace fabseq {

namespace {

struct MinimumLayerVolumeSettings {
  double fraction = 0.01;

  /// The layers share the volume of the part, so they cannot all have more than an equal share.
  void check(const TermPlace& place) const {
    if (!place.layers.count || fraction * *place.layers.count <= 1.0) return;
    refuse(pointer_to(place.pointer, "fraction"),
           shown(fraction) + " for each of " + std::to_string(*place.layers.count) + " layers",
           "at most 1 / layers.count");
  }
};

/// One component per layer, V_min - (volume of the layer), at most 0. V_min is `fraction` of the part's
/// volume. With variable time points this also keeps them in order, because a layer that ends before it
/// begins has a negative volume.
template <int Dim>
class MinimumLayerVolume : public Response<Dim> {
 public:
  MinimumLayerVolume(const ResponseContext<Dim>& context, const MinimumLayerVolumeSettings& settings)
      : grid_(context.part.grid()), least_(settings.fraction * context.part.volume()) {}

  std::vector<double> values(const StageResults<Dim>& state) const override {
    std::vector<double> result = layer_volumes(grid_, *state.densities);
    for (double& value : result) value = least_ - value;
    return result;
  }

  void add_derivative(int component, double weight, const StageResults<Dim>& state,
                      StageDerivatives<Dim>& adjoint) const override {
    auto& d_layer = DensityDerivatives::zeros_if_empty(adjoint.densities.layer[component],
                                                       state.densities->layer[component].size());
    const double element_volume = grid_.element_volume();
    for (double& derivative : d_layer) derivative -= weight * element_volume;
  }

  /// The margin refers to the least volume, since the allowed range has no width of its own.
  std::vector<ConstraintRow> rows(double margin) const override {
    return {{1.0, -(1.0 - margin) * least_, least_}};
  }

 private:
  const Grid<Dim>& grid_;
  double least_;
};

const Registered<MinimumLayerVolume, MinimumLayerVolumeSettings> registered(
    {.list = TermList::constraints, .name = "minimum_layer_volume", .layers = LayerKind::curved},
    Section<MinimumLayerVolumeSettings>("constraints")
        .key("fraction", &MinimumLayerVolumeSettings::fraction,
             "Least volume of each layer, relative to the part's", {.range = "(0, 1)"}));

}  // namespace

}  // namespace fabseq
