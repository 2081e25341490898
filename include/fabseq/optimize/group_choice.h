// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/optimize/model_settings.h"
#include "fabseq/parallel/layer_groups.h"
#include "fabseq/part/part.h"

#include <mpi.h>

#include <memory>
#include <string>

namespace fabseq {

/// The layer groups with which a run takes least time, and why there are so many.
struct GroupChoice {
  int groups = 1;
  std::string explanation;  ///< a line for the log; empty with a single rank
};

/// The groups of a run, and grid and part as the ranks of each of them have them. The part refers to the
/// grid.
template <int Dim>
struct PlacedPart {
  GroupChoice choice;
  std::unique_ptr<const LayerGroups> groups;
  std::unique_ptr<Grid<Dim>> grid;
  std::unique_ptr<Part<Dim>> part;
};

/// Grid and part in as many groups as `solver.layer_groups` says, or in the number of groups that is the
/// fastest by a model of the time and fits the memory now available. Collective on `world`, which must
/// outlive the result. Throws InputError if ranks cannot be dealt out so, or for anything wrong with the
/// part.
template <int Dim>
PlacedPart<Dim> place_part(MPI_Comm world, const ModelSettings& settings);

}  // namespace fabseq
