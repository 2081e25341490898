// SPDX-License-Identifier: MIT
#include "tasks/config_changes.h"

#include <utility>
#include <variant>

namespace fabseq {

template <int Dim>
Config config_to_change(const Setup<Dim>& setup) {
  Config config = setup.resolved();
  config.solver.layer_groups = setup.groups.count();
  config.projection = {};
  config.constraints.clear();
  return config;
}

void refine(Config& config, int factor) {
  for (int& elements : config.elements) elements *= factor;
  // Stairs may leave crumbs that the coarse grid does not have.
  config.part.keep_connected = true;
  // Voxels of a file become factor^Dim elements.
  if (auto* voxels = std::get_if<VoxelFile>(&config.part.source)) voxels->repeat *= factor;
}

void cut_into_real_layers(Config& config) {
  const int passes = std::exchange(config.layers.passes, 1);  // slabs are as thick as a bead then
  if (config.thermal) config.thermal->given_passes.reset();
  if (config.layers.count) *config.layers.count *= passes;
  *config.baseline.layers *= passes;
}

FABSEQ_INSTANTIATE_FUNCTION(config_to_change);

}  // namespace fabseq
