// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/report/sequence_report.h"

#include <vector>

namespace fabseq {

/// Tells which of a sequence's places are roofs that hang in every other sequence as well, so that they do
/// not decide between them: one entry for each of FaultyPlaces::largest. Roofs are the same if their boxes,
/// half a bead larger, meet. `sequences`: all, the first of them included. Not collective.
std::vector<bool> shared_roofs(const FaultyPlaces& of, const std::vector<const SequenceNumbers*>& sequences);

/// The class of a sequence, without the roofs that all share.
BuildClass class_beside(const SequenceNumbers& of, const std::vector<const SequenceNumbers*>& sequences,
                        const ToolSettings& tool);

}  // namespace fabseq
