// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/files/output_directory.h"
#include "fabseq/tasks/bead_checks.h"

namespace fabseq {

/// Writes config.json, result.h5, result.xdmf and summary.json of real layers to the folder `beads` of a run,
/// for tools that read the layers of a simulation. `real`: on the grid of BeadChecks::for_bodies(); `report`:
/// judged by the finest one. Collective. Throws OutputError.
template <int Dim>
void write_real_layers(const BeadChecks<Dim>& beads, const RealSequence<Dim>& real,
                       const SequenceReport& report, const OutputDirectory& directory);

}  // namespace fabseq
