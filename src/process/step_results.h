// SPDX-License-Identifier: MIT
/// \file
/// From the increments of a process' steps to its result.
#pragma once

#include "fabseq/parallel/layer_groups.h"
#include "fabseq/process/deposition.h"
#include "fabseq/process/process_result.h"
#include "fabseq/process/step_systems.h"

#include <cstddef>

namespace fabseq {

/// Prepares a result for the steps and blocks of systems that have been dealt out: displacements are 0, nodes
/// are all of the model. Local.
template <int Dim>
void set_steps(const StepSystems<Dim>& systems, ProcessResult& result);

/// Sets the weights of a block's increments, and adds what counts of them to the displacements of all cases.
/// `deposition`: nullptr: all counts. Collective on the grid's communicator.
template <int Dim>
void count_block(const Deposition<Dim>* deposition, const LayerDensities& densities, std::size_t block,
                 ProcessResult& result);

/// Sums up the groups' displacements of all cases. Collective on LayerGroups::across().
void sum_displacements(const LayerGroups& groups, ProcessResult& result);

}  // namespace fabseq
