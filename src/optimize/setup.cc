// SPDX-License-Identifier: MIT
#include "fabseq/optimize/setup.h"

#include "fabseq/base/error.h"
#include "fabseq/base/memory.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/session.h"
#include "fabseq/config/schema.h"
#include "fabseq/process/release.h"
#include "fabseq/sequence/geodesic_distance.h"
#include "fabseq/sequence/given_sequence.h"
#include "fabseq/solve/reference/interpolation.h"

#include <algorithm>
#include <cmath>

namespace fabseq {

namespace {

template <int Dim>
std::optional<StartRegion> start_region(const Part<Dim>& part, const SequenceSettings& settings) {
  if (settings.type != SequenceType::direct) return std::nullopt;
  return make_start_region(part, settings);
}

template <int Dim>
DesignSupport<Dim> make_design_support(const Part<Dim>& part, const SequenceSettings& settings,
                                       const std::optional<StartRegion>& start) {
  switch (settings.type) {
    case SequenceType::heat:
      return {part.grid(), false, part.elements()};
    case SequenceType::direct:
      return {part.grid(), settings.location == DesignLocation::nodes, start->free};
    default:
      return {part.grid(), false, {}};
  }
}

}  // namespace

template <int Dim>
Setup<Dim>::Setup(MPI_Comm world, const Config& config_)
    : config(config_),
      group_choice(choose_layer_groups<Dim>(world, config_)),
      groups(world, group_choice.groups),
      grid(make_balanced_grid(groups.domain(), config_.domain<Dim>(), config_.part)),
      part(grid, config_.part, config_.plate),
      supports(part, config_.part),
      start(start_region(part, config_.sequence)),
      design_support(make_design_support(part, config_.sequence, start)),
      layer_count(resolved_layer_count(config_, part)),
      layer_variables(make_layer_variables(config_.layers, layer_count, Dim, part.longest_edge())),
      baseline_layers(resolve_baseline_layers()),
      lanes(resolved_lanes(world, config_, run_size(config_, part, layer_count, size_of(world)),
                           groups.count())),
      characteristic_length(config_.sequence.characteristic_length.value_or(part.longest_edge())) {
  // Refuses a grid whose lane blocks are too large for the indices before anything is written.
  (void)grid.node_dm(Dim * std::min(lanes, std::max(layer_count, baseline_layers)));
  for (const auto& [name, description] : config.node_sets)
    node_sets.emplace(name, make_node_set(part, name, description));
  require_release();
  warn_about_method();
}

/// Refuses terms after a release that there cannot be.
template <int Dim>
void Setup<Dim>::require_release() const {
  for (std::size_t i = 0; i < config.objective.size(); ++i) {
    if (!config.objective[i].after_release) continue;
    const std::string reason = release_obstacle(grid, supports, config.process.void_model);
    if (!reason.empty())
      refuse("/objective/" + std::to_string(i) + "/after_release", "true, but " + reason,
             "false for this part");
  }
}

/// The solvers themselves say nothing: there are many of them.
template <int Dim>
void Setup<Dim>::warn_about_method() const {
  if (config.solver.method != ReferenceMethod::multigrid) return;
  const std::string obstacle = coarsening_obstacle(grid);
  if (!obstacle.empty())
    warn("/solver/reference_method: multigrid halves the grid, which has " + obstacle +
         "; gamg is taken in its place");
}

template <int Dim>
int Setup<Dim>::resolve_baseline_layers() const {
  if (config.baseline.layers) return *config.baseline.layers;
  if (config.layers.multi_planar) {
    const double height = planar_height(part, config.baseline.direction);
    return std::max(1, static_cast<int>(std::round(height / config.layers.multi_planar->thickness)));
  }
  if (!config.target_thickness()) return layer_count;
  const double height = planar_height(part, config.baseline.direction);
  return layers_of_target(config, height, std::round(height / *config.target_thickness()));
}

template <int Dim>
DesignLayout<Dim> Setup<Dim>::design_layout() const {
  return {grid, design_support.on_nodes(),
          [this](std::span<const double> share) { return design_field(share); },
          [this](std::span<const double> field) {
            return groups.share(design_support.restrict_to_variables(field));
          }};
}

template <int Dim>
void Setup<Dim>::require_memory_of_layers() const {
  const bool planar = baseline_layers > layer_count;
  const double layers = std::max(layer_count, baseline_layers);
  const double bytes = layers * sizeof(double) *
                       (2.0 * groups.count() * static_cast<double>(part.count()) +
                        Dim * static_cast<double>(grid.all_nodes().count()));
  require_memory(world(), bytes,
                 (planar                       ? "/baseline/layers: "
                  : config.layers.multi_planar ? "/layers/thickness: about "
                                               : "/layers/count: ") +
                     std::to_string(std::max(layer_count, baseline_layers)) + " layers on " +
                     to_text<Dim>(grid.domain().elements) + " elements" +
                     (groups.count() > 1 ? " in " + std::to_string(groups.count()) + " layer groups" : ""));
}

template class Setup<2>;
template class Setup<3>;

}  // namespace fabseq
