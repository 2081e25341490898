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
      group_choice(placed_.choice),
      groups(*placed_.groups),
      grid(*placed_.grid),
      part(*placed_.part),
      supports(part, settings.part),
      places_(settings.sequence.kind->places(settings.sequence, part)),
      start(places_.start),
      design_support(places_.support),
      node_sets(make_node_sets(part, settings.node_sets)),
      layers(make_layer_model(settings.layers, settings.projection, part)),
      baseline(make_layer_model({.count = baseline_count(settings.baseline, *layers, part)}, {}, part)),
      lanes(resolved_lanes(world, settings.solver,
                           run_size(settings, part, node_sets, layers->count(), size_of(world)),
                           groups.count())),
      characteristic_length(settings.sequence.facts.characteristic_length.value_or(part.longest_edge())) {}

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
