// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/grid/index_box.h"

#include <mpi.h>

#include <span>
#include <vector>

namespace fabseq {

/// Brings a field of elements or nodes, [index][component], to another grid, which may have another
/// decomposition and `factor` times as many of them along each axis: each takes the values of the one that it
/// lies in.
///
/// `owned`, `field`: what this rank has of the grid that the field is on; the boxes of the ranks do not
/// overlap, so a rank that has a copy states an empty one. `wanted`: what it has of the other grid. A rank
/// holds no more than what its own indices lie in. Collective on `comm`, which has the ranks of both grids.
template <int Dim>
std::vector<double> carried_field(MPI_Comm comm, const IndexBox<Dim>& owned, std::span<const double> field,
                                  int components, const IndexBox<Dim>& wanted, int factor);

}  // namespace fabseq
