// SPDX-License-Identifier: MIT
#include "fabseq/sequence/heat_model.h"

#include <algorithm>
#include <cmath>

namespace fabseq {

namespace {

/// With the consistent matrix the temperature leaves its range where the drain outweighs conduction.
bool lump_mass(const SequenceSettings& settings, double reaction, double edge) {
  if (settings.mass != MassRule::automatic) return settings.mass == MassRule::lumped;
  return reaction * edge * edge / 6.0 > std::min(settings.min_diffusivity, settings.void_diffusivity);
}

}  // namespace

template <int Dim>
HeatModel<Dim>::HeatModel(const Part<Dim>& part, const SequenceSettings& settings)
    : element(part.grid().spacing(), part.grid().domain().thickness, 0.0),
      reaction(settings.drain / std::pow(settings.characteristic_length.value_or(part.longest_edge()), 2)),
      lumped(lump_mass(settings, reaction, part.grid().largest_spacing())) {
  const Grid<Dim>& grid = part.grid();
  grid.owned_elements().for_each([&](const Index<Dim>& index, std::int64_t) {
    domain.first_corners.push_back(grid.first_corner(index));
  });
  domain.fixed.resize(static_cast<std::size_t>(grid.owned_nodes().count()));
  grid.owned_nodes().for_each([&](const Index<Dim>& node, std::int64_t offset) {
    const bool on_plate = part.on_plate(node) && part.touched_nodes()[offset] != 0;
    domain.fixed[offset] = on_plate || part.substrate().nodes()[offset] != 0 ? 1 : 0;
  });
}

FABSEQ_INSTANTIATE_STRUCT(HeatModel);

}  // namespace fabseq
