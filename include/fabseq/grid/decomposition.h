// SPDX-License-Identifier: MIT
/// \file
/// How the elements of a grid are dealt out to the ranks.
#pragma once

#include "fabseq/grid/index_box.h"

#include <mpi.h>

#include <array>
#include <functional>
#include <vector>

namespace fabseq {

/// Weights of the elements of a box, lexicographic (for load balance only).
template <int Dim>
using ElementWeights = std::function<std::vector<double>(const IndexBox<Dim>&)>;

/// A tensor product of ranges: process p of axis a has elements range_starts[a][p] <= index <
/// range_starts[a][p + 1].
template <int Dim>
struct Decomposition {
  Index<Dim> processes{};                          ///< ranks along each axis; rank = px + Px (py + Py pz)
  std::array<std::vector<int>, Dim> range_starts;  ///< processes[a] + 1 entries, 0 to the axis' elements

  Index<Dim> position_of(int rank) const { return IndexBox<Dim>{Index<Dim>{}, processes}.index(rank); }
  int rank_at(const Index<Dim>& position) const {
    return static_cast<int>(IndexBox<Dim>{Index<Dim>{}, processes}.offset(position));
  }
  /// Elements of the process at `position`.
  IndexBox<Dim> elements_of(const Index<Dim>& position) const;
  /// Position of the process that has `element`.
  Index<Dim> position_of_element(const Index<Dim>& element) const;
};

/// Splits 0 .. weights.size() - 1 into `parts` ranges of at least one entry whose largest sum is as small as
/// possible, and otherwise of as even sums as that allows. Returns the parts + 1 range starts. Needs 1 <=
/// parts <= weights.size().
std::vector<int> split_evenly(const std::vector<double>& weights, int parts);

/// All factorizations of `ranks` into at most elements[a] processes along each axis, in a fixed order.
template <int Dim>
std::vector<Index<Dim>> fitting_process_grids(int ranks, const Index<Dim>& elements);

/// Chooses process grid and ranges: for every factorization that fits, ranges from the marginal weights of
/// each axis; then the one whose heaviest rank is lightest, and among those within 1 % of it the one with the
/// least surface between ranks. Collective on `comm`: each rank evaluates `weights` on a slab of the grid
/// only. An empty function weighs all alike. Throws InputError (on all ranks) if no factorization fits.
template <int Dim>
Decomposition<Dim> choose_decomposition(MPI_Comm comm, const Index<Dim>& elements,
                                        const ElementWeights<Dim>& weights);
/// The same choice for `ranks` ranks that need not be there: the ranks of `comm` only share the work.
template <int Dim>
Decomposition<Dim> choose_decomposition(MPI_Comm comm, int ranks, const Index<Dim>& elements,
                                        const ElementWeights<Dim>& weights);

}  // namespace fabseq
