// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/run/records.h"

#include <string>
#include <vector>

namespace fabseq {

/// The end of an optimization as a table for people, one text per line: start design, planar layers, the
/// optimized sequence smooth and binary side by side; lengths of displacements as built and after the
/// release, machining stock, layers, and last the ratios of lengths, planar and start over binary.
std::vector<std::string> summary_table(const Summary& summary);

}  // namespace fabseq
