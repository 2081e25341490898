// SPDX-License-Identifier: MIT
/// \file
/// What is held of a coarse level, given what is held of the finer one (docs/formulation.md 11.2).
#pragma once

#include "fabseq/lanes/lane_hierarchy.h"

#include <mpi.h>

namespace fabseq {

/// Finds `coarse.fixed` from `fine.fixed`, with `components` unknowns per node. Meshes, stage and sums of
/// both levels must be there. Collective on `comm`, the grid's communicator.
template <int Dim>
void find_coarse_supports(MPI_Comm comm, LaneLevel<Dim>& fine, LaneLevel<Dim>& coarse, int components);

}  // namespace fabseq
