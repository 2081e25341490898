// SPDX-License-Identifier: MIT
/// \file
/// How the elements of a grid are dealt out to the ranks of a communicator.
#pragma once

#include "fabseq/grid/index_box.h"

#include <mpi.h>

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

namespace fabseq {

/// Function that returns the weights of the elements of a box, lexicographic. Weights serve load balance
/// only.
template <int Dim>
using ElementWeights = std::function<std::vector<double>(const IndexBox<Dim>&)>;

/// Ranges begin at multiples of a power of two as long as ranks have on average at least this many blocks of
/// so many elements along each axis: whoever joins elements to such blocks finds a block's on one rank.
inline constexpr std::int64_t least_blocks = 400;

/// A tensor product of index ranges: process p of axis a has the elements with range_starts[a][p] <= index[a]
/// < range_starts[a][p + 1].
template <int Dim>
struct Decomposition {
  Index<Dim> processes{};  ///< number of ranks along each axis; rank = px + Px (py + Py pz)
  /// [axis]: processes[axis] + 1 entries, from 0 to elements[axis].
  std::array<std::vector<int>, Dim> range_starts;

  Index<Dim> position_of(int rank) const { return IndexBox<Dim>{Index<Dim>{}, processes}.index(rank); }
  int rank_at(const Index<Dim>& position) const {
    return static_cast<int>(IndexBox<Dim>{Index<Dim>{}, processes}.offset(position));
  }
  /// Elements of the process at `position` in the grid of processes.
  IndexBox<Dim> elements_of(const Index<Dim>& position) const;
  /// Position of the process that has `element`.
  Index<Dim> position_of_element(const Index<Dim>& element) const;
  /// The same of the nodes of a grid: one per element, and one more of the last process along an axis.
  Decomposition of_nodes() const;
};

/// Splits 0 .. weights.size() - 1 into `parts` ranges of at least one entry. Their largest sum of weights is
/// as small as possible, and apart from that the sums are as even as possible. Returns the parts + 1 range
/// starts. Needs 1 <= parts <= weights.size(). Not collective.
std::vector<int> split_evenly(const std::vector<double>& weights, int parts);

/// All factorizations of `ranks` into at most elements[a] processes along each axis, in a fixed order.
template <int Dim>
std::vector<Index<Dim>> fitting_process_grids(int ranks, const Index<Dim>& elements);

/// Chooses process grid and ranges. For every factorization that fits, the ranges follow from the marginal
/// weights of each axis; they begin at multiples of as large a power of two as there is room for. Among the
/// factorizations whose heaviest rank is within 1 % of the lightest one possible, the one with the least
/// surface between ranks is taken. An empty function `weights` gives all elements the same weight. The
/// `ranks` ranks need not exist: those of `comm` share the work. Collective on `comm`: each rank evaluates
/// `weights` on one slab of the grid. Throws InputError on all ranks if no factorization fits.
template <int Dim>
Decomposition<Dim> choose_decomposition(MPI_Comm comm, int ranks, const Index<Dim>& elements,
                                        const ElementWeights<Dim>& weights);

}  // namespace fabseq
