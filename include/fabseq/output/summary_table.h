// SPDX-License-Identifier: MIT
/// \file
/// The end of a run on one screen, one text per line; all other figures are in summary.json.
#pragma once

#include "fabseq/output/records.h"

#include <string>
#include <vector>

namespace fabseq {

/// The answer of an optimization: the headline, a row each for today's planar layers, the best alternative
/// and the optimized sequence, the places at which its checks fail, and what else is to be known. At most 18
/// lines.
std::vector<std::string> summary_table(const Summary& summary);

/// The same of a single simulated sequence.
std::vector<std::string> simulation_table(const SequenceNumbers& numbers, const ModelSettings& settings);

}  // namespace fabseq
