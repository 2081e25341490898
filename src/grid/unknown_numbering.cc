// SPDX-License-Identifier: MIT
#include "fabseq/grid/unknown_numbering.h"

#include "fabseq/base/mpi.h"

namespace fabseq {

template <int Dim>
UnknownNumbering<Dim>::UnknownNumbering(const Grid<Dim>& grid_, const SystemDomain& domain)
    : grid(grid_), components(domain.components) {
  const auto owned_count = static_cast<std::size_t>(grid.owned_nodes().count());
  const auto ghosted_count = static_cast<std::size_t>(grid.ghosted_nodes().count());
  std::vector<double> ghosted(ghosted_count, 0.0);
  std::vector<double> owned(owned_count);
  for (const int first_corner : domain.first_corners)
    for (const int offset : grid.corner_offsets()) ghosted[first_corner + offset] += 1.0;
  grid.exchange(1).add_to_owned(ghosted, owned);

  for (std::size_t node = 0; node < owned_count; ++node) {
    int fixed = 0;
    for (int c = 0; c < components; ++c) fixed += domain.fixed[node * components + c];
    if (owned[node] > 0.0 && fixed < components) owned_nodes.push_back(static_cast<int>(node));
  }
  const auto local = static_cast<std::int64_t>(owned_nodes.size());
  first = exclusive_sum(grid.comm(), local);
  count = sum(grid.comm(), local);

  owned.assign(owned_count, -1.0);
  std::int64_t number = first;
  for (const int node : owned_nodes) {
    for (int c = 0; c < components; ++c)
      if (domain.fixed[static_cast<std::size_t>(node) * components + c] != 0)
        fixed_rows.push_back(static_cast<PetscInt>(number * components + c));
    owned[node] = static_cast<double>(number++);
  }
  grid.exchange(1).to_ghosted(owned, ghosted);
  numbers.assign(ghosted.begin(), ghosted.end());
}

FABSEQ_INSTANTIATE_STRUCT(UnknownNumbering);

}  // namespace fabseq
