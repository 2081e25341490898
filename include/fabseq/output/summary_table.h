// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/output/records.h"

#include <string>
#include <vector>

namespace fabseq {

/// The end of an optimization as a table for people, one text per line: start design, planar layers, the
/// optimized sequence smooth and binary side by side; lengths of displacements as built and after the
/// release, machining stock, layers, what they ask of the machine, and last the ratios of lengths, planar
/// and start over binary. Below it, whether each can be built on the machine, and the headline.
std::vector<std::string> summary_table(const Summary& summary);

/// The same of a single simulated sequence, without ratios. `unit`: name of the length unit, may be empty.
std::vector<std::string> simulation_table(const SequenceNumbers& numbers, const std::string& unit);

}  // namespace fabseq
