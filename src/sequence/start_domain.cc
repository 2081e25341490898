// SPDX-License-Identifier: MIT
#include "sequence/start_domain.h"

namespace fabseq {

template <int Dim>
SystemDomain start_domain(const Part<Dim>& part) {
  const Grid<Dim>& grid = part.grid();
  SystemDomain domain;
  grid.owned_elements().for_each([&](const Index<Dim>& index, std::int64_t) {
    domain.first_corners.push_back(grid.first_corner(index));
  });
  domain.fixed.resize(static_cast<std::size_t>(grid.owned_nodes().count()));
  grid.owned_nodes().for_each([&](const Index<Dim>& node, std::int64_t offset) {
    const bool on_plate = part.on_plate(node) && part.touched_nodes()[offset] != 0;
    domain.fixed[offset] = on_plate || part.substrate().nodes()[offset] != 0 ? 1 : 0;
  });
  return domain;
}

FABSEQ_INSTANTIATE_FUNCTION(start_domain);

}  // namespace fabseq
