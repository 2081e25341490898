// SPDX-License-Identifier: MIT
#include "fabseq/optimize/model.h"

#include "fabseq/sequence/given_sequence.h"

namespace fabseq {

namespace {

template <int Dim>
int baseline_count(const BaselineSettings& settings, const LayerModel<Dim>& layers, const Part<Dim>& part) {
  return settings.layers ? *settings.layers : layers.planar_count(planar_height(part, settings.direction));
}

}  // namespace

template <int Dim>
Model<Dim>::Model(MPI_Comm world, const ModelSettings& settings_)
    : settings(settings_),
      placed_(place_part<Dim>(world, settings)),
      group_choice(placed_->choice),
      groups(placed_->groups),
      grid(placed_->grid),
      part(placed_->part),
      supports(part, settings.part),
      sequence_settings(placed_->sequence),
      start(placed_->places.start),
      design_support(placed_->places.support),
      node_sets(placed_->node_sets),
      layers(placed_->layers.get()),
      baseline(make_layer_model({.count = baseline_count(settings.baseline, *layers, part)}, {}, part)),
      objective(placed_->objective),
      size(placed_->size),
      lanes(resolved_lanes(world, settings.solver, size, groups.count())),
      characteristic_length(placed_->characteristic_length) {}

template <int Dim>
DesignLayout<Dim> Model<Dim>::design_layout() const {
  return {grid, design_support.on_nodes(), design_support.components(),
          [this](std::span<const double> share) { return design_field(share); },
          [this](std::span<const double> field) {
            return groups.share(design_support.restrict_to_variables(field));
          }};
}

FABSEQ_INSTANTIATE_CLASS(Model);

}  // namespace fabseq
