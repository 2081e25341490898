// SPDX-License-Identifier: MIT
#include "fabseq/model/model.h"

#include "fabseq/base/mpi.h"
#include "fabseq/kernels/lane_vector.h"
#include "fabseq/sequence/given_sequence.h"

namespace fabseq {

namespace {

template <int Dim>
int baseline_count(const BaselineSettings& settings, const LayerModel<Dim>& layers, const Part<Dim>& part) {
  return settings.layers ? *settings.layers : layers.planar_count(planar_height(part, settings.direction));
}

/// Chooses as asked; else what is built, where that saves time and hardly changes a value
/// (docs/formulation.md 4.8). A single block has all, and ranks that share the box would wait for those with
/// more of it.
SolverRegion region_of_iterations(const ModelSettings& settings, const LayerTraits& layers,
                                  int domain_ranks) {
  constexpr double least_sharpness = 2.0;  // over the number of layers: below, values change by up to 1e-4
  if (settings.solver.region != SolverRegion::automatic) return settings.solver.region;
  const bool pays =
      settings.solver.path == SolverPath::lanes && domain_ranks == 1 && layers.count > widest_block;
  const bool exact = may_leave_out_unbuilt(settings.process) && !settings.layers.multi_planar &&
                     (settings.projection.binary || layers.first_beta >= least_sharpness * layers.count);
  return pays && exact ? SolverRegion::built : SolverRegion::whole;
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
      constraints(placed_->constraints),
      size(placed_->size),
      lanes(resolved_lanes(world, settings.solver, size, groups.count())),
      characteristic_length(placed_->characteristic_length),
      solver(settings.solver) {
  solver.region = region_of_iterations(settings, layers->traits(), size_of(grid.comm()));
}

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
