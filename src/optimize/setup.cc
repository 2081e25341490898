#include "fabseq/optimize/setup.h"

#include "fabseq/base/error.h"
#include "fabseq/sequence/geodesic_distance.h"
#include "fabseq/sequence/given_sequence.h"

#include <algorithm>
#include <cmath>

namespace fabseq {

template <int Dim>
Setup<Dim>::Setup(MPI_Comm comm, const Config& config_)
    : config(config_),
      grid(make_balanced_grid(comm, config_.domain<Dim>(), config_.part)),
      part(grid, config_.part, config_.plate),
      layer_count(resolve_layer_count()),
      baseline_layers(resolve_baseline_layers()),
      characteristic_length(config_.sequence.characteristic_length.value_or(part.longest_edge())) {
  // Refuses a grid whose lane blocks are too large for the indices before anything is written.
  (void)grid.node_dm(Dim *
                     std::min(ProcessSimulation<Dim>::batch_lanes, std::max(layer_count, baseline_layers)));
  for (const auto& [name, description] : config.node_sets)
    node_sets.emplace(name, make_node_set(part, name, description));
}

template <int Dim>
int Setup<Dim>::resolve_layer_count() const {
  if (config.layers.count) return *config.layers.count;
  const double height = geodesic_height(part, geodesic_distance(part));
  // A height that is a whole number of layers but for rounding needs no further one.
  return std::max(1, static_cast<int>(std::ceil(height / *config.target_thickness() - 1e-9)));
}

template <int Dim>
int Setup<Dim>::resolve_baseline_layers() const {
  if (config.baseline.layers) return *config.baseline.layers;
  if (!config.target_thickness()) return layer_count;
  const double height = planar_height(part, config.baseline.direction);
  return std::max(1, static_cast<int>(std::lround(height / *config.target_thickness())));
}

template class Setup<2>;
template class Setup<3>;

}  // namespace fabseq
