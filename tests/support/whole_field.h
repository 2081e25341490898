// SPDX-License-Identifier: MIT
/// \file
/// Distributed fields as one array on every rank, for comparisons between rank counts.
#pragma once

#include "fabseq/base/mpi.h"
#include "fabseq/grid/grid.h"

#include <span>
#include <vector>

namespace fabseq::test {

/// Values [entity][component] of a rank's `owned` box, put into the lexicographic array over `all`.
/// Collective.
template <int Dim>
std::vector<double> whole_field(MPI_Comm comm, const IndexBox<Dim>& owned, const IndexBox<Dim>& all,
                                std::span<const double> values, int components = 1) {
  std::vector<double> whole(static_cast<std::size_t>(all.count()) * components, 0.0);
  owned.for_each([&](const Index<Dim>& index, std::int64_t offset) {
    for (int c = 0; c < components; ++c)
      whole[all.offset(index) * components + c] = values[offset * components + c];
  });
  sum_in_place(comm, whole);
  return whole;
}

template <int Dim>
std::vector<double> whole_element_field(const Grid<Dim>& grid, std::span<const double> values,
                                        int components = 1) {
  return whole_field<Dim>(grid.comm(), grid.owned_elements(), grid.all_elements(), values, components);
}

template <int Dim>
std::vector<double> whole_node_field(const Grid<Dim>& grid, std::span<const double> values,
                                     int components = 1) {
  return whole_field<Dim>(grid.comm(), grid.owned_nodes(), grid.all_nodes(), values, components);
}

}  // namespace fabseq::test
